//! A view from the matrices that a renderer draws with.

use glam::{DMat3, DMat4, DVec3, Mat4};
use thiserror::Error;

use super::{Camera, DepthRange, View};

/// Why a renderer's matrices are no [`View`].
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ViewError {
    /// A number that is none.
    #[error("the view's matrices hold a number that is not finite")]
    NotFinite,
    /// A picture without pixels.
    #[error("the view has {width}×{height} pixels; expected at least one each way")]
    Empty {
        /// Width \[pixels\].
        width: u32,
        /// Height \[pixels\].
        height: u32,
    },
    /// Parallel rays.
    #[error("the projection is orthographic; only a perspective can be drawn")]
    Orthographic,
    /// The axis does not run through the picture's centre.
    #[error(
        "the projection is off-axis or sheared by {offset} of half a picture; give the one without jitter, lens shift \
         or stereo offset"
    )]
    OffAxis {
        /// How far, in half pictures.
        offset: f64,
    },
    /// Pixels are not square.
    #[error("the projection's width is {projection} times its height, but the picture's is {picture} times")]
    Aspect {
        /// Width over height of the projection.
        projection: f64,
        /// Width over height of the picture.
        picture: f64,
    },
    /// Left and right are exchanged.
    #[error(
        "the picture is a mirror image, as of a left-handed world; give everything with one axis turned round"
    )]
    Mirrored,
    /// Lengths change between world and view.
    #[error("`view_from_world` scales, shears or projects; it has to be a rotation and a translation")]
    NotRigid,
    /// The field of view is none.
    #[error("the projection's vertical field of view is {fov_y} rad; expected less than 3.1")]
    FieldOfView {
        /// Vertical field of view \[rad\].
        fov_y: f64,
    },
    /// Depth does not run between two planes in front of the eye.
    #[error("the projection's depth runs from {near} m to {far} m; expected 0 < near < far")]
    Depth {
        /// Distance of the near plane \[m\].
        near: f64,
        /// Distance of the far plane \[m\].
        far: f64,
    },
}

/// What rounding may make of a zero or one in a matrix of 32-bit floats.
const ROUNDING: f64 = 1e-5;
/// Largest difference of the two aspects, as a share: 0.2 pixels at the border of 4000.
const ASPECT: f64 = 1e-4;
/// Depth at infinity that is this near to the empty one means that there is no far plane: of standard depth a rounding of
/// 1, of reversed depth next to nothing.
const ENDLESS: [f64; 2] = [1.3e-7, 1e-12];
/// How far away what the camera looks at is said to be, in distances of the near plane. It is a mere length that warnings
/// compare with.
const TARGET: f64 = 100.0;

impl View {
    /// The view that a renderer draws with these matrices into `width` × `height` pixels: a right-handed world, wgpu's
    /// clip space (y up, depth 0 to 1), any view space. Depth may be standard or reversed, with or without a far
    /// plane: [`View::depth`] says which.
    ///
    /// Its camera looks at a point a hundred near planes away.
    ///
    /// # Errors
    /// What can't be drawn is refused: orthographic, off-axis or jittered projections, aspects that are not those
    /// of the picture, scaled or mirrored views, numbers that are not finite.
    pub fn from_matrices(
        view_from_world: Mat4,
        clip_from_view: Mat4,
        width: u32,
        height: u32,
    ) -> Result<Self, ViewError> {
        if !(view_from_world.is_finite() && clip_from_view.is_finite()) {
            return Err(ViewError::NotFinite);
        }
        if width == 0 || height == 0 {
            return Err(ViewError::Empty { width, height });
        }
        let (view_from_world, clip_from_view) = (view_from_world.as_dmat4(), clip_from_view.as_dmat4());
        let (rotation, eye) = rigid(view_from_world)?;
        let lens = Lens::of(clip_from_view)?;

        // Axes of the picture in the world.
        let axis = |i: usize, sign: f64| rotation.row(i) * sign.signum();
        let (right, up, forward) = (axis(0, lens.half.x), axis(1, lens.half.y), axis(2, lens.along));
        if forward.cross(up).dot(right) < 0.0 {
            return Err(ViewError::Mirrored);
        }
        let (half_x, half_y) = (lens.half.x.abs(), lens.half.y.abs());
        let (projection, picture) = (half_x / half_y, f64::from(width) / f64::from(height));
        if (projection / picture - 1.0).abs() > ASPECT {
            return Err(ViewError::Aspect { projection, picture });
        }
        let fov_y = 2.0 * half_y.atan();
        if fov_y >= 3.1 {
            return Err(ViewError::FieldOfView { fov_y });
        }
        let target = eye + TARGET * f64::from(lens.depth.near) * forward;
        let camera =
            Camera { eye: eye.as_vec3(), target: target.as_vec3(), up: up.as_vec3(), fov_y: fov_y as f32 };
        Ok(Self { camera, width, height, depth: lens.depth })
    }
}

