//! Techniques as ladders of settings, from cheap to fine, with the laws that error and time follow along them.

use crate::techniques::{self, Method};

/// Sides of shadow maps \[texels\].
pub(super) const SIDES: [u32; 6] = [128, 256, 512, 1024, 2048, 4096];

/// A technique's settings along the one line on which it gets better and slower.
#[derive(Clone, Debug)]
pub(super) struct Family {
    pub technique: &'static str,
    /// Names of methods and how fine each is, from cheap to fine.
    pub rungs: Vec<(String, f64)>,
    /// Which is looked at first.
    pub first: usize,
    /// The part of the error that is its own falls by this power of how fine it is.
    pub order: f64,
    /// Its passes take longer by this power of how fine it is, unless [`work`] says otherwise.
    pub work: f64,
    pub map: Map,
    /// Whether its settings are in pixels of the picture, so that a small picture says nothing of a large one.
    pub in_pixels: bool,
    /// Whether it may be chosen; lit intervals are looked at in any case, for the map's error.
    pub wanted: bool,
}

/// What a family does with shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Map {
    /// How fine it is is how fine the map is.
    Is,
    /// It looks the map up: the map's error is in its own.
    Sampled,
    /// None.
    Unused,
}

/// A setting of a family, on maps of some size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rung {
    /// Index among the families, and of the setting within.
    pub family: usize,
    pub index: usize,
    pub fineness: f64,
    /// Texels on a side of the shadow maps.
    pub side: u32,
}

impl Family {
    /// The setting of that index; `side` is for those that sample a map.
    pub(super) fn rung(&self, family: usize, index: usize, side: u32) -> Rung {
        let fineness = self.rungs[index].1;
        let side = match self.map {
            Map::Is => fineness as u32,
            Map::Sampled => side,
            // Surfaces still have shadows.
            Map::Unused => 512,
        };
        Rung { family, index, fineness, side }
    }

    /// The method of a rung.
    pub(super) fn method(&self, rung: &Rung) -> Result<Method, String> {
        let (name, _) = &self.rungs[rung.index];
        techniques::find_one(&format!("{name}@{}", rung.side))
    }
}

fn ladder<T: Copy>(steps: &[T], rung: impl Fn(T) -> (String, f64)) -> Vec<(String, f64)> {
    steps.iter().map(|step| rung(*step)).collect()
}

fn by_map(technique: &'static str, name: &str, first: usize, work: f64) -> Family {
    let rungs = ladder(&SIDES, |side| (name.to_owned(), f64::from(side)));
    Family { technique, rungs, first, order: 1.0, work, map: Map::Is, in_pixels: false, wanted: true }
}

fn march(technique: &'static str, first: usize) -> Family {
    const STEPS: [u32; 15] = [8, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 1024, 2048, 4096];
    let rungs = ladder(&STEPS, |steps| (format!("{technique}-{steps}"), f64::from(steps)));
    Family {
        technique,
        rungs,
        first,
        order: 1.0,
        work: 1.0,
        map: Map::Sampled,
        in_pixels: false,
        wanted: true,
    }
}

/// Technique of the map's own error: lit intervals are exact but for the map.
pub(super) const EXACT_ON_MAP: &str = "lit-intervals";

