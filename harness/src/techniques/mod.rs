//! Which techniques there are, in which settings, and how each is driven: one adapter per technique.

mod billeter;
mod biri;
mod chen;
mod peer;
mod reduced;
pub(crate) mod settings;
mod szk;

use std::ops::RangeInclusive;
use std::sync::Arc;

use billeter_plv::Options;
use common::gpu::{LightBinding, PassTimer};
use common::{Scene, View};
use serde_json::{Map, Value};
pub(crate) use szk::Setting as CloudSetting;

/// A frame to be drawn: what every technique is given alike.
pub(crate) struct Frame<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    /// The scene, everything that moves in its place.
    pub scene: &'a Scene,
    pub view: &'a View,
    /// Lights with their shadow maps.
    pub lights: &'a [LightBinding],
    /// Depth of the view; bound as a texture.
    pub depth: &'a wgpu::TextureView,
}

/// Something that adds airlight to a picture.
pub(crate) trait Technique {
    /// Puts a frame's data in place; once per submit. An error says what it can't draw.
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String>;

    /// Adds in-scattered radiance to `target`.
    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer);

    /// What of the frame prepared last is drawn, but not well.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Triangles of the adaptive meshes in the frame drawn last; `None` for what has none.
    fn adaptive_triangles(&self, _device: &wgpu::Device, _queue: &wgpu::Queue) -> Option<u32> {
        None
    }

    /// Silhouette edges of the frame prepared last, all lights together; `None` for what looks for none.
    fn silhouette_edges(&self) -> Option<u64> {
        None
    }
}

/// A technique's setting: what the technique is made from, and what a settings file says of it.
pub(crate) trait Recipe: std::fmt::Debug + Send + Sync {
    /// Makes the technique for targets of `format`, at first of `size` \[pixels\]. An error says what can't be done here.
    fn make(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        size: (u32, u32),
    ) -> Result<Box<dyn Technique>, String>;

    /// All settings by name: a JSON object.
    fn options(&self) -> Value;

    /// The same with those settings changed that `options` names. An error says which of them is wrong.
    fn with(&self, options: &Value) -> Result<Arc<dyn Recipe>, String>;

    /// The options of the sorted shadow planes, if this is them: they can light surfaces themselves.
    fn shadow_planes(&self) -> Option<biri_ss::Options> {
        None
    }

    /// The setting of the illumination network, if this is it.
    fn cloud_setting(&self) -> Option<CloudSetting> {
        None
    }
}

/// Bounds of the polygonal light volumes; see [`Method::bound`]. With maps of 512² the cathedral comes
/// out at 2.5 % by the default and at 4.0 to 4.5 % by the paper's setting, the amphora at 0.7 and 1.0 %.
const DEFAULT_BOUND: f64 = 0.03;
const PAPER_BOUND: f64 = 0.055;
/// Planes of row 4(e) of Chen's Table 1.
const PAPER_PLANES: u32 = 100;
/// Bound of the sampling planes' default. With maps of 512² the cathedral comes out at 2.7 %, the hall, full of chains and
/// balusters thinner than the map's texels, at 8 %.
const PLANES_BOUND: f64 = 0.1;
/// The technique that draws clouds, and nothing else; it draws all orders of scattering.
pub(crate) const CLOUDS: &str = "szk-network";
/// Particles and directions of the illumination network's default.
const PARTICLES: u32 = 4096;
const DIRECTIONS: u32 = 128;
/// Bound of exact shadows.
const EXACT_BOUND: f64 = 0.01;

/// Format in the options of methods, each of which is made for the target's own later.
pub(crate) const ANY: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A technique in one setting.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    /// Name of technique and setting, as the command line and the records spell it.
    pub name: String,
    /// The technique: methods of one technique are joined to a curve.
    pub technique: &'static str,
    /// Whether it is what a user would otherwise pick.
    pub peer: bool,
    /// `paper`, `default` or `sweep`.
    pub preset: &'static str,
    /// The setting, in few words.
    pub label: String,
    /// Largest relative RMSE that counts as right, for built-in scenes and shadow maps of at least
    /// 512²: beyond it the picture is wrong, not just coarse.
    pub bound: Option<f64>,
    /// Texels on a side of the shadow maps, where it is not the run's.
    pub shadow_map_size: Option<u32>,
    recipe: Arc<dyn Recipe>,
}

