//! Projections taken apart: what a foreign map shows, and how a map of ours is read from it.

use glam::{DMat4, DVec3, DVec4, Mat3, Mat4, Vec3};

use super::ReadingUniform;
use crate::Light;
use crate::gpu::shadow::{Projection, ShadowLayer, clip_from_world, map_reach, shadow_projection};

/// A projection that is wrong: which, and what about it.
type Wrong = (usize, String);

/// What rounding may make of a right angle in a matrix of 32-bit floats.
const ROUNDING: f64 = 1e-4;

/// A projection's parts. A perspective's directions have length 1 at distance 1, a parallel one's are in metres.
struct Lens {
    /// Apex, or the middle of the near plane \[m\].
    origin: DVec3,
    /// Half extents of the texture, from its middle to its edges.
    half: [f64; 2],
    /// Unit vector upwards on the texture. Left and right may be exchanged.
    up: DVec3,
    /// Unit viewing direction.
    forward: DVec3,
    /// Depth at infinity (perspective: depth = offset + scale / distance), or 0 or 1 at the near plane.
    offset: f64,
    scale: f64,
}

/// The projection of a map of `size`² texels drawn with these matrices, and how its layers are read.
pub(super) fn read(
    light: &Light,
    (low, high): (Vec3, Vec3),
    size: u32,
    matrices: &[Mat4],
) -> Result<(Projection, Vec<ReadingUniform>), Wrong> {
    let lens = |index: usize| {
        let of = |matrix: Mat4| Lens::of(matrix.as_dmat4(), light);
        of(matrices[index]).map_err(|problem| (index, problem))
    };
    let (reach, far) = map_reach(light, Some((low, high)));
    match light {
        Light::Directional(_) => {
            let lens = lens(0)?;
            let layer = lens.layer(size, lens.origin);
            let range = (1.0 / lens.scale.abs()) as f32;
            let reversed = lens.scale < 0.0;
            let (scale, offset) = if reversed { (1.0, 0.0) } else { (-1.0, 1.0) };
            let axes = [layer.right.extend(0.0), layer.up.extend(0.0), layer.origin.extend(1.0)];
            let reading = reading(matrices[0], axes, [scale, offset], 0);
            let layers = vec![with_clip(layer, size, None, range)];
            Ok((Projection { size, near: 0.0, far, range, layers }, vec![reading]))
        }
        Light::Spot(spot) => {
            let lens = lens(0)?;
            lens.is_at(spot.position, reach).map_err(|problem| (0, problem))?;
            let layer = lens.layer(size, spot.position.as_dvec3());
            if !has_cone(&layer, size, spot.direction, spot.outer_angle) {
                let problem =
                    "does not have all of the light's cone in it; make its field of view twice `outer_angle`";
                return Err((0, problem.into()));
            }
            let near = lens.near();
            let reading = reading(matrices[0], directions(&layer), lens.reversing(near), 0);
            let layers = vec![with_clip(layer, size, Some(near as f32), 0.0)];
            Ok((Projection { size, near: near as f32, far, range: 0.0, layers }, vec![reading]))
        }
        Light::Point(point) => {
            let lenses = (0..matrices.len()).map(lens).collect::<Result<Vec<_>, _>>()?;
            for (index, lens) in lenses.iter().enumerate() {
                lens.is_at(point.position, reach).map_err(|problem| (index, problem))?;
                if lens.half[0].min(lens.half[1]) < 1.0 - 1e-3 {
                    return Err((index, "is narrower than 90°".into()));
                }
            }
            let near = lenses.iter().map(Lens::near).fold(f64::INFINITY, f64::min);
            // Faces of ours end at the centres of border texels, so that they share them: theirs are read anew.
            let mut projection = shadow_projection(light, Some((low, high)), size);
            projection.near = near as f32;
            let mut readings = Vec::new();
            for face in &mut projection.layers {
                let forward = face.forward.as_dvec3();
                let theirs = lenses.iter().position(|lens| lens.forward.dot(forward) > 1.0 - 1e-6);
                let Some(index) = theirs else {
                    let problem = format!("and the other five leave out the direction {}", face.forward);
                    return Err((0, problem));
                };
                let depth = lenses[index].reversing(near);
                readings.push(reading(matrices[index], directions(face), depth, index as u32));
                *face = with_clip(*face, size, Some(near as f32), 0.0);
            }
            Ok((projection, readings))
        }
    }
}

