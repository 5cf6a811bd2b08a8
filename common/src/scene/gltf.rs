//! glTF 2.0 and GLB: meshes, materials, cameras and `KHR_lights_punctual`.
//!
//! Each node with a mesh becomes one object with a material per triangle. Approximations: (1) a
//! metal reflects its base colour by a Phong lobe of the same width, anything else all of it
//! diffusely; (2) textures count as their means; (3) candela and lux are taken for W/sr and W/m².
//! Skins, morph targets and animations are not used.

mod data;
mod material;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use ::gltf::json;
use glam::{Affine3A, Mat4, Quat, Vec3};
use json::camera::Type as CameraType;
use json::extensions::scene::khr_lights_punctual::Type as LightType;
use json::mesh::{Mode, Primitive, Semantic};
use json::validation::Checked;

use super::load::{LoadError, MeshBuilder, Part, short, some_of};
use super::{Mesh, Object};
use crate::{Camera, DirectionalLight, Light, PointLight, SpotLight};
use data::Data;

/// Loads a glTF or GLB file.
pub(super) fn load(path: &Path) -> Result<Part, LoadError> {
    let data = Data::load(path)?;
    let mut loader = Loader {
        file: path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
        data: &data,
        part: Part::default(),
        meshes: HashMap::new(),
        materials: material::Materials::default(),
        lights: Vec::new(),
        counts: Counts::default(),
    };
    loader.nodes()?;
    loader.finish()
}

struct Loader<'a> {
    file: String,
    data: &'a Data,
    part: Part,
    /// Meshes by their index and whether they are mirrored.
    meshes: HashMap<(usize, bool), Option<Arc<Mesh>>>,
    materials: material::Materials,
    lights: Vec<Light>,
    counts: Counts,
}

/// What was left out or changed.
#[derive(Default)]
struct Counts {
    points_and_lines: usize,
    not_finite: usize,
    coloured: usize,
    morphed: usize,
    flat_nodes: Vec<String>,
    orthographic: usize,
    wide_spots: usize,
    ranged: usize,
}

impl<'a> Loader<'a> {
    /// Walks over the nodes of the default scene.
    fn nodes(&mut self) -> Result<(), LoadError> {
        let root = &self.data.root;
        let scene = root.scene.map_or(0, |index| index.value());
        let roots: Vec<usize> = match root.scenes.get(scene) {
            Some(scene) => scene.nodes.iter().map(|index| index.value()).collect(),
            None if root.scene.is_none() => (0..root.nodes.len()).collect(),
            None => return Err(self.invalid("scene", format!("scene {scene} does not exist"))),
        };
        // Without a scene, all nodes that are nobody's child.
        let children = root.nodes.iter().flat_map(|node| node.children.iter().flatten());
        let children: Vec<usize> = children.map(|index| index.value()).collect();
        let no_scene = root.scenes.is_empty();
        let mut is_child = vec![false; root.nodes.len()];
        for child in children {
            if let Some(is_child) = is_child.get_mut(child).filter(|_| no_scene) {
                *is_child = true;
            }
        }

        // A stack of our own: a deep hierarchy must not overflow the thread's.
        let mut seen = vec![false; root.nodes.len()];
        let mut stack: Vec<(usize, Mat4)> = roots.into_iter().map(|index| (index, Mat4::IDENTITY)).collect();
        stack.retain(|(index, _)| !is_child.get(*index).copied().unwrap_or(false));
        stack.reverse();
        while let Some((index, world_from_parent)) = stack.pop() {
            let place = format!("nodes[{index}]");
            let Some(node) = root.nodes.get(index) else {
                let problem = format!("does not exist; expected less than {}", root.nodes.len());
                return Err(self.invalid(&place, problem));
            };
            if std::mem::replace(&mut seen[index], true) {
                let problem = "has more than one parent or is its own ancestor; expected a tree";
                return Err(self.invalid(&place, problem));
            }
            let world = world_from_parent * local_transform(node);
            self.node(index, node, world)?;
            let children = node.children.iter().flatten().rev();
            stack.extend(children.map(|child| (child.value(), world)));
        }
        Ok(())
    }

    /// Takes what hangs on a node.
    fn node(&mut self, index: usize, node: &json::Node, world: Mat4) -> Result<(), LoadError> {
        let light = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if node.mesh.is_none() && node.camera.is_none() && light.is_none() {
            return Ok(());
        }
        let name = node.name.as_deref().map_or_else(|| format!("node {index}"), short);
        let world = Affine3A::from_mat4(world);
        let determinant = world.matrix3.determinant();
        let is_usable = world.is_finite() && determinant != 0.0 && world.inverse().is_finite();
        if !is_usable {
            self.counts.flat_nodes.push(name);
            return Ok(());
        }

        if let Some(mesh) = node.mesh {
            // A mirror turns the triangles inside out; turn them back.
            let key = (mesh.value(), determinant < 0.0);
            let mesh = match self.meshes.get(&key) {
                Some(mesh) => mesh.clone(),
                None => {
                    let mesh = self.mesh(key.0, key.1)?;
                    self.meshes.insert(key, mesh.clone());
                    mesh
                }
            };
            if let Some(mesh) = mesh {
                let name = name.clone();
                self.part.objects.push(Object { name, mesh, world_from_object: world });
            }
        }
        if let Some(camera) = node.camera.filter(|_| self.part.camera.is_none()) {
            self.camera(camera.value(), &world)?;
        }
        if let Some(light) = light {
            self.light(light.light.value(), &world)?;
        }
        Ok(())
    }

