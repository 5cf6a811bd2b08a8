//! Clouds in clear air: no triangles.

use std::f32::consts::PI;

use glam::Vec3;

use crate::cloud::Cumulus;
use crate::scene::Scene;
use crate::scene::animation::{Motion, Target, Track};
use crate::{Camera, Cloud, Density, DirectionalLight, Light, Lobe, Phase, Sky};

fn parallel(direction: Vec3, irradiance: Vec3) -> Light {
    Light::Directional(DirectionalLight { direction: direction.normalize(), irradiance })
}

/// A homogeneous sphere of optical depth 20 across, in white light from the upper right. Of an albedo of 0.9
/// and isotropic, it scatters 0.5415 (± 0.001) of what meets it and lets 0.005 through.
pub fn sphere() -> Scene {
    Scene {
        cloud: Some(Cloud {
            density: Density::Sphere { centre: Vec3::ZERO, radius: 1.0 },
            sigma_t: 10.0,
            albedo: Vec3::splat(0.9),
            phase: Phase::isotropic(),
            emission: Vec3::ZERO,
        }),
        lights: vec![parallel(Vec3::new(-0.7, -0.5, -0.5), Vec3::splat(PI))],
        camera: Camera { eye: Vec3::new(0.0, 0.0, 4.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.7 },
        ..Scene::empty("sphere")
    }
}

/// A cumulus of 100 m, an optical depth of about 20 through it, in a warm sun from the upper left, weaker light
/// from the lower right and a bluish sky; the camera goes around it in a minute. Albedo and phase function are
/// those of Szirmay-Kalos et al. 2005.
pub fn cloud() -> Scene {
    let (eye, target) = (Vec3::new(0.0, 45.0, 170.0), Vec3::new(0.0, 45.0, 0.0));
    Scene {
        cloud: Some(Cloud {
            density: Density::Cumulus(Cumulus::new(Vec3::new(0.0, 20.0, 0.0), 100.0, 7)),
            sigma_t: 0.55,
            albedo: Vec3::splat(0.9),
            phase: Lobe::CornetteShanks { g: 0.0 }.into(),
            emission: Vec3::ZERO,
        }),
        lights: vec![
            parallel(Vec3::new(0.75, -0.6, -0.3), Vec3::new(12.0, 10.0, 7.0)),
            parallel(Vec3::new(-0.8, 0.5, -0.3), Vec3::new(1.5, 1.6, 2.0)),
        ],
        sky: Sky::Constant(Vec3::new(0.25, 0.4, 0.7)),
        camera: Camera { eye, target, up: Vec3::Y, fov_y: 0.75 },
        animation: vec![Track {
            target: Target::CameraEye,
            motion: Motion::Orbit { centre: target, axis: Vec3::Y, period: 60.0 },
        }],
        ..Scene::empty("cloud")
    }
}