impl Lens {
    fn of(clip_from_world: DMat4, light: &Light) -> Result<Self, String> {
        if !clip_from_world.is_finite() {
            return Err("holds a number that is not finite".into());
        }
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_world.row(i));
        let parallel = w.truncate().length() * 1e6 <= w.w.abs();
        let scale = if parallel { w.w } else { w.truncate().length() };
        let [x, y, z, w] = [x, y, z, w].map(|row| row / scale);
        let (to_x, to_y, to_z) = (x.truncate(), y.truncate(), z.truncate());
        let forward = match (light, parallel) {
            (Light::Directional(sun), true) => sun.direction.as_dvec3(),
            (Light::Directional(_), false) => {
                return Err("is a perspective; parallel light needs a parallel one".into());
            }
            (_, true) => return Err("is parallel; a light at a place needs a perspective".into()),
            (_, false) => w.truncate(),
        };
        if to_x.length() == 0.0 || to_y.length() == 0.0 {
            return Err("has no width or no height".into());
        }
        // Axes, and with a parallel projection depth too, are at right angles to each other and to the view.
        let (across, up) = (to_x.normalize(), to_y.normalize());
        let along = to_z.dot(forward);
        let sheared =
            (to_z - along * forward).length() > ROUNDING * if parallel { to_z.length() } else { 1.0 };
        let angles = [across.dot(up), across.dot(forward), up.dot(forward)];
        if sheared || angles.iter().any(|cosine| cosine.abs() > ROUNDING) {
            return Err("is off-axis or sheared, or looks elsewhere than its light".into());
        }
        let half = [1.0 / to_x.length(), 1.0 / to_y.length()];
        let mut origin = -(x.w * half[0] * across + y.w * half[1] * up);
        let (offset, scale);
        if parallel {
            // Where depth is that of the near plane.
            offset = if along < 0.0 { 1.0 } else { 0.0 };
            scale = along;
            origin += forward * (offset - z.w) / along;
        } else {
            offset = along;
            scale = z.w - along * w.w;
            origin -= w.w * forward;
        }
        let lens = Self { origin, half, up, forward, offset, scale };
        let usable = if parallel { along != 0.0 } else { lens.near() > 0.0 && lens.near().is_finite() };
        if usable { Ok(lens) } else { Err("has no near plane in front of its light".into()) }
    }

    /// Near plane of a perspective \[m\].
    fn near(&self) -> f64 {
        let at_near = if self.scale > 0.0 { 1.0 } else { 0.0 };
        self.scale / (at_near - self.offset)
    }

    /// Scale and offset that make reversed depth `near / distance` of a perspective's.
    fn reversing(&self, near: f64) -> [f64; 2] {
        [near / self.scale, -near * self.offset / self.scale]
    }

    fn is_at(&self, position: Vec3, reach: f32) -> Result<(), String> {
        let away = self.origin.distance(position.as_dvec3());
        if away <= 1e-3 * f64::from(reach) { Ok(()) } else { Err(format!("is {away} m away from the light")) }
    }

    /// The layer of ours with the same texels, but for left and right.
    fn layer(&self, size: u32, origin: DVec3) -> ShadowLayer {
        let inner = (f64::from(size) - 1.0) / f64::from(size);
        let right = self.forward.cross(self.up).normalize();
        ShadowLayer {
            clip_from_world: Mat4::IDENTITY,
            origin: origin.as_vec3(),
            right: (right * self.half[0] * inner).as_vec3(),
            up: (self.up * self.half[1] * inner).as_vec3(),
            forward: self.forward.as_vec3(),
        }
    }
}

fn with_clip(layer: ShadowLayer, size: u32, near: Option<f32>, range: f32) -> ShadowLayer {
    let axes = [layer.right, layer.up, layer.forward];
    ShadowLayer { clip_from_world: clip_from_world(size, layer.origin, axes, near, range), ..layer }
}

/// What the places of a perspective layer are made of.
fn directions(layer: &ShadowLayer) -> [glam::Vec4; 3] {
    [layer.right, layer.up, layer.forward].map(|axis| axis.extend(0.0))
}

/// How a layer whose place (x, y, 1) is a sum of `axes` is read from layer `layer` of theirs.
fn reading(theirs: Mat4, axes: [glam::Vec4; 3], [scale, offset]: [f64; 2], layer: u32) -> ReadingUniform {
    let columns = axes.map(|axis| {
        let clip: DVec4 = theirs.as_dmat4() * axis.as_dvec4();
        DVec3::new(clip.x, clip.y, clip.w)
    });
    let whole = columns[2].z;
    let [x, y, z] = columns.map(|column| (column / whole).as_vec3());
    let clip_from_plane = Mat3::from_cols(x, y, z);
    ReadingUniform { clip_from_plane, scale: scale as f32, offset: offset as f32, layer }
}

