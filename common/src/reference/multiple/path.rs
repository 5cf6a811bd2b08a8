//! One path from the eye.

use std::f64::consts::PI;

use glam::DVec3;

use super::super::indirect::{lobe_density, lobe_direction, weight};
use super::super::source::{Source, nearest};
use super::super::surface::Place;
use super::super::{Reference, Scratch};
use super::random::Random;
use super::volume::Volume;
use crate::airlight::LightFromRay;

/// Radiance along one path, by terms.
#[derive(Clone, Copy, Default)]
pub(super) struct Sample {
    pub(super) surface: DVec3,
    pub(super) airlight: DVec3,
    pub(super) indirect: DVec3,
    pub(super) multiple: DVec3,
}

/// What has happened to a path so far, from the eye on.
#[derive(Clone, Copy, Default)]
struct Past {
    scatterings: u32,
    reflections: u32,
    /// Whether the last of it was a scattering.
    in_medium: bool,
}

impl Past {
    fn scattered(self) -> Self {
        Self { scatterings: self.scatterings + 1, in_medium: true, ..self }
    }

    fn reflected(self) -> Self {
        Self { reflections: self.reflections + 1, in_medium: false, ..self }
    }

    /// The term that light belongs to which now joins the path; surfaces among themselves belong to none.
    fn term(self, sample: &mut Sample) -> Option<&mut DVec3> {
        match (self.scatterings, self.reflections) {
            (0, 1) => Some(&mut sample.surface),
            (0, _) => None,
            (1, 0) => Some(&mut sample.airlight),
            (1, 1) if self.in_medium => Some(&mut sample.indirect),
            _ => Some(&mut sample.multiple),
        }
    }
}

/// Below this throughput a path goes on by chance.
const ROULETTE: f64 = 0.1;
/// In a medium without end paths go on by chance after so many scatterings, however bright they are.
const ENDLESS: u32 = 32;

/// Goes on by chance with paths that count little: those that do count for the others too.
pub(super) fn roulette(throughput: &mut DVec3, random: &mut Random) -> bool {
    let brightest = throughput.max_element();
    if brightest >= ROULETTE {
        return true;
    }
    let chance = brightest / (2.0 * ROULETTE);
    *throughput /= chance;
    random.next() < chance
}

/// Follows paths.
pub(super) struct Tracer<'a> {
    pub(super) reference: &'a Reference,
    pub(super) volume: Volume<'a>,
    pub(super) max_scatterings: u32,
    /// Whether direct light on surfaces is wanted.
    pub(super) surfaces: bool,
}

