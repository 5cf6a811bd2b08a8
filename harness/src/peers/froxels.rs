//! Froxels: a frustum-aligned grid of in-scattering, what engines do.
//!
//! After Wronski, *Volumetric Fog* (2014), and Hillaire, *Physically Based and Unified Volumetric Rendering in Frostbite*
//! (2015). Passes: (1) light is injected into every froxel with its shadow, phase function and the medium's attenuation
//! from the light, one dispatch a light; (2) each column is integrated from the eye on by Hillaire's energy-conserving
//! slices; (3) one full-screen pass looks the integral up at each pixel's surface, trilinearly. Both grids hold 16-bit
//! floats (the first one in a buffer, because WebGPU can't add to such a texture), as engines do.
//!
//! Approximations: (1) radiance per metre is the same all through a froxel, by a few jittered samples: engines take
//! one and filter it over frames ("temporal reprojection"), which is left out here: every frame stands for itself, and the
//! number of samples is a setting; (2) interpolation across shadow edges thinner than a froxel, and of the integral
//! between slices; (3) inverse squares are bounded by the froxel's size; (4) 16 bits; (5) what lies behind surfaces is
//! computed as well.

use std::collections::HashMap;

use common::gpu::passes::{
    AdditivePipeline, Attachments, begin_compute, begin_pass, bind_group, binding, compute_pipeline,
    group_layout, pipeline_layout, shader_module,
};
use common::gpu::{
    LightBinding, MediumUniform, PassTimer, Uniform, Variant, ViewUniform, light_layout, make_buffer,
};
use common::{Light, Scene, View, shader};
use encase::ShaderType;
use glam::UVec3;

use super::{middle, reach};

/// How fine the grid is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fineness {
    /// Pixels on a side of a tile.
    pub tile: u32,
    /// Slices along a ray.
    pub slices: u32,
    /// Places in each froxel where the light is looked up.
    pub samples: u32,
}

impl Fineness {
    /// Froxels each way in the grid of a view of this size \[pixels\].
    fn grid(self, (width, height): (u32, u32)) -> UVec3 {
        UVec3::new(width.div_ceil(self.tile), height.div_ceil(self.tile), self.slices)
    }
}

/// Most that the two grids may take \[bytes\].
const MOST_BYTES: u64 = 1 << 30;
/// Share of the slices up to the distance behind which there are neither surfaces nor lights, where rays go on.
const INNER_SHARE: f32 = 0.875;

/// Twin of WGSL `Grid`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct GridUniform {
    size: UVec3,
    tile: f32,
    inner: f32,
    share: f32,
    reach: f32,
    exposure: f32,
}

/// Pipelines, grids and per-frame data.
pub(crate) struct Froxels {
    fineness: Fineness,
    size: UVec3,
    inject_module: wgpu::ShaderModule,
    inject_layout: wgpu::PipelineLayout,
    inject: HashMap<Variant, wgpu::ComputePipeline>,
    integrate: wgpu::ComputePipeline,
    apply: wgpu::RenderPipeline,
    inject_group: wgpu::BindGroup,
    integrate_group: wgpu::BindGroup,
    apply_layout: wgpu::BindGroupLayout,
    integrated: wgpu::TextureView,
    sampler: wgpu::Sampler,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    grid: Uniform<GridUniform>,
    frame: Option<Frame>,
}

/// What `prepare` leaves for `encode`.
struct Frame {
    apply: wgpu::BindGroup,
    lights: Vec<(wgpu::ComputePipeline, wgpu::BindGroup)>,
}