/// Rotation of a rigid transform, and the place that it takes to the origin.
fn rigid(view_from_world: DMat4) -> Result<(DMat3, DVec3), ViewError> {
    let rotation = DMat3::from_mat4(view_from_world);
    let off = (rotation * rotation.transpose() - DMat3::IDENTITY).to_cols_array();
    let last = view_from_world.row(3) - glam::DVec4::W;
    if off.iter().chain(&last.to_array()).any(|x| x.abs() > 10.0 * ROUNDING) {
        return Err(ViewError::NotRigid);
    }
    Ok((rotation, rotation.transpose() * -view_from_world.w_axis.truncate()))
}

/// A projection's parts.
struct Lens {
    /// Half extents of the picture at distance 1; negative where the axis is turned round.
    half: glam::DVec2,
    /// +1 or −1: which way along z the view looks.
    along: f64,
    depth: DepthRange,
}

impl Lens {
    fn of(clip_from_view: DMat4) -> Result<Self, ViewError> {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_view.row(i));
        if w.z == 0.0 || w.w.abs() > ROUNDING * w.z.abs() {
            return Err(ViewError::Orthographic);
        }
        // Clip coordinates have no scale of their own.
        let (along, scale) = (w.z.signum(), 1.0 / w.z.abs());
        let [x, y, z, w] = [x, y, z, w].map(|row| row * scale);
        let zeros = [x.y, x.z, x.w, y.x, y.z, y.w, z.x, z.y, w.x, w.y];
        let offset = zeros.iter().fold(0.0, |most: f64, zero| most.max(zero.abs()));
        if offset > ROUNDING {
            return Err(ViewError::OffAxis { offset });
        }
        if x.x == 0.0 || y.y == 0.0 {
            return Err(ViewError::FieldOfView { fov_y: std::f64::consts::PI });
        }
        // Depth = offset + scale / distance: where it is 0 and where 1.
        let (offset, scale) = (z.z * along, z.w);
        let reversed = scale > 0.0;
        let (at_near, at_far) = if reversed { (1.0, 0.0) } else { (0.0, 1.0) };
        let near = scale / (at_near - offset);
        let rest = at_far - offset;
        let far = if rest.abs() < ENDLESS[usize::from(reversed)] { f64::INFINITY } else { scale / rest };
        if !(near > 0.0 && near < far) {
            return Err(ViewError::Depth { near, far });
        }
        let depth = DepthRange { near: near as f32, far: far as f32, reversed };
        Ok(Self { half: glam::DVec2::new(1.0 / x.x, 1.0 / y.y), along, depth })
    }
}

#[cfg(test)]
mod tests {
    use glam::camera::{lh, rh};
    use glam::{Vec3, Vec4};

    use super::*;

    const EYE: Vec3 = Vec3::new(1.5, 2.0, -3.0);

    fn looking() -> Mat4 {
        rh::view::look_to_mat4(EYE, Vec3::new(0.4, -0.2, 0.8).normalize(), Vec3::Y)
    }

    fn reversed(mut projection: Mat4) -> Mat4 {
        let (z, w) = (projection.row(2), projection.row(3));
        for (i, x) in (w - z).to_array().into_iter().enumerate() {
            projection.col_mut(i).z = x;
        }
        projection
    }

    /// Fails where `view` sends points elsewhere than the matrices, or reads other distances from their depth.
    fn assert_same(view: &View, view_from_world: Mat4, clip_from_view: Mat4, name: &str) {
        let clip_from_world = clip_from_view * view_from_world;
        for point in [Vec3::new(2.0, 1.0, -1.0), Vec3::new(4.0, 2.5, 3.0), Vec3::new(3.0, -1.0, 4.0)] {
            let ndc = |clip: Vec4| clip.truncate() / clip.w;
            let theirs = ndc(clip_from_world * point.extend(1.0));
            let ours = ndc(view.clip_from_world() * point.extend(1.0));
            assert!((theirs - ours).truncate().abs().max_element() < 1e-5, "{name}: {theirs} {ours}");
            let distance = (point - EYE).dot(view.camera.basis().2);
            let read = view.depth.distance(theirs.z);
            assert!((read / distance - 1.0).abs() < 1e-4, "{name}: {read} is not {distance}");
        }
    }