/// Every method of the comparison.
pub(crate) fn all() -> Vec<Method> {
    let mut methods = vec![
        billeter("paper", "paper", Some(PAPER_BOUND), Options::paper(ANY)),
        billeter("default", "default", Some(DEFAULT_BOUND), Options::best(ANY)),
        lit_intervals(),
        biri("paper", "paper", None, biri_ss::Options::paper(ANY)),
        biri("default", "default", Some(EXACT_BOUND), biri_ss::Options::best(ANY)),
        chen("paper", "paper", None, chen::paper(PAPER_PLANES)),
        chen("default", "default", Some(PLANES_BOUND), chen::default_setting()),
        szk("paper", "paper", szk::paper()),
        szk("default", "default", szk::best(PARTICLES, DIRECTIONS)),
    ];
    methods.extend(peer::of_comparison());
    methods
}

/// The paper's setting of a technique with one improvement each, so that each one's worth is seen.
pub(crate) fn improvements() -> Vec<Method> {
    let one = |(name, label, setting): (&str, &str, Options)| Method {
        label: label.into(),
        ..billeter(&format!("paper-{name}"), "sweep", Some(PAPER_BOUND), setting)
    };
    let other = |(name, label, setting): (&str, &str, biri_ss::Options)| Method {
        label: label.into(),
        ..biri(&format!("paper-{name}"), "sweep", None, setting)
    };
    let third = |(name, label, setting): (&str, &str, chen_planes::Options)| Method {
        label: label.into(),
        ..chen(&format!("paper-{name}"), "sweep", None, setting)
    };
    let of_biri = biri::improvements().map(other);
    let of_chen = chen::improvements().map(third);
    billeter::improvements().map(one).into_iter().chain(of_biri).chain(of_chen).collect()
}

/// The sorted shadow planes in any setting.
pub(crate) fn biri(
    name: &str,
    preset: &'static str,
    bound: Option<f64>,
    setting: biri_ss::Options,
) -> Method {
    Method::of("biri-ss", name, preset, bound, setting)
}

/// The sampling planes in any setting, whatever its target.
pub(crate) fn chen(
    name: &str,
    preset: &'static str,
    bound: Option<f64>,
    setting: chen_planes::Options,
) -> Method {
    Method::of("chen-planes", name, preset, bound, setting)
}

/// The illumination network in any setting.
fn szk(name: &str, preset: &'static str, setting: szk::Setting) -> Method {
    Method::of(CLOUDS, name, preset, None, setting)
}

/// The illumination network in any setting, by a name of its own.
pub(crate) fn cloud_method(name: &str, setting: CloudSetting) -> Method {
    Method { name: name.into(), ..szk("", "sweep", setting) }
}

/// The polygonal light volumes in any setting.
pub(crate) fn billeter(name: &str, preset: &'static str, bound: Option<f64>, setting: Options) -> Method {
    Method::of("billeter-plv", name, preset, bound, setting)
}

/// The lit volume of the same crate met ray by ray: the strongest peer of its mesh.
fn lit_intervals() -> Method {
    Method {
        name: "lit-intervals".into(),
        technique: "lit-intervals",
        peer: true,
        preset: "sweep",
        label: "exact lit intervals per ray".into(),
        ..billeter("rays", "sweep", Some(DEFAULT_BOUND), Options::rays(ANY))
    }
}