impl Froxels {
    /// Names of the passes, in order.
    pub(crate) const PASSES: [&'static str; 3] =
        ["froxels: inject light", "froxels: integrate along rays", "froxels: add in-scattered radiance"];

    /// A grid for pictures of `width` × `height` pixels. An error says why there is no such grid here.
    pub(crate) fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        fineness: Fineness,
        size: (u32, u32),
    ) -> Result<Self, String> {
        let size = fineness.grid(size);
        check(&device.limits(), size)?;
        let [inject_pass, integrate_pass, apply_pass] = Self::PASSES;
        let bytes = 8 * size.as_u64vec3().element_product();
        let cells = make_buffer(device, "froxels: cells", bytes, wgpu::BufferUsages::STORAGE)
            .map_err(|error| error.to_string())?;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("froxels: integrated"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let integrated = texture.create_view(&Default::default());
        let view = Uniform::new(device, "froxels: view");
        let medium = Uniform::new(device, "froxels: medium");
        let grid = Uniform::new(device, "froxels: grid");

        let inject_module = shader_module(device, inject_pass, inject_source());
        let cells_type = storage();
        let inject_group_layout = compute_layout(
            device,
            inject_pass,
            &[binding::UNIFORM, binding::UNIFORM, binding::UNIFORM, cells_type],
        );
        let inject_layout =
            pipeline_layout(device, inject_pass, &[&inject_group_layout, &light_layout(device)]);
        let resources = [
            view.buffer.as_entire_binding(),
            medium.buffer.as_entire_binding(),
            grid.buffer.as_entire_binding(),
            cells.as_entire_binding(),
        ];
        let inject_group = bind_group(device, inject_pass, &inject_group_layout, resources);

        let module = shader_module(device, integrate_pass, integrate_source());
        let integrate = compute_pipeline(device, &module, None, "integrate", &[("SLICES", size.z.into())]);
        let resources = [
            medium.buffer.as_entire_binding(),
            grid.buffer.as_entire_binding(),
            cells.as_entire_binding(),
            wgpu::BindingResource::TextureView(&integrated),
        ];
        let integrate_group =
            bind_group(device, integrate_pass, &integrate.get_bind_group_layout(0), resources);

        let module = shader_module(device, apply_pass, apply_source());
        let types = [
            binding::UNIFORM,
            binding::UNIFORM,
            binding::UNIFORM,
            binding::DEPTH,
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: wgpu::TextureViewDimension::D3,
                multisampled: false,
            },
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        ];
        let apply_layout = group_layout(device, apply_pass, &types);
        let apply = AdditivePipeline {
            layout: Some(&pipeline_layout(device, apply_pass, &[&apply_layout])),
            module: &module,
            entries: ["vs_fullscreen", "fs_apply"],
            constants: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            buffers: &[],
            depth_stencil: None,
            target: Some(format),
            adds: true,
        };
        let apply = apply.build(device);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("froxels: trilinear"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Ok(Self {
            fineness,
            size,
            inject_module,
            inject_layout,
            inject: HashMap::new(),
            integrate,
            apply,
            inject_group,
            integrate_group,
            apply_layout,
            integrated,
            sampler,
            view,
            medium,
            grid,
            frame: None,
        })
    }

    /// Whether its grid is that of a view of this size \[pixels\].
    pub(crate) fn fits(&self, size: (u32, u32)) -> bool {
        self.size == self.fineness.grid(size)
    }

    /// What it was made with.
    pub(crate) fn fineness(&self) -> Fineness {
        self.fineness
    }

    /// Puts a frame's data in place; once per submit. The view is as large as the grid was made for; `depth` is of
    /// [`common::gpu::DEPTH_FORMAT`], of the view's size, and bound as a texture.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &Scene,
        view: &View,
        lights: &[LightBinding],
        depth: &wgpu::TextureView,
    ) {
        self.view.write(queue, &ViewUniform::from(view));
        self.medium.write(queue, &MediumUniform::from(&scene.medium));
        self.grid.write(queue, &grid(scene, view, self.size, self.fineness.tile));
        let resources = [
            self.view.buffer.as_entire_binding(),
            self.medium.buffer.as_entire_binding(),
            self.grid.buffer.as_entire_binding(),
            wgpu::BindingResource::TextureView(depth),
            wgpu::BindingResource::TextureView(&self.integrated),
            wgpu::BindingResource::Sampler(&self.sampler),
        ];
        let apply = bind_group(device, Self::PASSES[2], &self.apply_layout, resources);
        let make = |variant: &Variant| {
            let mut constants = variant.constants();
            constants.push(("SAMPLES", self.fineness.samples.into()));
            compute_pipeline(device, &self.inject_module, Some(&self.inject_layout), "inject", &constants)
        };
        let with_pipeline = |light: &LightBinding| {
            let variant = Variant::new(&light.light, &scene.medium);
            (self.inject.entry(variant).or_insert_with_key(make).clone(), light.bind_group.clone())
        };
        self.frame = Some(Frame { apply, lights: lights.iter().map(with_pipeline).collect() });
    }

