//! Shadow maps: projections at the lights, and the bindings that carry a light to a shader.
//!
//! A map is a 2-D array of `Depth32Float`: six layers around a point light, one otherwise. Depth is
//! reversed (0 is empty). The centres of the border texels lie exactly on the border of the light's
//! frustum, so that neighbouring cube faces look into the same directions along their common edge.

use encase::ShaderType;
use glam::{Mat4, Vec3, Vec4};
use thiserror::Error;

use super::uniforms::Uniform;
use crate::light::{Light, SpotLight};
use crate::{View, Warning};

/// Why a light can't be given a shadow map.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LightError {
    /// The map is too small or too large.
    #[error("a shadow map of {size}² texels can't be made here; expected 2 to {limit}")]
    Size {
        /// Texels on a side.
        size: u32,
        /// Most that the device has.
        limit: u32,
    },
    /// The light itself is not valid.
    #[error("light {index} ({kind}) {problem}")]
    Invalid {
        /// Which light.
        index: usize,
        /// Point, spot or directional.
        kind: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// The view's depth is not what is drawn here.
    #[error(
        "this view's depth is not reversed without a far plane, as it is drawn here; use DepthRange::reversed"
    )]
    Depth,
    /// The scene's triangles do not fit on the device.
    #[error("the scene's {triangles} triangles do not fit into one buffer of this adapter")]
    TooManyTriangles {
        /// How many.
        triangles: usize,
    },
}

/// One projection of a shadow map; twin of WGSL `ShadowLayer`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct ShadowLayer {
    /// From world to clip space of the map's texture.
    pub clip_from_world: Mat4,
    /// Apex, or centre of the near plane for a directional light \[m\].
    pub origin: Vec3,
    /// Half extent at distance 1 (directional: \[m\]) of the square spanned by border texel centres.
    pub right: Vec3,
    /// As `right`, upwards.
    pub up: Vec3,
    /// Unit viewing direction.
    pub forward: Vec3,
}

/// All that a light's shadow map stands for.
#[derive(Clone, Debug)]
pub struct Projection {
    /// Texels on a side, at least 2.
    pub size: u32,
    /// Near plane of a point or spot's projections \[m\].
    pub near: f32,
    /// What an empty texel stands for \[m\].
    pub far: f32,
    /// Directional: distance from the near to the far plane \[m\].
    pub range: f32,
    /// The projections; six for a point light in the order +x −x +y −y +z −z.
    pub layers: Vec<ShadowLayer>,
}

/// How many scene radii away an empty texel lies. The light that is cut off behind it is about
/// `1 / FAR` of a ray's, and far vertices still leave positions near the eye their precision.
const FAR: f32 = 1000.0;
/// Near plane of a light in scene radii: what is nearer to a light throws no shadow. Reversed floats are as exact for a
/// plane so near as for any other; but much nearer, rounding would say on which side of a light a surface lies that
/// touches it.
const NEAR: f32 = 1e-7;

/// Centre and radius of what lies within `bounds` \[m\].
fn ball(bounds: Option<(Vec3, Vec3)>) -> (Vec3, f32) {
    let (low, high) = bounds.unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
    (0.5 * (low + high), (0.5 * (high - low).length()).max(f32::MIN_POSITIVE))
}

/// The scene's size as the light sees it, and how far away an empty texel lies \[m\].
pub(super) fn map_reach(light: &Light, bounds: Option<(Vec3, Vec3)>) -> (f32, f32) {
    let (centre, radius) = ball(bounds);
    let reach = light.position().map_or(radius, |position| radius.max(position.distance(centre)));
    (reach, FAR * reach)
}

