//! Whether two scenes are the same: a hash of all that they hold.

use super::Scene;
use crate::{Cloud, Density, Light, LightMap, Sky, SpotLight};

/// A hash of parts in order, none of which can run into the next.
#[derive(Default)]
pub(crate) struct Parts(blake3::Hasher);

impl Parts {
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// A cloud and the sky that it hangs in. Voxels and texels as bytes: there may be many.
    pub(crate) fn add_cloud(&mut self, cloud: &Cloud, sky: &Sky) {
        let Cloud { density, sigma_t, albedo, phase, emission } = cloud;
        self.add(format!("{sigma_t} {albedo:?} {phase:?} {emission:?}").as_bytes());
        match density {
            Density::Grid(grid) => {
                self.add(format!("grid {} {:?} {:?}", grid.cells, grid.low, grid.high).as_bytes());
                self.add(bytemuck::cast_slice(&grid.values));
            }
            other => self.add(format!("{other:?}").as_bytes()),
        }
        match sky {
            Sky::Picture(picture) => self.add_picture("sky", picture),
            other => self.add(format!("{other:?}").as_bytes()),
        }
    }

    fn add_picture(&mut self, name: &str, picture: &LightMap) {
        self.add(format!("{name} {}×{}", picture.width, picture.height).as_bytes());
        self.add(bytemuck::cast_slice(&picture.texels));
    }

    /// 128 bits in hexadecimal digits.
    pub(crate) fn finish(self) -> String {
        self.0.finalize().to_hex()[..32].to_owned()
    }
}

impl Scene {
    /// A hash of all that is drawn of this scene at any time, in hexadecimal digits; names and notes are left out.
    pub fn content_hash(&self) -> String {
        let mut parts = Parts::default();
        // Debug output gives every float its shortest exact form.
        parts.add(format!("{:?} {:?} {:?}", self.medium, self.camera, self.animation).as_bytes());
        for material in &self.materials {
            parts.add(format!("{:?} {:?} {}", material.k_d, material.k_s, material.exponent).as_bytes());
        }
        for light in &self.lights {
            match light {
                Light::Spot(spot @ SpotLight { light_map: Some(map), .. }) => {
                    parts.add(format!("{:?}", SpotLight { light_map: None, ..spot.clone() }).as_bytes());
                    parts.add_picture("light map", map);
                }
                other => parts.add(format!("{other:?}").as_bytes()),
            }
        }
        if let Some(cloud) = &self.cloud {
            parts.add_cloud(cloud, &self.sky);
        }
        for object in &self.objects {
            parts.add(format!("{:?}", object.world_from_object).as_bytes());
            parts.add(bytemuck::cast_slice(&object.mesh.positions));
            parts.add(bytemuck::cast_slice(&object.mesh.normals));
            parts.add(bytemuck::cast_slice(&object.mesh.triangles));
            parts.add(bytemuck::cast_slice(&object.mesh.materials));
        }
        parts.finish()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;

    use super::*;
    use crate::scene::builtin;

    #[test]
    fn it_changes_with_all_that_is_drawn_and_with_nothing_else() {
        let scene = || builtin::build("amphora", Some(1_000)).expect("built-in");
        let after = |change: &dyn Fn(&mut Scene)| {
            let mut scene = scene();
            change(&mut scene);
            scene.content_hash()
        };
        let unchanged = after(&|_| ());
        assert_eq!(after(&|scene| scene.name = "jug".into()), unchanged);
        let map = |texel| Some(Arc::new(LightMap { width: 1, height: 1, texels: vec![texel] }));
        let tinted = |scene: &mut Scene, texel| match &mut scene.lights[1] {
            Light::Spot(spot) => spot.light_map = map(texel),
            _ => panic!("the amphora has a spot"),
        };
        let mut hashes = vec![
            unchanged,
            after(&|scene| scene.medium.sigma_a *= 1.0 + 1e-6),
            after(&|scene| scene.camera.eye.x += 1e-6),
            after(&|scene| drop(scene.animation.pop())),
            after(&|scene| scene.lights.swap(0, 1)),
            after(&|scene| tinted(scene, Vec3::X)),
            after(&|scene| tinted(scene, Vec3::Y)),
            after(&|scene| scene.materials[0].exponent += 1.0),
            after(&|scene| scene.objects[0].world_from_object.translation.y += 0.1),
            after(&|scene| Arc::make_mut(&mut scene.objects[1].mesh).positions[3].z += 1e-6),
            after(&|scene| Arc::make_mut(&mut scene.objects[1].mesh).triangles.truncate(9)),
        ];
        let count = hashes.len();
        hashes.sort();
        hashes.dedup();
        assert_eq!(hashes.len(), count);
    }
}