    /// Adds the in-scattered radiance to `target`.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let Some(frame) = &self.frame else { return };
        let [inject, integrate, apply] = Self::PASSES;
        let groups = |group: UVec3| {
            let count = (self.size + group - 1) / group;
            (count.x, count.y, count.z)
        };
        let mut pass = begin_compute(encoder, inject, timer);
        pass.set_bind_group(0, &self.inject_group, &[]);
        let (x, y, z) = groups(UVec3::new(8, 2, 4));
        for (pipeline, light) in &frame.lights {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, light, &[]);
            pass.dispatch_workgroups(x, y, z);
        }
        drop(pass);
        let mut pass = begin_compute(encoder, integrate, timer);
        pass.set_pipeline(&self.integrate);
        pass.set_bind_group(0, &self.integrate_group, &[]);
        let (x, y, _) = groups(UVec3::new(8, 8, 1));
        pass.dispatch_workgroups(x, y, 1);
        drop(pass);
        let mut pass = begin_pass(encoder, Attachments::onto(target), apply, timer);
        pass.set_pipeline(&self.apply);
        pass.set_bind_group(0, &frame.apply, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Why a grid of `size` can't be made, if so.
fn check(limits: &wgpu::Limits, size: UVec3) -> Result<(), String> {
    let bytes = 8 * size.as_u64vec3().element_product();
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size).min(MOST_BYTES / 2);
    let longest = limits.max_texture_dimension_3d;
    if size.max_element() > longest || bytes > most {
        return Err(format!(
            "a grid of {}×{}×{} froxels takes 2 · {bytes} bytes; this device has room for 2 · {most} bytes and {longest} \
             froxels each way: take larger tiles or fewer slices",
            size.x, size.y, size.z
        ));
    }
    Ok(())
}

fn grid(scene: &Scene, view: &View, size: UVec3, tile: u32) -> GridUniform {
    let reach = reach(scene, view);
    let (centre, radius) = middle(scene, view);
    let inner = view.camera.eye.distance(centre) + radius;
    let (inner, share) = if inner < 0.9 * reach { (inner, INNER_SHARE) } else { (reach, 1.0) };
    // What the lights together send to about as far away as they are from most of the scene.
    let sent = |light: &Light| match light {
        Light::Directional(sun) => sun.irradiance.max_element(),
        other => other.strength().max_element() / radius.powi(2),
    };
    let irradiance: f32 = scene.lights.iter().map(sent).sum();
    let exposure = 4.0 * std::f32::consts::PI / irradiance.max(f32::MIN_POSITIVE);
    let exposure = if exposure.is_finite() { exposure } else { 1.0 };
    GridUniform { size, tile: tile as f32, inner, share, reach, exposure }
}

