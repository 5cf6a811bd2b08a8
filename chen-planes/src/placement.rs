//! Where the planes are: depths that part the view into slabs.

use common::{Light, Medium, View};
use glam::{DVec2, DVec3, Vec3};

use crate::Placement;

/// Depths at which densities are found.
const STEPS: usize = 256;
/// Rays across and up that they are averaged over.
const RAYS: [u32; 2] = [8, 6];
/// Share of the planes that are placed evenly whatever the integrand: it knows nothing of shadows.
const EVEN_SHARE: f64 = 0.1;

/// Depths along the viewing direction \[m\], from 0 to `reach`, `planes` + 1 of them: where slabs begin and end.
pub fn slabs(
    placement: Placement,
    planes: u32,
    reach: f32,
    view: &View,
    medium: &Medium,
    light: &Light,
) -> Vec<f32> {
    let even = |i: u32| f64::from(reach) * f64::from(i) / f64::from(planes);
    let density = match placement {
        Placement::Even => None,
        Placement::EquiAngular if matches!(light, Light::Directional(_)) => None,
        _ => density(placement, f64::from(reach), view, medium, light),
    };
    let Some(density) = density else {
        return (0..=planes).map(|i| even(i) as f32).collect();
    };
    // Equal parts of the integral of a density that is constant within a step.
    let total: f64 = density.iter().sum();
    let part = total / f64::from(planes);
    let width = f64::from(reach) / density.len() as f64;
    let mut depths = vec![0.0];
    let mut before = 0.0;
    for (i, step) in density.iter().enumerate() {
        while depths.len() < planes as usize {
            let within = part * depths.len() as f64 - before;
            if within > *step {
                break;
            }
            depths.push(((i as f64 + within / step) * width) as f32);
        }
        before += step;
    }
    depths.resize(planes as usize, reach);
    depths.push(reach);
    depths
}

/// How densely planes are to be, step by step up to the reach; `None` where it is nowhere or not a number.
fn density(
    placement: Placement,
    reach: f64,
    view: &View,
    medium: &Medium,
    light: &Light,
) -> Option<Vec<f64>> {
    let rays = rays(view);
    let sigma = f64::from(medium.sigma_t().element_sum()) / 3.0;
    let ray_of = |ray: &DVec3| Ray::new(*ray, view, light);
    let rays: Vec<Ray> = rays.iter().map(ray_of).collect();
    let at = |i: usize| reach * (i as f64 + 0.5) / STEPS as f64;
    let mean = |f: &dyn Fn(&Ray, f64) -> f64, depth: f64| {
        rays.iter().map(|ray| f(ray, depth / ray.cosine)).sum::<f64>() / rays.len() as f64
    };
    let value: Box<dyn Fn(f64) -> f64> = match placement {
        Placement::Even => return None,
        Placement::EquiAngular => {
            Box::new(|depth| mean(&|ray, t| ray.equi_angular(t, reach / ray.cosine), depth))
        }
        Placement::Transmittance => Box::new(|depth| mean(&|_, t| (-sigma * t).exp(), depth)),
        Placement::Integrand => {
            Box::new(|depth| mean(&|ray, t| ray.integrand(t, sigma, medium, light).powi(2), depth).cbrt())
        }
    };
    let mut density: Vec<f64> = (0..STEPS).map(|i| value(at(i))).collect();
    let average = density.iter().sum::<f64>() / STEPS as f64;
    if !average.is_finite() || average <= 0.0 {
        return None;
    }
    for step in &mut density {
        *step += EVEN_SHARE * average;
    }
    Some(density)
}

/// Unit rays through the view.
fn rays(view: &View) -> Vec<DVec3> {
    let (right, up, forward) = view.camera.basis();
    let half = view.half_extent();
    let [columns, rows] = RAYS;
    let at = |i: u32, count: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(count) - 1.0;
    let ray = |u: f64, v: f64| {
        let across = DVec2::new(u, v) * half.as_dvec2();
        (forward.as_dvec3() + across.x * right.as_dvec3() + across.y * up.as_dvec3()).normalize()
    };
    (0..rows).flat_map(|v| (0..columns).map(move |u| ray(at(u, columns), at(v, rows)))).collect()
}

/// A view ray, and where a light lies relative to it.
struct Ray {
    direction: DVec3,
    eye: DVec3,
    /// Of the angle between the ray and the viewing direction.
    cosine: f64,
    /// Distance along the ray to the foot of the perpendicular from the light, and its length \[m\].
    along: f64,
    height: f64,
}

impl Ray {
    fn new(direction: DVec3, view: &View, light: &Light) -> Self {
        let eye = view.camera.eye.as_dvec3();
        let forward = view.camera.basis().2.as_dvec3();
        let to_light = light.position().map_or(DVec3::ZERO, Vec3::as_dvec3) - eye;
        Self {
            direction,
            eye,
            cosine: direction.dot(forward),
            along: to_light.dot(direction),
            // No ray of few passes the light as near as some pixel's does.
            height: to_light.cross(direction).length().max(1e-3 * to_light.length()).max(f64::MIN_POSITIVE),
        }
    }