impl ReadingUniform {
    /// Whether ours is theirs, to a hundredth of a texel and the last digit of depth.
    pub(super) fn is_trivial(&self, layer: u32, size: u32) -> bool {
        let inner = (size as f32 - 1.0) / size as f32;
        let off = self.clip_from_plane - Mat3::from_diagonal(Vec3::new(inner, inner, 1.0));
        self.layer == layer
            && (self.scale - 1.0).abs() < 1e-6
            && self.offset.abs() < 1e-7
            && off.to_cols_array().iter().all(|x| x.abs() < 0.02 / size as f32)
    }
}

/// Whether a layer has the light's cone in it, but for a texel.
fn has_cone(layer: &ShadowLayer, size: u32, axis: Vec3, angle: f32) -> bool {
    let most = 1.0 + 1.5 / (size as f32 - 1.0);
    let side = axis.any_orthonormal_vector();
    let other = axis.cross(side);
    (0..64).all(|i| {
        let turn = i as f32 * std::f32::consts::TAU / 64.0;
        let rim = angle.cos() * axis + angle.sin() * (turn.cos() * side + turn.sin() * other);
        let along = rim.dot(layer.forward);
        let at = [layer.right, layer.up].map(|axis| rim.dot(axis) / (along * axis.length_squared()));
        along > 0.0 && at.iter().all(|at| at.abs() <= most)
    })
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::{proj::directx, view};

    use super::*;
    use crate::gpu::bench::scenes::{point, spot, sun};
    use crate::{DepthRange, PointLight};

    const BOUNDS: (Vec3, Vec3) = (Vec3::new(-6.0, -0.5, -6.0), Vec3::new(6.0, 4.0, 6.0));

    /// From the place of a texel's centre in our layer to its texel and depth in theirs.
    fn theirs(layer: &ShadowLayer, parallel: bool, matrix: Mat4, place: [f32; 2], distance: f32) -> [f32; 3] {
        let side = place[0] * layer.right + place[1] * layer.up;
        let away = if parallel { side + layer.forward * distance } else { (side + layer.forward) * distance };
        let clip = matrix * (layer.origin + away).extend(1.0);
        (clip.truncate() / clip.w).to_array()
    }

    fn spot_view() -> (Light, Mat4) {
        let light = spot(0.3, 0.6);
        let Light::Spot(spot) = &light else { unreachable!() };
        let view = view::look_to_mat4(spot.position, spot.direction, Vec3::Y);
        (light, view)
    }

    #[test]
    fn a_spots_depth_becomes_ours_whatever_it_was() {
        let (light, view) = spot_view();
        for (name, projection, range) in [
            (
                "standard",
                directx::perspective(1.2, 1.0, 0.1, 40.0),
                DepthRange { near: 0.1, far: 40.0, reversed: false },
            ),
            (
                "reversed, far",
                directx::perspective(1.2, 1.0, 40.0, 0.1),
                DepthRange { near: 0.1, far: 40.0, reversed: true },
            ),
            ("reversed", directx::perspective_infinite_reverse(1.2, 1.0, 0.1), DepthRange::reversed(0.1)),
        ] {
            let matrix = projection * view;
            let (ours, readings) = read(&light, BOUNDS, 65, &[matrix]).unwrap();
            assert!((ours.near / 0.1 - 1.0).abs() < 1e-4, "{name}: {}", ours.near);
            assert_eq!(readings[0].is_trivial(0, 65), range == DepthRange::reversed(0.1), "{name}");
            for (place, distance) in [([0.0, 0.0], 3.0), ([1.0, -1.0], 0.5), ([-0.25, 0.5], 12.0)] {
                let [x, y, z] = theirs(&ours.layers[0], false, matrix, place, distance);
                // Texel edges on the frustum's border, ours are centres.
                let inner = 64.0 / 65.0;
                assert!(
                    (x - inner * place[0]).abs() < 1e-4 && (y - inner * place[1]).abs() < 1e-4,
                    "{name}: {x} {y}"
                );
                assert!((z - range.depth(distance)).abs() < 1e-4, "{name}: {z}");
                let depth = readings[0].offset + readings[0].scale * range.depth(distance);
                assert!((depth * distance / ours.near - 1.0).abs() < 1e-3, "{name}: {depth}");
            }
        }
    }

    #[test]
    fn a_suns_map_becomes_ours_whatever_it_was() {
        let light = sun();
        let Light::Directional(sun) = &light else { unreachable!() };
        let view = view::look_to_mat4(-9.0 * sun.direction, sun.direction, Vec3::Z);
        for (name, near, far) in [("standard", 1.0, 21.0), ("reversed", 21.0, 1.0)] {
            let matrix = directx::orthographic(-7.0, 8.0, -6.0, 7.0, near, far) * view;
            let (ours, readings) = read(&light, BOUNDS, 33, &[matrix]).unwrap();
            assert!((ours.range - 20.0).abs() < 1e-3, "{name}: {}", ours.range);
            assert_eq!(readings[0].is_trivial(0, 33), name == "reversed");
            for (place, distance) in [([0.0, 0.0], 3.0), ([1.0, -1.0], 15.0)] {
                let [x, y, z] = theirs(&ours.layers[0], true, matrix, place, distance);
                let inner = 32.0 / 33.0;
                assert!(
                    (x - inner * place[0]).abs() < 1e-4 && (y - inner * place[1]).abs() < 1e-4,
                    "{name}: {x} {y}"
                );
                let depth = readings[0].offset + readings[0].scale * z;
                assert!((depth - (1.0 - distance / ours.range)).abs() < 1e-4, "{name}: {depth}");
            }
        }
    }

    #[test]
    fn a_point_lights_faces_are_found_in_any_order_and_sense() {
        let light = point();
        let Light::Point(PointLight { position, .. }) = light else { unreachable!() };
        // As cube textures have them: mirrored, with other axes up.
        let mirrored = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))
            * directx::perspective(std::f32::consts::FRAC_PI_2, 1.0, 0.05, 30.0);
        let face = |forward: Vec3, up: Vec3| mirrored * view::look_to_mat4(position, forward, up);
        let faces = [
            face(Vec3::NEG_Z, Vec3::NEG_Y),
            face(Vec3::X, Vec3::NEG_Y),
            face(Vec3::NEG_X, Vec3::NEG_Y),
            face(Vec3::Y, Vec3::Z),
            face(Vec3::NEG_Y, Vec3::NEG_Z),
            face(Vec3::Z, Vec3::NEG_Y),
        ];
        let (ours, readings) = read(&light, BOUNDS, 17, &faces).unwrap();
        assert_eq!(readings.iter().map(|reading| reading.layer).collect::<Vec<_>>(), [1, 2, 3, 4, 5, 0]);
        for (layer, reading) in ours.layers.iter().zip(&readings) {
            let place = [0.4, -0.7];
            let [x, y, z] = theirs(layer, false, faces[reading.layer as usize], place, 2.0);
            let clip = reading.clip_from_plane * Vec3::new(place[0], place[1], 1.0);
            assert!(
                (clip.x / clip.z - x).abs() < 1e-4 && (clip.y / clip.z - y).abs() < 1e-4,
                "{clip} {x} {y}"
            );
            assert!((reading.offset + reading.scale * z - ours.near / 2.0).abs() < 1e-4);
        }
        let missing = [faces[0], faces[1], faces[1], faces[3], faces[4], faces[5]];
        assert!(read(&light, BOUNDS, 17, &missing).unwrap_err().1.contains("leave out"));
    }

    #[test]
    fn projections_of_something_else_are_refused() {
        let (light, view) = spot_view();
        let projection = directx::perspective(1.2, 1.0, 0.1, 40.0);
        let shift = Mat4::from_translation(Vec3::new(0.1, 0.0, 0.0));
        for (matrix, words) in [
            (directx::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 9.0) * view, "parallel"),
            (shift * projection * view, "off-axis"),
            (projection * shift * view, "away from the light"),
            (directx::perspective(1.0, 1.0, 0.1, 40.0) * view, "cone"),
            (projection * f32::NAN, "finite"),
            (Mat4::ZERO, "parallel"),
        ] {
            let (index, problem) = read(&light, BOUNDS, 65, &[matrix]).unwrap_err();
            assert!(index == 0 && problem.contains(words), "{problem} says nothing of {words}");
        }
        assert!(read(&sun(), BOUNDS, 65, &[projection * view]).unwrap_err().1.contains("perspective"));
    }
}