impl Tracer<'_> {
    /// Transmittance of a view ray up to its surface, or of all of it.
    pub(super) fn transmittance(&self, ray: [DVec3; 2], random: &mut Random, scratch: &mut Scratch) -> DVec3 {
        let end = self.end(ray, scratch);
        self.volume.transmittance(ray, end, random)
    }

    fn end(&self, [origin, direction]: [DVec3; 2], scratch: &mut Scratch) -> f64 {
        let geometry = &self.reference.geometry;
        let hit = geometry.nearest(&mut scratch.stack, origin, direction, [0.0, f64::INFINITY]);
        hit.map_or(f64::INFINITY, |hit| hit.distance)
    }

    /// One sample of the radiance along a ray \[W m⁻² sr⁻¹\].
    pub(super) fn sample(&self, mut ray: [DVec3; 2], random: &mut Random, scratch: &mut Scratch) -> Sample {
        let Self { reference, volume, .. } = self;
        let (mut sample, mut past, mut throughput) = (Sample::default(), Past::default(), DVec3::ONE);
        loop {
            let [origin, direction] = ray;
            let hit = reference.geometry.nearest(&mut scratch.stack, origin, direction, [0.0, f64::INFINITY]);
            let end = hit.map_or(f64::INFINITY, |hit| hit.distance);
            let may_scatter = past.scatterings < self.max_scatterings;
            if may_scatter {
                for source in &reference.sources {
                    if let Some(term) = past.scattered().term(&mut sample) {
                        *term += self.chosen_light(source, ray, end, throughput, random, scratch);
                    }
                }
            }
            let (collision, factor) = volume.step(ray, end, throughput, random);
            let before = throughput;
            throughput *= factor;
            if let Some(x) = collision {
                sample.multiple += throughput * volume.emitted();
                if !may_scatter {
                    return sample;
                }
                throughput *= volume.albedo();
                past = past.scattered();
                let point = origin + x * direction;
                for source in &reference.sources {
                    let share = self.collision_share(source, ray, [x, end], before);
                    let light = self.arriving(source, point, 0.0, random, scratch, |to_light| {
                        volume.phase().eval(to_light.dot(direction)) * share
                    });
                    if let Some(term) = past.term(&mut sample) {
                        *term += throughput * light;
                    }
                }
                let (direction, factor) = volume.scatter(direction, throughput, random);
                throughput *= factor;
                ray = [point, direction];
            } else {
                let Some(hit) = hit else {
                    if past.in_medium
                        && !volume.is_endless()
                        && let Some(term) = past.term(&mut sample)
                    {
                        *term += throughput * reference.sky.radiance(direction.as_vec3()).as_dvec3();
                    }
                    return sample;
                };
                let Some(place) = Place::new(&reference.geometry, &reference.materials, ray, &hit) else {
                    return sample;
                };
                past = past.reflected();
                if past.scatterings > 0 || self.surfaces && past.reflections == 1 {
                    for source in &reference.sources {
                        let light =
                            self.arriving(source, place.point, place.offset, random, scratch, |to_light| {
                                weight(&place, to_light).unwrap_or(DVec3::ZERO)
                            });
                        if let Some(term) = past.term(&mut sample) {
                            *term += throughput * light;
                        }
                    }
                }
                let Some((direction, factor)) = reflect(&place, random) else { return sample };
                throughput *= factor;
                ray = [place.lifted(), direction];
            }
            let steps = past.scatterings + past.reflections;
            if volume.is_endless() && steps > ENDLESS {
                let chance = 1.0 - 1.0 / f64::from(steps);
                if random.next() >= chance {
                    return sample;
                }
                throughput /= chance;
            }
            if !roulette(&mut throughput, random) {
                return sample;
            }
        }
    }

    /// What a light sends to a point, times what `weight` makes of its direction.
    fn arriving(
        &self,
        source: &Source,
        point: DVec3,
        offset: f64,
        random: &mut Random,
        scratch: &mut Scratch,
        weight: impl Fn(DVec3) -> DVec3,
    ) -> DVec3 {
        let arrival = source.arrival(point);
        let weight = weight(arrival.to_light) * arrival.irradiance;
        if weight == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let between = [offset, arrival.distance - offset];
        if self.reference.geometry.occluded(&mut scratch.stack, point, arrival.to_light, between) {
            return DVec3::ZERO;
        }
        weight * self.volume.light_left([point, arrival.to_light], arrival.distance, random)
    }

    /// Light that a light sends to a ray and that is scattered there, at a place that is chosen without asking the
    /// medium: so that nearness to a light makes no fireflies, and thin clouds are not missed. Shares the work with the
    /// collisions by the balance heuristic.
    fn chosen_light(
        &self,
        source: &Source,
        ray: [DVec3; 2],
        end: f64,
        throughput: DVec3,
        random: &mut Random,
        scratch: &mut Scratch,
    ) -> DVec3 {
        let Some(places) = self.places(source, ray, end) else { return DVec3::ZERO };
        let (x, density) = places.choose(random.next());
        let point = ray[0] + x * ray[1];
        let scattered = self.volume.albedo() * self.volume.extinction(point);
        if scattered == DVec3::ZERO || !density.is_finite() {
            return DVec3::ZERO;
        }
        let both = density + self.volume.collisions(ray, x, throughput);
        let light = self.arriving(source, point, 0.0, random, scratch, |to_light| {
            self.volume.phase().eval(to_light.dot(ray[1])) * scattered / both
        });
        if light == DVec3::ZERO {
            return light;
        }
        throughput * light * self.volume.transmittance(ray, x, random)
    }

    /// The share of a collision at `x` of what a light sends there; [`Tracer::chosen_light`] has the rest.
    fn collision_share(
        &self,
        source: &Source,
        ray: [DVec3; 2],
        [x, end]: [f64; 2],
        throughput: DVec3,
    ) -> f64 {
        let Some(places) = self.places(source, ray, end) else { return 1.0 };
        let own = self.volume.collisions(ray, x, throughput);
        own / (own + places.density(x))
    }

    /// Places by the angle at a light that has one; of parallel light only where few paths would collide.
    fn places(&self, source: &Source, ray: [DVec3; 2], end: f64) -> Option<Places> {
        let [from, to] = self.volume.range(ray, end)?;
        let position = match source {
            Source::Point { position, .. } => *position,
            Source::Spot(spot) => spot.position,
            Source::Directional { .. } => {
                let thin = self.volume.most_collisions(to - from) < THIN;
                return thin.then_some(Places::Even { from, to });
            }
        };
        let light = LightFromRay::new(ray[0], ray[1], position);
        let (t, h) = (light.t, light.h.max(nearest(&light)));
        let [from, to] = [from, to].map(|x| ((x - t) / h).atan());
        (from < to).then_some(Places::Angles { t, h, from, to })
    }
}

/// Optical depth of a part of a ray below which few paths collide in it.
const THIN: f64 = 1.0;

/// Places of a ray that chance chooses from.
enum Places {
    /// Evenly in the angle at a light (Kulla and Fajardo 2012) at `t` along the ray and `h` beside it.
    Angles { t: f64, h: f64, from: f64, to: f64 },
    /// Evenly along the ray.
    Even { from: f64, to: f64 },
}

impl Places {
    fn choose(&self, u: f64) -> (f64, f64) {
        let x = match self {
            Self::Angles { t, h, from, to } => (t + h * (from + u * (to - from)).tan()).max(0.0),
            Self::Even { from, to } => from + u * (to - from),
        };
        (x, self.density(x))
    }

    /// Places per length \[1/m\].
    fn density(&self, x: f64) -> f64 {
        match self {
            Self::Angles { t, h, from, to } => {
                let y = x - t;
                h / ((to - from) * (h * h + y * y))
            }
            Self::Even { from, to } => 1.0 / (to - from),
        }
    }
}

/// A direction after reflection, and what the throughput is to be multiplied by.
fn reflect(place: &Place, random: &mut Random) -> Option<(DVec3, DVec3)> {
    let (diffuse, glossy) = (place.k_d.max_element(), place.k_s.max_element());
    if diffuse + glossy <= 0.0 {
        return None;
    }
    let share = glossy / (diffuse + glossy);
    let at = [random.next(), random.next()];
    let direction = if random.next() < share {
        lobe_direction(place, at)
    } else {
        let (x, y) = place.shading.any_orthonormal_pair();
        let (sin_azimuth, cos_azimuth) = (2.0 * PI * at[1]).sin_cos();
        let across = cos_azimuth * x + sin_azimuth * y;
        (at[0].sqrt() * across + (1.0 - at[0]).sqrt() * place.shading).normalize()
    };
    let factor = weight(place, direction)?;
    let cosine = place.shading.dot(direction).max(0.0) / PI;
    let density = share * lobe_density(place, direction) + (1.0 - share) * cosine;
    (density > 0.0).then(|| (direction, factor / density))
}