    #[test]
    fn projections_of_all_kinds_are_taken_apart() {
        use rh::proj::{directx, opengl};
        let (fov, aspect, near, far) = (0.8, 1.5, 0.1, 60.0);
        let endless = f32::INFINITY;
        for (name, projection, range) in [
            ("standard", directx::perspective(fov, aspect, near, far), (near, far, false)),
            ("standard, endless", directx::perspective_infinite(fov, aspect, near), (near, endless, false)),
            ("reversed", reversed(directx::perspective(fov, aspect, near, far)), (near, far, true)),
            ("reversed, swapped", directx::perspective(fov, aspect, far, near), (near, far, true)),
            (
                "reversed, endless",
                directx::perspective_infinite_reverse(fov, aspect, near),
                (near, endless, true),
            ),
            ("scaled clip", directx::perspective(fov, aspect, near, far) * 3.0, (near, far, false)),
            // Of OpenGL's range wgpu draws the half from 0 on.
            (
                "opengl",
                opengl::perspective(fov, aspect, near, far),
                (2.0 * near * far / (near + far), far, false),
            ),
        ] {
            let view = View::from_matrices(looking(), projection, 300, 200).unwrap();
            assert!((view.camera.fov_y - fov).abs() < 1e-6, "{name}");
            assert!(view.camera.eye.distance(EYE) < 1e-6, "{name}: {}", view.camera.eye);
            let DepthRange { near, far, reversed } = view.depth;
            assert!((near / range.0 - 1.0).abs() < 1e-5, "{name}: {near}");
            assert!(far == range.1 || (far / range.1 - 1.0).abs() < 1e-3, "{name}: {far}");
            assert_eq!(reversed, range.2, "{name}");
            assert_same(&view, looking(), projection, name);
        }
    }

    #[test]
    fn view_spaces_of_all_kinds_are_taken_apart() {
        let (fov, aspect) = (0.8, 1.5);
        let projection = lh::proj::directx::perspective_infinite_reverse(fov, aspect, 0.1);
        // A right-handed world, seen in a view space whose z points forward.
        let forward = Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0)) * looking();
        let view = View::from_matrices(forward, projection, 300, 200).unwrap();
        assert_same(&view, forward, projection, "left-handed view space");
        // A picture that stands on its head is the picture of a camera that does.
        let turned = Mat4::from_scale(Vec3::new(-1.0, -1.0, 1.0))
            * rh::proj::directx::perspective(fov, aspect, 0.1, 9.0);
        assert_same(
            &View::from_matrices(looking(), turned, 300, 200).unwrap(),
            looking(),
            turned,
            "upside down",
        );
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_in_a_sentence() {
        use rh::proj::directx;
        let good = directx::perspective(0.8, 1.5, 0.1, 60.0);
        let with = |row: usize, column: usize, value: f32| {
            let mut projection = good;
            projection.col_mut(column)[row] += value;
            projection
        };
        let scaled = |x, y, z| Mat4::from_scale(Vec3::new(x, y, z)) * looking();
        for (view_from_world, clip_from_view, words) in [
            (looking(), directx::orthographic(-3.0, 3.0, -2.0, 2.0, 0.1, 60.0), "orthographic"),
            (looking(), with(0, 2, 0.5 / 300.0), "jitter"),
            (looking(), with(1, 0, 0.1), "off-axis"),
            (looking(), directx::perspective(0.8, 1.52, 0.1, 60.0), "times its height"),
            (scaled(-1.0, 1.0, 1.0), good, "mirror"),
            (looking(), Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0)) * good, "mirror"),
            (scaled(2.0, 2.0, 2.0), good, "scales"),
            (good, good, "scales"),
            (looking(), with(2, 3, f32::NAN), "finite"),
            (looking(), directx::perspective(3.12, 1.5, 0.1, 60.0), "field of view"),
            (looking(), with(2, 2, 1.5), "near < far"),
        ] {
            let error = View::from_matrices(view_from_world, clip_from_view, 300, 200).unwrap_err();
            assert!(error.to_string().contains(words), "`{error}` says nothing of `{words}`");
        }
        let error = View::from_matrices(looking(), good, 300, 0).unwrap_err();
        assert_eq!(error, ViewError::Empty { width: 300, height: 0 });
    }
}