/// The methods that `wanted` names: a method, or all methods of a technique; with `@N` behind it on shadow maps of N²
/// texels. `ray-march-N` and its kin and `chen-planes-paper-N` exist for every N from 1 to 4096, `chen-planes-NxK` (N planes
/// with K places each, otherwise the default) for every K from 1 to 64, `biri-ss-WxH` (the default with tables of that size),
/// `szk-network-NxD` for N particles and D directions, and `froxels-TxZ` and `froxels-TxZxS` for tiles of T pixels, Z slices and S samples in each froxel.
pub(crate) fn find(wanted: &str) -> Result<Vec<Method>, String> {
    if let Some((name, size)) = wanted.split_once('@') {
        let expected =
            format!("`{wanted}`: expected a number of texels from 2 to 16384 behind the @, such as @1024");
        let side =
            size.parse::<u32>().ok().filter(|side| (2..=16_384).contains(side) && *size == side.to_string());
        let side = side.ok_or(expected)?;
        return Ok(find(name)?.into_iter().map(|method| method.with_shadow_map(side)).collect());
    }
    let mut found = peer::sweep(wanted);
    found.extend(all());
    found.extend(improvements().into_iter().filter(|method| method.name == wanted));
    found.retain(|method| method.name == wanted || method.technique == wanted);
    let mut names = std::collections::HashSet::new();
    found.retain(|method| names.insert(method.name.clone()));
    if !found.is_empty() {
        return Ok(found);
    }
    let steps = |prefix: &str| {
        let digits = wanted.strip_prefix(prefix)?;
        digits.parse::<u32>().ok().filter(|steps| (1..=4096).contains(steps) && *digits == steps.to_string())
    };
    if let Some(planes) = steps("chen-planes-paper-") {
        return Ok(vec![chen(&format!("paper-{planes}"), "sweep", None, chen::paper(planes))]);
    }
    if let Some((particles, directions)) = particles_and_directions(wanted) {
        let name = format!("{particles}x{directions}");
        return Ok(vec![szk(&name, "sweep", szk::best(particles, directions))]);
    }
    if let Some((planes, samples)) = planes_and_samples(wanted) {
        let name = format!("{planes}x{samples}");
        return Ok(vec![chen(&name, "sweep", None, chen::best(planes, samples))]);
    }
    if let Some((width, height)) = table_size(wanted) {
        let name = format!("{width}x{height}");
        return Ok(vec![biri(&name, "sweep", None, biri::best(width, height))]);
    }
    if let Some(method) = peer::find(wanted) {
        return Ok(vec![method]);
    }
    let mut names: Vec<String> = all().iter().map(|method| method.technique.to_owned()).collect();
    names.extend(all().into_iter().map(|method| method.name));
    let mut named = std::collections::HashSet::new();
    names.retain(|name| named.insert(name.clone()));
    Err(format!(
        "there is no technique `{wanted}`; there are: {} and other numbers of steps, planes, particles and froxels",
        names.join(", ")
    ))
}

/// N and K of `chen-planes-NxK`.
fn planes_and_samples(wanted: &str) -> Option<(u32, u32)> {
    use chen_planes::Options;
    two_numbers(wanted.strip_prefix("chen-planes-")?, 1..=Options::MOST_PLANES, 1..=Options::MOST_SAMPLES)
}

/// N and D of `szk-network-NxD`.
fn particles_and_directions(wanted: &str) -> Option<(u32, u32)> {
    use szk_network::{Options, Particles};
    two_numbers(wanted.strip_prefix("szk-network-")?, 1..=Particles::MOST, 2..=Options::MOST_DIRECTIONS)
}

/// W and H of `biri-ss-WxH`.
fn table_size(wanted: &str) -> Option<(u32, u32)> {
    two_numbers(wanted.strip_prefix("biri-ss-")?, 4..=4096, 4..=4096)
}

/// Two numbers with an x between them, spelt as they are written.
fn two_numbers(text: &str, first: RangeInclusive<u32>, second: RangeInclusive<u32>) -> Option<(u32, u32)> {
    let number = |digits: &str, range: RangeInclusive<u32>| {
        digits.parse::<u32>().ok().filter(|n| range.contains(n) && *digits == n.to_string())
    };
    let (a, b) = text.split_once('x')?;
    Some((number(a, first)?, number(b, second)?))
}

/// The one method that `wanted` names: of a technique its default setting, or 64 steps.
pub(crate) fn find_one(wanted: &str) -> Result<Method, String> {
    let mut found = find(wanted)?;
    let preferred = found.iter().position(|m| m.preset == "default" || m.name.ends_with("-64"));
    Ok(found.swap_remove(preferred.unwrap_or(0)))
}

impl Method {
    /// A technique in a setting of that name.
    fn of(
        technique: &'static str,
        setting: &str,
        preset: &'static str,
        bound: Option<f64>,
        recipe: impl Recipe + 'static,
    ) -> Self {
        Self {
            name: format!("{technique}-{setting}"),
            technique,
            peer: false,
            preset,
            label: setting.into(),
            bound,
            shadow_map_size: None,
            recipe: Arc::new(recipe),
        }
    }

