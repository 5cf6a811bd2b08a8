//! What a user would otherwise pick, each as good as its practice has it.

pub(crate) mod froxels;
pub(crate) mod raymarch;

use common::{Scene, View};

/// Where a ray that meets no surface ends \[m\]: ten sizes of the scene behind all that is in it, or
/// where the medium has left `exp(−12)` of any colour.
pub(crate) fn reach(scene: &Scene, view: &View) -> f32 {
    let geometric = view.camera.eye.distance(middle(scene, view).0) + 10.0 * middle(scene, view).1;
    let sigma = scene.medium.sigma_t().min_element();
    if sigma > 0.0 { geometric.min(12.0 / sigma) } else { geometric }
}

/// Centre of the scene and distance of the farthest of its corners and lights from there \[m\].
fn middle(scene: &Scene, view: &View) -> (glam::Vec3, f32) {
    let eye = view.camera.eye;
    let (low, high) = scene.bounds().unwrap_or((eye - 1.0, eye + 1.0));
    let (centre, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
    let lights = scene.lights.iter().filter_map(|light| light.position());
    (centre, lights.map(|light| light.distance(centre)).fold(radius, f32::max))
}

#[cfg(test)]
mod tests;