/// The families that can draw a scene with a cloud or one without, the cheapest first.
pub(super) fn families(cloud: bool) -> Vec<Family> {
    if cloud {
        const SIZES: [(u32, u32); 8] =
            [(256, 32), (1024, 32), (1024, 64), (4096, 32), (4096, 64), (8192, 64), (16384, 64), (32768, 64)];
        let name =
            |(particles, directions)| (format!("szk-network-{particles}x{directions}"), f64::from(particles));
        let rungs = ladder(&SIZES, name);
        let technique = techniques::CLOUDS;
        return vec![Family {
            technique,
            rungs,
            first: 2,
            order: 0.5,
            work: 0.5,
            map: Map::Sampled,
            in_pixels: false,
            wanted: true,
        }];
    }
    const PLANES: [(u32, u32); 9] =
        [(8, 4), (8, 8), (8, 16), (8, 32), (8, 64), (16, 64), (32, 64), (64, 64), (128, 64)];
    const TILES: [(u32, u32); 8] =
        [(16, 32), (16, 64), (8, 64), (8, 128), (4, 128), (4, 256), (2, 256), (2, 512)];
    let planes = ladder(&PLANES, |(n, k)| (format!("chen-planes-{n}x{k}"), f64::from(n * k)));
    let mut tiles = ladder(&TILES, |(tile, slices)| (format!("froxels-{tile}x{slices}"), 1.0));
    // Tiles and slices in turn: each rung twice as fine, or four times as many froxels.
    for (index, (_, fineness)) in tiles.iter_mut().enumerate() {
        *fineness = 2f64.powi(index as i32);
    }
    vec![
        by_map(EXACT_ON_MAP, EXACT_ON_MAP, 2, 0.25),
        Family {
            technique: "froxels",
            rungs: tiles,
            first: 2,
            order: 0.6,
            work: 1.4,
            map: Map::Sampled,
            in_pixels: true,
            wanted: true,
        },
        march("ray-march-equiangular", 5),
        march("ray-march", 5),
        Family {
            technique: "biri-ss",
            // Its tables: as fast, but smaller, and sooner made for another medium.
            rungs: vec![
                ("biri-ss-64x128".into(), 64.0),
                ("biri-ss-128x256".into(), 128.0),
                ("biri-ss-default".into(), 256.0),
            ],
            first: 1,
            order: 2.0,
            work: 0.0,
            map: Map::Unused,
            in_pixels: false,
            wanted: true,
        },
        Family {
            technique: "chen-planes",
            rungs: planes,
            first: 2,
            order: 1.0,
            work: 1.0,
            map: Map::Sampled,
            in_pixels: false,
            wanted: true,
        },
        by_map("billeter-plv", "billeter-plv-default", 1, 1.0),
    ]
}

/// The full-screen pass alone: for lights none of whose shadows are drawn.
pub(super) fn floor() -> Family {
    Family {
        technique: "unshadowed",
        rungs: vec![("unshadowed".into(), 1.0)],
        first: 0,
        order: 1.0,
        work: 0.0,
        map: Map::Unused,
        in_pixels: false,
        wanted: true,
    }
}

/// By how much longer a pass takes at `pixels` and with another rung than at those it was measured with.
pub(super) fn work(
    family: &Family,
    pass: &str,
    (from, from_pixels): (&Rung, f64),
    (to, pixels): (&Rung, f64),
) -> f64 {
    let finer = to.fineness / from.fineness;
    let larger = f64::from(to.side) / f64::from(from.side);
    if pass.contains("min-max levels") {
        // Over the texels of the map, whatever the picture.
        return larger * larger;
    }
    let per_pixel = ["add", "clear", "rays", "unshadowed"].iter().any(|word| pass.ends_with(word));
    let own = if per_pixel { 1.0 } else { finer.powf(family.work) };
    own * pixels / from_pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rung_is_a_method_and_finer_than_the_one_before() {
        for family in families(true).into_iter().chain(families(false)).chain([floor()]) {
            assert!(family.first < family.rungs.len());
            assert!(family.rungs.windows(2).all(|two| two[0].1 <= two[1].1), "{family:?}");
            for index in 0..family.rungs.len() {
                let rung = family.rung(0, index, 256);
                let method = family.method(&rung).unwrap();
                assert_eq!(method.technique, family.technique);
                assert_eq!(method.shadow_map_size, Some(rung.side));
            }
        }
    }

    #[test]
    fn a_pass_over_the_map_does_not_grow_with_the_picture() {
        let family = &families(false)[0];
        let (coarse, fine) = (family.rung(0, 1, 0), family.rung(0, 3, 0));
        let ratio = |pass| work(family, pass, (&coarse, 100.0), (&fine, 400.0));
        assert_eq!(ratio("billeter-plv: build min-max levels"), 16.0);
        assert!((ratio("billeter-plv: integrate lit intervals") - 4.0 * 2f64.sqrt()).abs() < 1e-9);
    }
}
