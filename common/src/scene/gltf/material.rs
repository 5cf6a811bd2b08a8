//! Materials of a glTF file, in terms of a diffuse and a Phong reflectance.

use std::collections::HashMap;

use ::gltf::json;
use glam::Vec3;
use json::Index;
use json::material::AlphaMode;
use json::validation::Checked;

use super::data::Data;
use crate::scene::Material;
use crate::scene::load::{LoadError, MaterialNotes, Mean, Part, raw_material, short, some_of};

/// The materials that primitives use.
#[derive(Default)]
pub(super) struct Materials {
    index_of: HashMap<Option<usize>, u32>,
    means: HashMap<usize, Result<Mean, String>>,
    changed: MaterialNotes,
    textured: Vec<String>,
    untextured: Vec<String>,
    glowing: Vec<String>,
    clear: Vec<String>,
}

impl Materials {
    /// The index in the scene of a primitive's material, which is converted when first met.
    pub(super) fn index(
        &mut self,
        material: Option<Index<json::Material>>,
        place: &str,
        data: &Data,
        part: &mut Part,
    ) -> Result<u32, LoadError> {
        let id = material.map(|index| index.value());
        if let Some(&index) = self.index_of.get(&id) {
            return Ok(index);
        }
        let made = match id {
            None => Material::default(),
            Some(id) => match data.root.materials.get(id) {
                Some(material) => self.convert(id, material, data),
                None => {
                    let problem = format!("material {id} does not exist");
                    return Err(LoadError::invalid(&data.path, place, problem));
                }
            },
        };
        let index = part.materials.len() as u32;
        part.materials.push(made);
        self.index_of.insert(id, index);
        Ok(index)
    }

    fn convert(&mut self, id: usize, from: &json::Material, data: &Data) -> Material {
        let name = from.name.as_deref().map_or_else(|| format!("material {id}"), short);
        let pbr = &from.pbr_metallic_roughness;
        let [r, g, b, _] = pbr.base_color_factor.0;
        let mut base = Vec3::new(r, g, b);
        let (mut metallic, mut roughness) = (pbr.metallic_factor.0, pbr.roughness_factor.0);
        if let Some(mean) = self.mean(pbr.base_color_texture.as_ref(), &name, data) {
            base *= mean.linear;
        }
        // Green holds the roughness, blue the metalness; neither is a colour.
        if let Some(mean) = self.mean(pbr.metallic_roughness_texture.as_ref(), &name, data) {
            roughness *= mean.stored.y;
            metallic *= mean.stored.z;
        }
        if from.emissive_factor.0.iter().any(|&x| x > 0.0) {
            self.glowing.push(name.clone());
        }
        if from.alpha_mode != Checked::Valid(AlphaMode::Opaque) {
            self.clear.push(name.clone());
        }

        let metallic = if metallic.is_nan() { 0.0 } else { metallic.clamp(0.0, 1.0) };
        raw_material(
            &name,
            base * (1.0 - metallic),
            base * metallic,
            phong_exponent(roughness),
            &mut self.changed,
        )
    }

    /// The mean of a texture, if there is one; a note if it can't be had.
    fn mean(&mut self, info: Option<&json::texture::Info>, name: &str, data: &Data) -> Option<Mean> {
        let texture = data.root.textures.get(info?.index.value());
        let image = texture.map_or(usize::MAX, |texture| texture.source.value());
        let mean = self.means.entry(image).or_insert_with(|| image_mean(image, data)).clone();
        match mean {
            Ok(mean) => {
                self.textured.push(name.into());
                Some(mean)
            }
            Err(problem) => {
                self.untextured.push(format!("{name}: {problem}"));
                None
            }
        }
    }

    /// Says what was changed or left out.
    pub(super) fn say(mut self, file: &str, notes: &mut Vec<String>) {
        self.changed.say(file, notes);
        self.textured.dedup();
        for (names, what) in [
            (self.textured, "a texture counts as its mean in material"),
            (self.untextured, "textures could not be used in material"),
            (self.glowing, "surfaces emit no light here, so the emission was not used of material"),
            (self.clear, "surfaces are opaque here, so alpha was not used in material"),
        ] {
            if !names.is_empty() {
                notes.push(format!("{file}: {what} {}", some_of(&names)));
            }
        }
    }
}

fn image_mean(index: usize, data: &Data) -> Result<Mean, String> {
    let image = data.root.images.get(index).ok_or("its image does not exist")?;
    match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            let bytes = data.resource(uri, &format!("images[{index}]")).map_err(|error| error.to_string())?;
            Mean::of(&bytes)
        }
        (None, Some(view)) => {
            Mean::of(data.view(view.value()).map_err(|(place, what)| format!("{place}: {what}"))?)
        }
        (None, None) => Err("its image has neither uri nor bufferView".into()),
    }
}

/// The Phong exponent of a lobe as wide as GGX's of this roughness: `2/α² − 2` with `α = roughness²`.
fn phong_exponent(roughness: f32) -> f32 {
    let roughness = if roughness.is_nan() { 1.0 } else { roughness.clamp(0.0, 1.0) };
    let alpha = (roughness * roughness).max(1e-3);
    (2.0 / (alpha * alpha) - 2.0).clamp(0.0, 1000.0)
}
