//! The same light as [`Reference::paths`](super::Reference::paths) finds, without any trick: what happens to
//! a path happens by chance, one colour at a time. For clouds, and without surfaces.

use glam::DVec3;

use super::random::Random;
use super::{Estimate, Sum};
use crate::{Cloud, Light, Phase, Scene};

/// Radiance along a ray from the scene's cloud \[W m⁻² sr⁻¹\]: all scatterings of lights and sky, and
/// emission. `None` without a cloud.
pub fn simple(scene: &Scene, origin: DVec3, direction: DVec3, samples: u32, seed: u64) -> Option<Estimate> {
    let cloud = scene.cloud.as_ref()?;
    let mut random = Random::new(seed, 0);
    let mut sum = Sum::default();
    for _ in 0..samples {
        sum.add(DVec3::from_array(
            [0, 1, 2].map(|c| path(scene, cloud, c, [origin, direction], &mut random)),
        ));
    }
    Some(sum.estimate())
}

/// One path of one colour.
fn path(scene: &Scene, cloud: &Cloud, colour: usize, ray: [DVec3; 2], random: &mut Random) -> f64 {
    let [mut at, mut direction] = ray;
    let (mut radiance, mut scattered) = (0.0, false);
    while let Some(point) = collide(cloud, at, direction, f64::INFINITY, random) {
        at = point;
        radiance += f64::from(cloud.emission[colour]) / f64::from(cloud.sigma_t);
        if random.next() >= f64::from(cloud.albedo[colour]) {
            return radiance;
        }
        scattered = true;
        // No path meets a light without extent by chance, so each is asked what it sends.
        for light in &scene.lights {
            let (to_light, distance, irradiance) = arriving(light, at);
            if collide(cloud, at, to_light, distance, random).is_none() {
                radiance += cloud.phase.eval(to_light.dot(direction))[colour] * irradiance[colour];
            }
        }
        direction = deflect(&cloud.phase, colour, direction, random);
    }
    // It has left the cloud.
    if scattered { radiance + f64::from(scene.sky.radiance(direction.as_vec3())[colour]) } else { radiance }
}

/// Where a ray collides before `end`, if it does.
fn collide(cloud: &Cloud, origin: DVec3, direction: DVec3, end: f64, random: &mut Random) -> Option<DVec3> {
    let [mut x, to] = cloud.density.span(origin, direction)?;
    loop {
        x += -(1.0 - random.next()).ln() / f64::from(cloud.sigma_t);
        if x >= to.min(end) {
            return None;
        }
        if random.next() < cloud.density.at(origin + x * direction) {
            return Some(origin + x * direction);
        }
    }
}

/// Direction to a light, its distance, and the irradiance that it sends.
fn arriving(light: &Light, at: DVec3) -> (DVec3, f64, DVec3) {
    let from = |position: glam::Vec3| {
        let way = position.as_dvec3() - at;
        (way.normalize(), way.length())
    };
    match light {
        Light::Directional(light) => {
            (-light.direction.as_dvec3().normalize(), f64::INFINITY, light.irradiance.as_dvec3())
        }
        Light::Point(light) => {
            let (to_light, distance) = from(light.position);
            (to_light, distance, light.intensity.as_dvec3() / distance.powi(2))
        }
        Light::Spot(light) => {
            let (to_light, distance) = from(light.position);
            let intensity = light.intensity_towards(-to_light.as_vec3()).as_dvec3();
            (to_light, distance, intensity / distance.powi(2))
        }
    }
}

/// A direction after scattering: any direction, taken as often as the phase function says.
fn deflect(phase: &Phase, colour: usize, direction: DVec3, random: &mut Random) -> DVec3 {
    // No phase function is larger than it is straight ahead or straight back.
    let most = phase.eval(1.0)[colour].max(phase.eval(-1.0)[colour]);
    loop {
        let cube = DVec3::new(random.next(), random.next(), random.next()) * 2.0 - 1.0;
        if let Some(tried) = cube.try_normalize()
            && cube.length_squared() <= 1.0
            && random.next() * most < phase.eval(tried.dot(direction))[colour]
        {
            return tried;
        }
    }
}