    /// Change of the angle at the light with distance, over the whole angle up to `end`.
    fn equi_angular(&self, t: f64, end: f64) -> f64 {
        let x = t - self.along;
        let angle = |x: f64| (x / self.height).atan();
        let whole = angle(end - self.along) - angle(-self.along);
        self.height / (self.height * self.height + x * x) / whole
    }

    /// In-scattering without shadows and the light's strength.
    fn integrand(&self, t: f64, sigma: f64, medium: &Medium, light: &Light) -> f64 {
        let phase = |cosine: f64| medium.phase.eval(cosine).element_sum();
        let Some(position) = light.position() else {
            let direction = if let Light::Directional(sun) = light { sun.direction } else { Vec3::ZERO };
            return phase(-direction.as_dvec3().dot(self.direction)) * (-sigma * t).exp();
        };
        let away = self.eye + t * self.direction - position.as_dvec3();
        let distance = self.height.hypot(t - self.along);
        let towards = away / distance;
        let intensity = match light {
            Light::Spot(spot) => f64::from(spot.falloff(towards.as_vec3().dot(spot.direction))),
            _ => 1.0,
        };
        intensity * phase(-towards.dot(self.direction)) * (-sigma * (t + distance)).exp()
            / (distance * distance)
    }
}

/// How far planes have to reach \[m\]: the depth along the viewing direction of the farthest corner of `bounds` (low and
/// high corner of the scene) and of every light; in empty air twice the way to the lights. No farther than where the
/// medium has left `exp(−12)` of all colours, counted from the eye or from the farthest light: in dense fog what light
/// there is comes from around the lights.
pub fn reach(view: &View, bounds: Option<(Vec3, Vec3)>, lights: &[Light], medium: &Medium) -> f32 {
    let eye = view.camera.eye;
    let forward = view.camera.basis().2;
    let depth = |position: Vec3| (position - eye).dot(forward);
    let positions = lights.iter().filter_map(Light::position);
    let farthest = match bounds {
        Some((low, high)) => {
            let corner = Vec3::select(forward.cmpgt(Vec3::ZERO), high, low);
            positions.map(depth).fold(depth(corner), f32::max)
        }
        None => positions.map(|position| 2.0 * position.distance(eye)).fold(0.0, f32::max),
    };
    // Behind the eye there is nothing but air, whose size is that of its extinction.
    let farthest = if farthest > 2.0 * view.depth.near { farthest } else { f32::INFINITY };
    let sigma = medium.sigma_t().min_element();
    let lit = lights.iter().filter_map(Light::position).map(|at| at.distance(eye)).fold(0.0, f32::max);
    let thin = if sigma > 0.0 { lit + 12.0 / sigma } else { f32::INFINITY };
    let reach = farthest.min(thin).max(2.0 * view.depth.near);
    if reach.is_finite() { reach } else { 1e4 * view.depth.near }
}

#[cfg(test)]
mod tests {
    use common::gpu::bench::scenes::{boxes, point, spot, sun};

    use super::*;

    #[test]
    fn slabs_follow_each_other_from_the_eye_to_the_reach() {
        for light in [point(), spot(0.3, 0.6), sun()] {
            let scene = boxes(light, 0.1);
            let view = scene.camera.view(64, 48);
            let reach = reach(&view, scene.bounds(), &scene.lights, &scene.medium);
            for placement in
                [Placement::Even, Placement::EquiAngular, Placement::Transmittance, Placement::Integrand]
            {
                for planes in [1, 2, 7, 1000] {
                    let slabs = slabs(placement, planes, reach, &view, &scene.medium, &scene.lights[0]);
                    assert_eq!(slabs.len(), planes as usize + 1);
                    assert_eq!((slabs[0], slabs[planes as usize]), (0.0, reach));
                    assert!(slabs.windows(2).all(|ends| ends[0] < ends[1]), "{placement:?} {slabs:?}");
                }
            }
        }
    }

    #[test]
    fn slabs_grow_where_less_comes_from() {
        let mut scene = boxes(sun(), 0.5);
        scene.camera.fov_y = 0.02;
        let view = scene.camera.view(8, 6);
        let found = slabs(Placement::Transmittance, 64, 10.0, &view, &scene.medium, &scene.lights[0]);
        // As dense as exp(-t/2) and a tenth of its mean: what lies in front of half of the planes, in closed form.
        let share = |t: f64| 2.0 * (1.0 - (-0.5 * t).exp()) + 0.1 * t * 0.2 * (1.0 - (-5.0f64).exp());
        let half = share(f64::from(found[32])) / share(10.0);
        assert!((half - 0.5).abs() < 1e-3, "{half}");
        // Around a light they are dense.
        let scene = boxes(point(), 0.1);
        let view = scene.camera.view(64, 48);
        let depth = scene.lights[0].position().map(|at| (at - view.camera.eye).dot(view.camera.basis().2));
        for placement in [Placement::EquiAngular, Placement::Integrand] {
            let found = slabs(placement, 64, 12.0, &view, &scene.medium, &scene.lights[0]);
            let nearest = found.windows(2).min_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
            let off = nearest.map(|ends| (0.5 * (ends[0] + ends[1]) - depth.unwrap()).abs());
            assert!(off.is_some_and(|off| off < 0.5), "{placement:?}: {off:?}");
        }
    }
}