    /// Welds the primitives of a mesh into one; `None` if it has no triangles.
    fn mesh(&mut self, index: usize, mirrored: bool) -> Result<Option<Arc<Mesh>>, LoadError> {
        let root = &self.data.root;
        let Some(mesh) = root.meshes.get(index) else {
            let problem = format!("does not exist; expected less than {}", root.meshes.len());
            return Err(self.invalid(&format!("meshes[{index}]"), problem));
        };
        let normal_key = Checked::Valid(Semantic::Normals);
        let has_normals = mesh.primitives.iter().any(|p| p.attributes.contains_key(&normal_key));
        let mut builder = MeshBuilder::new(has_normals);
        for (at, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{index}].primitives[{at}]");
            self.primitive(primitive, &place, mirrored, &mut builder)?;
        }
        self.counts.not_finite += builder.dropped;
        let mesh = builder.finish();
        Ok((!mesh.triangles.is_empty()).then(|| Arc::new(mesh)))
    }

    fn primitive(
        &mut self,
        primitive: &Primitive,
        place: &str,
        mirrored: bool,
        builder: &mut MeshBuilder,
    ) -> Result<(), LoadError> {
        let mode = match primitive.mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => {
                return Err(self.invalid(&format!("{place}.mode"), "unknown; expected 0 to 6"));
            }
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.counts.points_and_lines += 1;
            return Ok(());
        }
        let attribute =
            |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|index| index.value());
        let Some(positions) = attribute(Semantic::Positions) else {
            return Err(self.invalid(place, "has no POSITION; expected one"));
        };
        let path = &self.data.path;
        let wrong = |(at, what): (String, String)| LoadError::invalid(path, format!("{place}: {at}"), what);
        let positions = self.data.vectors(positions).map_err(wrong)?;
        let normals = match attribute(Semantic::Normals) {
            Some(normals) => self.data.vectors(normals).map_err(wrong)?,
            None => Vec::new(),
        };
        let indices = match primitive.indices {
            Some(indices) => self.data.indices(indices.value()).map_err(wrong)?,
            None => (0..positions.len() as u32).collect(),
        };
        self.counts.coloured += usize::from(attribute(Semantic::Colors(0)).is_some());
        self.counts.morphed += usize::from(primitive.targets.as_ref().is_some_and(|t| !t.is_empty()));
        let material = self.materials.index(primitive.material, place, self.data, &mut self.part)?;

        let count = match mode {
            Mode::Triangles => indices.len() / 3,
            _ => indices.len().saturating_sub(2),
        };
        for triangle in 0..count {
            // A strip's triangles turn the other way at every second.
            let corners = match mode {
                Mode::Triangles => [3 * triangle, 3 * triangle + 1, 3 * triangle + 2],
                Mode::TriangleFan => [0, triangle + 1, triangle + 2],
                _ if triangle % 2 == 0 => [triangle, triangle + 1, triangle + 2],
                _ => [triangle + 1, triangle, triangle + 2],
            };
            let [a, b, c] = corners.map(|corner| indices[corner]);
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            let position = |vertex: u32| positions.get(vertex as usize).copied().map(Vec3::from_array);
            let [Some(a), Some(b), Some(c)] = corners.map(position) else {
                let largest = a.max(b).max(c);
                let problem =
                    format!("index {largest} in triangle {triangle}; expected less than {}", positions.len());
                return Err(self.invalid(&format!("{place}.indices"), problem));
            };
            let normal =
                |vertex: u32| normals.get(vertex as usize).map_or(Vec3::ZERO, |n| Vec3::from_array(*n));
            builder.push([a, b, c], corners.map(normal), material, &self.data.path)?;
        }
        Ok(())
    }

    fn camera(&mut self, index: usize, world: &Affine3A) -> Result<(), LoadError> {
        let place = format!("cameras[{index}]");
        let Some(camera) = self.data.root.cameras.get(index) else {
            return Err(self.invalid(&place, "does not exist"));
        };
        let perspective = camera.perspective.as_ref();
        let Some(perspective) =
            perspective.filter(|_| camera.type_ == Checked::Valid(CameraType::Perspective))
        else {
            self.counts.orthographic += 1;
            return Ok(());
        };
        let eye = Vec3::from(world.translation);
        let forward = -Vec3::from(world.matrix3.z_axis).normalize_or_zero();
        let up = Vec3::from(world.matrix3.y_axis).normalize_or_zero();
        // A target at the distance of the eye from the origin keeps the precision of both.
        let target = eye + forward * eye.length().max(1.0);
        let camera = Camera { eye, target, up, fov_y: perspective.yfov };
        if let Some(problem) = camera.problem() {
            return Err(self.invalid(&place, format!("the camera {problem}")));
        }
        self.part.camera = Some(camera);
        Ok(())
    }

    fn light(&mut self, index: usize, world: &Affine3A) -> Result<(), LoadError> {
        let place = format!("KHR_lights_punctual.lights[{index}]");
        let extension = self.data.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let Some(light) = extension.and_then(|e| e.lights.get(index)) else {
            return Err(self.invalid(&place, "does not exist"));
        };
        let strength = Vec3::from_array(light.color) * light.intensity;
        let position = Vec3::from(world.translation);
        let direction = -Vec3::from(world.matrix3.z_axis).normalize_or_zero();
        self.counts.ranged += usize::from(light.range.is_some());
        let made = match light.type_ {
            Checked::Valid(LightType::Point) => Light::Point(PointLight { position, intensity: strength }),
            Checked::Valid(LightType::Directional) => {
                Light::Directional(DirectionalLight { direction, irradiance: strength })
            }
            Checked::Valid(LightType::Spot) => {
                let spot = light.spot.clone().unwrap_or_default();
                let (inner, outer) = match light.spot {
                    Some(_) => (spot.inner_cone_angle, spot.outer_cone_angle),
                    None => (0.0, std::f32::consts::FRAC_PI_4),
                };
                let outer_angle = outer.min(SpotLight::MAX_ANGLE);
                self.counts.wide_spots += usize::from(outer > SpotLight::MAX_ANGLE);
                Light::Spot(SpotLight {
                    position,
                    direction,
                    up: Vec3::from(world.matrix3.y_axis).normalize_or_zero(),
                    intensity: strength,
                    inner_angle: inner.min(outer_angle),
                    outer_angle,
                    light_map: None,
                })
            }
            Checked::Invalid => {
                let problem = "unknown; expected point, spot or directional";
                return Err(self.invalid(&format!("{place}.type"), problem));
            }
        };
        if let Some(problem) = made.problem() {
            return Err(self.invalid(&place, format!("the {} light {problem}", made.kind())));
        }
        self.lights.push(made);
        Ok(())
    }

    /// Says what was left out, and hands over what there is.
    fn finish(self) -> Result<Part, LoadError> {
        let Self { file, data, mut part, materials, lights, counts, .. } = self;
        if part.objects.is_empty() {
            let also = if counts.points_and_lines > 0 { " but points and lines" } else { "" };
            let problem = format!("has nothing{also} in its scene; expected triangles");
            return Err(LoadError::invalid(&data.path, "", problem));
        }
        materials.say(&file, &mut part.notes);
        let mut note = |is_so: bool, text: String| {
            if is_so {
                part.notes.push(format!("{file}: {text}"));
            }
        };
        let mut unused = data.root.extensions_used.clone();
        unused.retain(|name| !data::KNOWN.contains(&name.as_str()));
        note(!unused.is_empty(), format!("extensions that were not used: {}", some_of(&unused)));
        let n = counts.points_and_lines;
        note(n > 0, format!("{n} primitives of points or lines were dropped"));
        let n = counts.not_finite;
        note(n > 0, format!("dropped {n} triangles with corners that are not finite numbers within ±1e9 m"));
        note(counts.coloured > 0, "vertex colours were not used".into());
        note(counts.morphed > 0, "morph targets were not used".into());
        note(!data.root.skins.is_empty(), "skins were not used; all stands as it was bound".into());
        note(
            !data.root.animations.is_empty(),
            "animations were not used; a JSON scene file can have its own".into(),
        );
        let flat = &counts.flat_nodes;
        note(!flat.is_empty(), format!("dropped nodes whose transform can't be inverted: {}", some_of(flat)));
        note(counts.orthographic > 0, "orthographic cameras were not used".into());
        note(
            counts.wide_spots > 0,
            "spot lights wider than 85° from their axis were narrowed to that".into(),
        );
        note(
            counts.ranged > 0,
            "the ranges of lights were not used; they reach as far as the medium lets them".into(),
        );
        note(!lights.is_empty(), "candela were taken for W/sr and lux for W/m², one to one".into());
        part.lights = (!lights.is_empty()).then_some(lights);
        Ok(part)
    }

    fn invalid(&self, place: &str, problem: impl Into<String>) -> LoadError {
        LoadError::invalid(&self.data.path, place, problem)
    }
}

/// Parent from node.
fn local_transform(node: &json::Node) -> Mat4 {
    if let Some(matrix) = &node.matrix {
        return Mat4::from_cols_array(matrix);
    }
    let scale = node.scale.map_or(Vec3::ONE, Vec3::from_array);
    let translation = node.translation.map_or(Vec3::ZERO, Vec3::from_array);
    let rotation = node.rotation.map_or(Quat::IDENTITY, |rotation| {
        // In double precision: a long quaternion's square must not overflow.
        let q = glam::DQuat::from_array(rotation.0.map(f64::from));
        if q.length() > 0.0 { q.normalize().as_quat() } else { Quat::IDENTITY }
    });
    Mat4::from_scale_rotation_translation(scale, rotation, translation)
}
