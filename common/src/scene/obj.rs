//! OBJ + MTL, by `tobj` behind filters that tame what it would stumble over ([`lines`], [`mtl`]).
//!
//! The whole file becomes one object with a material per triangle, so that its topology is that of
//! the model and not of its groups. Differs from the format: smoothing groups, free-form geometry,
//! lines, points and texture coordinates are not used; a texture counts as its mean colour.

mod lines;
mod mtl;
mod polygon;

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use tobj::{LoadOptions, Model};

use super::load::{LoadError, MAX_BYTES, MeshBuilder, Part, Pictures, raw_material, read, short, some_of};
use super::{Material, Object};
use lines::Lines;
use mtl::Library;

/// Loads an OBJ file and the material libraries that it names.
pub(super) fn load(path: &Path) -> Result<Part, LoadError> {
    let bytes = read(path, MAX_BYTES)?;
    let mut lines = Lines::new(&bytes);
    let library = RefCell::new(Library::new(path));
    let options =
        LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let parsed = tobj::load_obj_buf(&mut lines, &options, |name| library.borrow_mut().load(name));
    let library = library.into_inner();
    let (models, materials) = match parsed {
        Ok((models, materials)) => (models, materials.unwrap_or_default()),
        Err(error) => {
            let (line, problem) = lines.problem(error);
            return Err(LoadError::invalid(path, format!("line {line}"), problem));
        }
    };

    let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let mut part = Part::default();
    lines.say(&file, &mut part.notes);
    library.say(lines.used_materials(), &mut part.notes);
    let material_of = convert_materials(path, &file, &models, &materials, &library, &mut part);

    // Weld all models into one mesh.
    let has_normals = models.iter().any(|model| model.mesh.normals.iter().any(|&x| x != 0.0));
    let mut builder = MeshBuilder::new(has_normals);
    for model in models {
        let mesh = model.mesh;
        let material = material_of.get(&mesh.material_id).copied().unwrap_or(0);
        let at = |list: &[f32], index: u32| {
            let start = index as usize * 3;
            list.get(start..start + 3).map_or(Vec3::ZERO, Vec3::from_slice)
        };
        for corners in mesh.indices.chunks_exact(3) {
            let corners = [corners[0], corners[1], corners[2]];
            let positions = corners.map(|index| at(&mesh.positions, index));
            builder.push(positions, corners.map(|index| at(&mesh.normals, index)), material, path)?;
        }
    }
    if builder.dropped > 0 {
        part.notes.push(format!(
            "{file}: dropped {} triangles with corners that are not finite numbers within ±1e9 m",
            builder.dropped
        ));
    }
    let mesh = builder.finish();
    if mesh.triangles.is_empty() {
        let problem = "has no triangles; expected an OBJ model with `v` and `f` lines";
        return Err(LoadError::invalid(path, "", problem));
    }
    let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let world_from_object = Affine3A::IDENTITY;
    part.objects.push(Object { name, mesh: Arc::new(mesh), world_from_object });
    Ok(part)
}

/// Converts the materials that triangles use; the index of each by `tobj`'s.
fn convert_materials(
    path: &Path,
    file: &str,
    models: &[Model],
    materials: &[tobj::Material],
    library: &Library,
    part: &mut Part,
) -> HashMap<Option<usize>, u32> {
    let mut index_of = HashMap::new();
    let mut changed = Default::default();
    let mut pictures = Pictures::default();
    let (mut textured, mut glowing, mut clear) = (Vec::new(), Vec::new(), Vec::new());
    let (mut missing, mut first_problem) = (Vec::new(), None);
    for model in models {
        let id = model.mesh.material_id;
        if model.mesh.indices.is_empty() || index_of.contains_key(&id) {
            continue;
        }
        index_of.insert(id, part.materials.len() as u32);
        let Some(from) = id.and_then(|id| materials.get(id)) else {
            part.materials.push(Material::default());
            continue;
        };

        // A texture tints the diffuse colour, which is white where only the texture is given.
        let texture = from.diffuse_texture.as_deref().map(mtl::texture_name);
        let unset = if texture.is_some() { Vec3::ONE } else { Material::default().k_d };
        let mut k_d = from.diffuse.map_or(unset, Vec3::from_array);
        if let Some(texture) = texture {
            let texture_path = library.folder_of(id.unwrap_or(0)).unwrap_or(path).with_file_name(&texture);
            match pictures.mean(&texture_path) {
                Ok(mean) => {
                    k_d *= mean.linear;
                    textured.push(from.name.clone());
                }
                Err(problem) => {
                    missing.push(short(&texture));
                    first_problem.get_or_insert(problem);
                }
            }
        }
        // Illumination models 0 and 1 have no highlight, whatever Ks says.
        let has_highlight = from.illumination_model.is_none_or(|model| model >= 2);
        let k_s = if has_highlight { from.specular.map_or(Vec3::ZERO, Vec3::from_array) } else { Vec3::ZERO };
        let exponent = from.shininess.unwrap_or(1.0);
        part.materials.push(raw_material(&from.name, k_d, k_s, exponent, &mut changed));

        if from.emissive.is_some_and(|e| e.iter().any(|&x| x > 0.0)) {
            glowing.push(from.name.clone());
        }
        if from.dissolve.is_some_and(|d| d < 1.0) || from.dissolve_texture.is_some() {
            clear.push(from.name.clone());
        }
    }
    if let Some(problem) = first_problem {
        missing.sort();
        missing.dedup();
        part.notes
            .push(format!("{file}: materials go without the texture {} ({problem})", some_of(&missing)));
    }
    changed.say(file, &mut part.notes);
    for (names, what) in [
        (textured, "a texture counts as its mean colour in material"),
        (glowing, "surfaces emit no light here, so Ke was not used in material"),
        (clear, "surfaces are opaque here, so transparency was not used in material"),
    ] {
        if !names.is_empty() {
            part.notes.push(format!("{file}: {what} {}", some_of(&names)));
        }
    }
    index_of
}