    /// The same on shadow maps of `side`² texels.
    pub(crate) fn with_shadow_map(self, side: u32) -> Self {
        Self {
            name: format!("{}@{side}", self.name),
            label: format!("{}, {side}² map", self.label),
            preset: "sweep",
            shadow_map_size: Some(side),
            ..self
        }
    }

    /// Whether `name` is this method, on whatever shadow maps, or its technique.
    pub(crate) fn is_of(&self, name: &str) -> bool {
        let plain = self.name.split_once('@').map_or(self.name.as_str(), |(plain, _)| plain);
        [self.technique, plain, &self.name].contains(&name)
    }

    /// Makes the technique for targets of `format`. An error says what can't be done here.
    pub(crate) fn make(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        size: (u32, u32),
    ) -> Result<Box<dyn Technique>, String> {
        self.recipe.make(device, queue, format, size)
    }

    /// The setting of the illumination network, if this is it.
    pub(crate) fn cloud_setting(&self) -> Option<CloudSetting> {
        self.recipe.cloud_setting()
    }

    /// Why it can't draw a scene at all, if so.
    pub(crate) fn refusal(&self, scene: &Scene) -> Option<String> {
        match (self.technique == CLOUDS, scene.cloud.is_some()) {
            (true, false) => Some("the scene has no cloud, and it draws nothing else".into()),
            (false, true) => Some(format!("the scene's medium is a cloud, which only {CLOUDS} draws")),
            _ => None,
        }
    }

    /// The options of the sorted shadow planes, if this is them: they light surfaces themselves.
    pub(crate) fn shadow_planes(&self, format: wgpu::TextureFormat) -> Option<biri_ss::Options> {
        let options = self.recipe.shadow_planes()?;
        Some(biri_ss::Options { target_format: format, ..options })
    }

    /// All settings by name, as a settings file has them.
    pub(crate) fn settings(&self) -> Map<String, Value> {
        match self.recipe.options() {
            Value::Object(settings) => settings,
            _ => Map::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_find_methods() {
        let names = |wanted: &str| find(wanted).unwrap().into_iter().map(|m| m.name).collect::<Vec<_>>();
        assert_eq!(names("billeter-plv"), ["billeter-plv-paper", "billeter-plv-default"]);
        assert_eq!(names("ray-march"), ["ray-march-16", "ray-march-64", "ray-march-256"]);
        for one in
            ["ray-march-7", "ray-march-equiangular-offset-7", "froxels-3x99", "froxels-8x64x1", "unshadowed"]
        {
            assert_eq!(names(one), [one]);
        }
        assert_eq!(names("froxels").len(), 5);
        assert_eq!(find_one("froxels").unwrap().name, "froxels-8x64");
        assert!(all().iter().all(|method| method.peer == (method.preset == "sweep")));
        for method in all().into_iter().chain(improvements()) {
            assert_eq!(find_one(&method.name).unwrap().name, method.name);
        }
        assert_eq!(find_one("billeter-plv").unwrap().name, "billeter-plv-default");
        assert_eq!(find_one("ray-march").unwrap().name, "ray-march-64");
        assert_eq!(names("szk-network-512x64"), ["szk-network-512x64"]);
        assert_eq!(find_one("szk-network").unwrap().name, "szk-network-default");
        assert_eq!(names("billeter-plv-default@2048"), ["billeter-plv-default@2048"]);
        let large = find_one("billeter-plv-default@2048").unwrap();
        assert_eq!((large.shadow_map_size, large.preset), (Some(2048), "sweep"));
        assert!(
            ["billeter-plv", "billeter-plv-default", "billeter-plv-default@2048"]
                .iter()
                .all(|n| large.is_of(n))
        );
        assert!(!large.is_of("billeter-plv-paper"));
        for unknown in ["ray-march-64@", "ray-march-64@1", "ray-march-64@0512", "fog@512"] {
            assert!(find(unknown).is_err(), "{unknown}");
        }
        for unknown in [
            "szk-network-0x64",
            "szk-network-512x1",
            "szk-network-512x513",
            "szk-network-512",
            "",
            "fog",
            "ray-march-0",
            "ray-march-4097",
            "ray-march-+8",
            "ray-march-x",
            "froxels-8",
            "froxels-0x64",
            "froxels-8x64x4x4",
        ] {
            let error = find(unknown).unwrap_err();
            assert!(error.contains("billeter-plv-paper"), "{error}");
        }
    }
}