/// The projections of `light` for a map of `size`² texels over a scene of the given bounds.
pub fn shadow_projection(light: &Light, bounds: Option<(Vec3, Vec3)>, size: u32) -> Projection {
    let (low, high) = bounds.unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
    let (centre, radius) = ball(bounds);
    let (reach, far) = map_reach(light, bounds);
    let near = NEAR * reach;
    let perspective = |origin: Vec3, forward: Vec3, up: Vec3, extent: f32| {
        let (right, up) = (forward.cross(up) * extent, up * extent);
        let clip_from_world = clip_from_world(size, origin, [right, up, forward], Some(near), 0.0);
        ShadowLayer { clip_from_world, origin, right, up, forward }
    };
    match light {
        Light::Point(light) => {
            let faces = [
                (Vec3::X, Vec3::Y),
                (Vec3::NEG_X, Vec3::Y),
                (Vec3::Y, Vec3::NEG_Z),
                (Vec3::NEG_Y, Vec3::Z),
                (Vec3::Z, Vec3::Y),
                (Vec3::NEG_Z, Vec3::Y),
            ];
            let layers = faces.iter().map(|&(forward, up)| perspective(light.position, forward, up, 1.0));
            Projection { size, near, far, range: 0.0, layers: layers.collect() }
        }
        Light::Spot(light) => {
            let layer =
                perspective(light.position, light.direction, light.basis().1, light.outer_angle.tan());
            Projection { size, near, far, range: 0.0, layers: vec![layer] }
        }
        Light::Directional(light) => {
            let forward = light.direction;
            // Along the longest side of the scene's box that the light sees well, so that the box fills
            // the map.
            let sides = high - low;
            let seen = |axis: Vec3| sides.dot(axis) * axis.cross(forward).length();
            let longest = [Vec3::X, Vec3::Z]
                .into_iter()
                .fold(Vec3::Y, |best, axis| if seen(axis) > seen(best) { axis } else { best });
            let up = longest.reject_from_normalized(forward).normalize();
            let right = forward.cross(up);
            let corner = |i: usize| {
                let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
                Vec3::new(pick(0), pick(1), pick(2))
            };
            // The scene's box seen from the light, with two texels of margin: the border stays empty.
            let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for i in 0..8 {
                let offset = corner(i) - centre;
                let seen = Vec3::new(offset.dot(right), offset.dot(up), offset.dot(forward));
                (least, most) = (least.min(seen), most.max(seen));
            }
            let margin = 1.0 + 4.0 / (size as f32 - 1.0).max(4.0);
            let half = (0.5 * (most - least)).max(Vec3::splat(1e-3 * radius)) * margin;
            let middle = 0.5 * (most + least);
            let axis = centre + middle.x * right + middle.y * up;
            let origin = axis + (middle.z - half.z) * forward;
            let range = 2.0 * half.z;
            let (right, up) = (right * half.x, up * half.y);
            let clip_from_world = clip_from_world(size, origin, [right, up, forward], None, range);
            let layer = ShadowLayer { clip_from_world, origin, right, up, forward };
            Projection { size, near: 0.0, far, range, layers: vec![layer] }
        }
    }
}

/// Reversed-depth projection: infinite perspective where there is a near plane, else orthographic.
pub(super) fn clip_from_world(
    size: u32,
    origin: Vec3,
    [right, up, forward]: [Vec3; 3],
    near: Option<f32>,
    range: f32,
) -> Mat4 {
    // Texel centres at the border lie on the frustum: the texture reaches half a texel beyond.
    let beyond = size as f32 / (size as f32 - 1.0);
    let row = |axis: Vec3| {
        (axis / (axis.length_squared() * beyond)).extend(-axis.dot(origin) / (axis.length_squared() * beyond))
    };
    let along = forward.extend(-forward.dot(origin));
    let (z, w) = match near {
        Some(near) => (Vec4::new(0.0, 0.0, 0.0, near), along),
        None => (Vec4::W - along / range, Vec4::W),
    };
    Mat4::from_cols(row(right), row(up), z, w).transpose()
}

/// Twin of WGSL `Light`.
#[derive(Clone, Copy, Debug, ShaderType)]
pub struct LightUniform {
    position: Vec3,
    kind: u32,
    direction: Vec3,
    cos_inner: f32,
    strength: Vec3,
    cos_outer: f32,
    map_right: Vec3,
    has_map: u32,
    map_up: Vec3,
    shadow_size: f32,
    layer_count: u32,
    near: f32,
    far: f32,
    range: f32,
    layers: [ShadowLayer; 6],
}

impl LightUniform {
    /// The block of a light and its shadow map.
    pub fn new(light: &Light, projection: &Projection) -> Self {
        let mut layers = [ShadowLayer::default(); 6];
        layers[..projection.layers.len()].copy_from_slice(&projection.layers);
        let mut uniform = Self {
            position: light.position().unwrap_or(Vec3::ZERO),
            kind: 0,
            direction: Vec3::NEG_Y,
            cos_inner: 0.0,
            strength: light.strength(),
            cos_outer: -1.0,
            map_right: Vec3::ZERO,
            has_map: 0,
            map_up: Vec3::ZERO,
            shadow_size: projection.size as f32,
            layer_count: projection.layers.len() as u32,
            near: projection.near,
            far: projection.far,
            range: projection.range,
            layers,
        };
        match light {
            Light::Point(_) => {}
            Light::Spot(spot) => {
                let (right, up) = spot.basis();
                uniform.kind = 1;
                uniform.direction = spot.direction;
                (uniform.cos_inner, uniform.cos_outer) = (spot.inner_angle.cos(), spot.outer_angle.cos());
                (uniform.map_right, uniform.map_up) =
                    (right / spot.outer_angle.tan(), up / spot.outer_angle.tan());
                uniform.has_map = spot.light_map.is_some().into();
            }
            Light::Directional(sun) => {
                uniform.kind = 2;
                uniform.direction = sun.direction;
            }
        }
        uniform
    }
}