/// `var<storage, read_write>`.
fn storage() -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: false },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// Layout of a bind group for a compute shader, bindings numbered from 0.
fn compute_layout(device: &wgpu::Device, label: &str, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::COMPUTE;
    let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let entries: Vec<_> = (0..).zip(types).map(entry).collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Composed text of the passes.
pub(super) fn inject_source() -> String {
    shader::compose(&[
        shader::VIEW,
        shader::PHASE,
        shader::MEDIUM,
        shader::LIGHT,
        shader::KIND,
        shader::RAY,
        shader::HAZE,
        include_str!("light.wgsl"),
        include_str!("froxel_grid.wgsl"),
        include_str!("froxel_inject.wgsl"),
    ])
}

pub(super) fn integrate_source() -> String {
    shader::compose(&[
        shader::PHASE,
        shader::MEDIUM,
        include_str!("froxel_grid.wgsl"),
        include_str!("froxel_integrate.wgsl"),
    ])
}

pub(super) fn apply_source() -> String {
    shader::compose(&[
        shader::FULLSCREEN,
        shader::VIEW,
        shader::PHASE,
        shader::MEDIUM,
        include_str!("froxel_grid.wgsl"),
        include_str!("froxel_apply.wgsl"),
    ])
}

#[cfg(test)]
mod tests {
    use common::gpu::bench::{check_uniform_layout, context, eval_wgsl, validate_wgsl};
    use common::gpu::uniform_bytes;
    use glam::Vec4;

    use super::*;

    #[test]
    fn shaders_are_valid_and_the_grid_lies_as_they_have_it() {
        validate_wgsl(&apply_source()).unwrap();
        // The others pack 16-bit floats, which is part of WebGPU but not of the bench's validator: the device has its say.
        let fineness = Fineness { tile: 8, slices: 4, samples: 1 };
        Froxels::new(&context().device, wgpu::TextureFormat::Rgba16Float, fineness, (16, 16)).unwrap();
        assert_eq!(context().take_error(), None);
        let grid = GridUniform {
            size: UVec3::new(1, 2, 3),
            tile: 4.0,
            inner: 5.0,
            share: 6.0,
            reach: 7.0,
            exposure: 8.0,
        };
        let f = f32::to_bits;
        let expect = [
            ("size", 1),
            ("tile", f(4.0)),
            ("inner", f(5.0)),
            ("share", f(6.0)),
            ("reach", f(7.0)),
            ("exposure", f(8.0)),
        ];
        for source in [inject_source(), integrate_source(), apply_source()] {
            check_uniform_layout(&source, "Grid", &uniform_bytes(&grid), &expect).unwrap();
        }
    }

    #[test]
    fn slices_and_distances_are_inverse() {
        let places: Vec<Vec4> = (0..=64).map(|i| Vec4::splat(i as f32)).collect();
        for share in [1.0, INNER_SHARE] {
            let prelude = format!("let grid = Grid(vec3u(9u, 9u, 64u), 8.0, 20.0, {share:?}, 90.0, 1.0);");
            let expression =
                "vec4f(slice_distance(grid, x.x), distance_slice(grid, slice_distance(grid, x.x)), 0.0, 0.0)";
            let chunk = include_str!("froxel_grid.wgsl");
            let found = eval_wgsl(context(), &[chunk], &[], &prelude, expression, &places);
            assert_eq!(found[0].x, 0.0);
            let end = if share < 1.0 { 90.0 } else { 20.0 };
            assert!((found[64].x - end).abs() < 1e-3, "{}", found[64]);
            assert!(found.windows(2).all(|pair| pair[0].x < pair[1].x), "slices grow");
            for (place, found) in places.iter().zip(&found) {
                assert!((found.y - place.x).abs() < 1e-3, "{found} is not {place}");
            }
        }
    }

    #[test]
    fn a_grid_that_has_no_room_is_refused() {
        let device = &context().device;
        let fineness = Fineness { tile: 1, slices: 1024, samples: 1 };
        let format = wgpu::TextureFormat::Rgba16Float;
        let refusal = Froxels::new(device, format, fineness, (4096, 4096)).err().unwrap();
        assert!(refusal.contains("4096×4096×1024 froxels") && refusal.contains("larger tiles"), "{refusal}");
        assert!(Froxels::new(device, format, Fineness { tile: 64, ..fineness }, (64, 64)).is_ok());
    }
}