/// A light as shaders see it: bind group of [`light_layout`].
#[derive(Clone)]
pub struct LightBinding {
    /// The light itself, for decisions on the CPU.
    pub light: Light,
    /// What its shadow map shows.
    pub projection: Projection,
    /// Binding 0: WGSL `Light`; 1: `texture_depth_2d_array`; 2: light map; 3: its sampler.
    pub bind_group: wgpu::BindGroup,
}

/// Layout of a light's bind group: 0 uniform `Light`, 1 `texture_depth_2d_array` (the shadow map),
/// 2 `texture_2d<f32>` (the light map; 1×1 white without one), 3 filtering sampler.
pub fn light_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
        sample_type,
        view_dimension,
        multisampled: false,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("common: light"),
        entries: &[
            entry(
                0,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: Some(LightUniform::min_size()),
                },
            ),
            entry(1, texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array)),
            entry(
                2,
                texture(wgpu::TextureSampleType::Float { filterable: true }, wgpu::TextureViewDimension::D2),
            ),
            entry(3, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
        ],
    })
}

impl LightBinding {
    /// Binds a light with its shadow map: `depth` is a 2-D array view of `Depth32Float` with the
    /// projection's size and layers, of usage `TEXTURE_BINDING`, drawn by the time it is read. For maps that are not
    /// drawn with [`shadow_projection`] there is [`ForeignMap`](super::ForeignMap).
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        light: &Light,
        projection: Projection,
        depth: &wgpu::TextureView,
    ) -> Self {
        let uniform = Uniform::new(device, "common: light");
        uniform.write(queue, &LightUniform::new(light, &projection));
        let map = light_map_view(device, queue, light);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("common: light map"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("common: light"),
            layout: &light_layout(device),
            entries: &[
                entry(0, uniform.buffer.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(depth)),
                entry(2, wgpu::BindingResource::TextureView(&map)),
                entry(3, wgpu::BindingResource::Sampler(&sampler)),
            ],
        });
        Self { light: light.clone(), projection, bind_group }
    }
}

/// Widest texel of a shadow map that shadows still have a shape in: of parallel light, over the eye's distance from what it
/// looks at; else the angle at the light \[rad\].
const COARSEST: f64 = 0.2;

/// The coarsest of the lights' shadow maps, if its shadows have lost their shape.
pub fn coarse_map(lights: &[LightBinding], view: &View) -> Option<Warning> {
    let focus = f64::from(view.camera.eye.distance(view.camera.target));
    let texel = |light: &LightBinding| {
        let Projection { size, layers, .. } = &light.projection;
        let layer = layers.first()?;
        let width = 2.0 * f64::from(layer.right.length().max(layer.up.length())) / f64::from(*size);
        Some(if matches!(light.light, Light::Directional(_)) { width / focus } else { width })
    };
    let value = lights.iter().filter_map(texel).fold(0.0, f64::max);
    (value > COARSEST).then_some(Warning {
        parameter: "the width of a shadow map's texel (of parallel light over the eye's distance from what it looks at, else its \
                    angle in radians)",
        value,
        bound: COARSEST,
        advice: "shadows are blocks; take a larger map, or a smaller scene around what is seen",
    })
}

/// The light map as `Rgba16Float`, or a single white texel.
fn light_map_view(device: &wgpu::Device, queue: &wgpu::Queue, light: &Light) -> wgpu::TextureView {
    let map = match light {
        Light::Spot(SpotLight { light_map: Some(map), .. }) => Some(map),
        _ => None,
    };
    let (width, height) = map.map_or((1, 1), |map| (map.width, map.height));
    let white = [Vec3::ONE];
    let texels = map.map_or(&white[..], |map| &map.texels[..]);
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("common: light map"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let bytes: Vec<u8> = texels
        .iter()
        .flat_map(|texel| texel.extend(1.0).to_array())
        .flat_map(|value| half::f16::from_f32(value).to_le_bytes())
        .collect();
    queue.write_texture(
        texture.as_image_copy(),
        &bytes,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * width), rows_per_image: None },
        size,
    );
    texture.create_view(&Default::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::bench::check_uniform_layout;
    use crate::gpu::uniform_bytes;
    use crate::light::{DirectionalLight, PointLight};

    fn sentinel(value: f32) -> Vec3 {
        Vec3::new(value, value + 0.25, value + 0.5)
    }

    #[test]
    fn light_lies_as_wgsl_has_it() {
        let layer = ShadowLayer {
            clip_from_world: Mat4::from_diagonal(Vec4::splat(20.0)),
            origin: sentinel(21.0),
            right: sentinel(22.0),
            up: sentinel(23.0),
            forward: sentinel(24.0),
        };
        let block = LightUniform {
            position: sentinel(1.0),
            kind: 2,
            direction: sentinel(3.0),
            cos_inner: 4.0,
            strength: sentinel(5.0),
            cos_outer: 6.0,
            map_right: sentinel(7.0),
            has_map: 8,
            map_up: sentinel(9.0),
            shadow_size: 10.0,
            layer_count: 11,
            near: 12.0,
            far: 13.0,
            range: 14.0,
            layers: [layer; 6],
        };
        let f = f32::to_bits;
        let expect = [
            ("position", f(1.0)),
            ("kind", 2),
            ("direction", f(3.0)),
            ("cos_inner", f(4.0)),
            ("strength", f(5.0)),
            ("cos_outer", f(6.0)),
            ("map_right", f(7.0)),
            ("has_map", 8),
            ("map_up", f(9.0)),
            ("shadow_size", f(10.0)),
            ("layer_count", 11),
            ("near", f(12.0)),
            ("far", f(13.0)),
            ("range", f(14.0)),
            ("layers", f(20.0)),
        ];
        check_uniform_layout(crate::shader::LIGHT, "Light", &uniform_bytes(&block), &expect).unwrap();
        let expect = [
            ("clip_from_world", f(20.0)),
            ("origin", f(21.0)),
            ("right", f(22.0)),
            ("up", f(23.0)),
            ("forward", f(24.0)),
        ];
        check_uniform_layout(crate::shader::LIGHT, "ShadowLayer", &uniform_bytes(&layer), &expect).unwrap();
    }

    /// World position of a texel's centre at a distance; twin of WGSL `shadow_position`.
    fn position(layer: &ShadowLayer, directional: bool, texel: [u32; 2], size: u32, distance: f32) -> Vec3 {
        let at = |i: u32| 2.0 * i as f32 / (size as f32 - 1.0) - 1.0;
        let side = at(texel[0]) * layer.right - at(texel[1]) * layer.up;
        if directional {
            layer.origin + side + layer.forward * distance
        } else {
            layer.origin + (side + layer.forward) * distance
        }
    }

    #[test]
    fn projections_put_texel_centres_where_positions_are() {
        let bounds = Some((Vec3::new(-3.0, 0.0, -2.0), Vec3::new(4.0, 5.0, 6.0)));
        let lights = [
            Light::Point(PointLight { position: Vec3::new(1.0, 2.0, 0.5), intensity: Vec3::ONE }),
            Light::Directional(DirectionalLight {
                direction: Vec3::new(0.3, -0.9, 0.2).normalize(),
                irradiance: Vec3::ONE,
            }),
        ];
        let size = 33;
        for light in lights {
            let projection = shadow_projection(&light, bounds, size);
            let directional = light.kind() == "directional";
            for layer in &projection.layers {
                for texel in [[0, 0], [32, 0], [7, 19], [32, 32]] {
                    let distance = 1.7;
                    let clip = layer.clip_from_world
                        * position(layer, directional, texel, size, distance).extend(1.0);
                    let ndc = clip.truncate() / clip.w;
                    for (axis, sign) in [(0, 1.0), (1, -1.0)] {
                        let pixel = (sign * ndc[axis] * 0.5 + 0.5) * size as f32;
                        let centre = texel[axis] as f32 + 0.5;
                        assert!((pixel - centre).abs() < 1e-3, "{pixel} is not the centre {centre}");
                    }
                    let stored =
                        if directional { (1.0 - ndc.z) * projection.range } else { projection.near / ndc.z };
                    assert!((stored / distance - 1.0).abs() < 1e-4, "{stored} is not {distance}");
                }
            }
        }
    }

    #[test]
    fn cube_faces_share_the_directions_of_their_border() {
        let light = Light::Point(PointLight { position: Vec3::ZERO, intensity: Vec3::ONE });
        let layers = shadow_projection(&light, None, 9).layers;
        // Every border direction of every face is a border direction of exactly one other face, or of two
        // at the cube's corners.
        for (f, face) in layers.iter().enumerate() {
            for i in 0..9 {
                let direction = position(face, false, [i, 0], 9, 1.0);
                let sharing = layers
                    .iter()
                    .enumerate()
                    .filter(|&(g, other)| {
                        let along = direction.dot(other.forward);
                        let at =
                            [direction.dot(other.right), direction.dot(other.up)].map(|x| (x / along).abs());
                        g != f && along > 0.0 && at[0] <= 1.0 + 1e-6 && at[1] <= 1.0 + 1e-6
                    })
                    .count();
                assert_eq!(sharing, if i == 0 || i == 8 { 2 } else { 1 });
            }
        }
    }
}
