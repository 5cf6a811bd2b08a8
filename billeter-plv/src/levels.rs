//! Min-max levels of shadow maps on the GPU: shadow map in, a texture with a level of the quadtree in each mip.

use common::gpu::passes::{begin_compute, bind_group, pipeline_layout, shader_module};
use common::gpu::{LightBinding, PassTimer, light_layout};

use crate::shaders;

/// Name of this module's pass.
pub(crate) const PASS: &str = "billeter-plv: build min-max levels";

/// Coarser levels than one of so many blocks on a side are seldom all lit or all dark.
const LEAST_BLOCKS: u32 = 4;

/// Compute pipelines.
pub(crate) struct Pipelines {
    finest_layout: wgpu::BindGroupLayout,
    coarsen_layout: wgpu::BindGroupLayout,
    finest: wgpu::ComputePipeline,
    coarsen: wgpu::ComputePipeline,
}

/// Levels of one shadow map at a time; those of all lights use them in turn.
pub(crate) struct Levels {
    /// Largest map and most layers that fit.
    fits: (u32, u32),
    side: u32,
    layers: u32,
    finest: wgpu::BindGroup,
    coarsen: Vec<wgpu::BindGroup>,
    /// View of all levels.
    pub(crate) view: wgpu::TextureView,
    /// Number of the coarsest level.
    pub(crate) coarsest: u32,
}

/// Number of the coarsest level, at least 1, and texels on a side of the finest: a whole number of blocks of the
/// coarsest.
fn shape(size: u32) -> (u32, u32) {
    let coarsest = (size.next_power_of_two() / LEAST_BLOCKS).max(2).trailing_zeros();
    (coarsest, size.next_multiple_of(1 << coarsest))
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        };
        let view_dimension = wgpu::TextureViewDimension::D2Array;
        let read = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension,
            multisampled: false,
        };
        let write = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: wgpu::TextureFormat::R32Uint,
            view_dimension,
        };
        let label = "billeter-plv: min-max levels";
        let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        // Numbered as bind_group does it: from 0.
        let finest_layout = layout(&[entry(0, write), entry(1, write)]);
        let coarsen_layout = layout(&[entry(0, write), entry(1, read)]);
        let module = |source| shader_module(device, label, source);
        let pipeline = |module: &wgpu::ShaderModule, groups: &[&wgpu::BindGroupLayout], entry| {
            let layout = pipeline_layout(device, label, groups);
            common::gpu::passes::compute_pipeline(device, module, Some(&layout), entry, &[])
        };
        let finest =
            pipeline(&module(shaders::finest_level()), &[&finest_layout, &light_layout(device)], "finest");
        let coarsen = pipeline(&module(shaders::coarser_level()), &[&coarsen_layout], "coarsen");
        Self { finest_layout, coarsen_layout, finest, coarsen }
    }

    /// Encodes the building of a light's levels.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        levels: &Levels,
        light: &LightBinding,
        timer: &mut PassTimer,
    ) {
        let layers = (light.projection.layers.len() as u32).min(levels.layers);
        let mut pass = begin_compute(encoder, PASS, timer);
        pass.set_pipeline(&self.finest);
        pass.set_bind_group(0, &levels.finest, &[]);
        pass.set_bind_group(1, &light.bind_group, &[]);
        let blocks = |level: u32| (levels.side >> level).div_ceil(8);
        pass.dispatch_workgroups(blocks(1), blocks(1), layers);
        pass.set_pipeline(&self.coarsen);
        for (group, level) in levels.coarsen.iter().zip(2..) {
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(blocks(level), blocks(level), layers);
        }
    }
}

impl Levels {
    /// For maps of up to `size` texels on a side and up to `layers` projections.
    pub(crate) fn new(device: &wgpu::Device, pipelines: &Pipelines, (size, layers): (u32, u32)) -> Self {
        let (coarsest, side) = shape(size);
        let label = "billeter-plv: min-max levels";
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: layers },
            mip_level_count: coarsest + 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = |base_mip_level, mip_level_count| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                base_mip_level,
                mip_level_count,
                ..Default::default()
            })
        };
        let mips: Vec<_> = (0..=coarsest).map(|level| view(level, Some(1))).collect();
        let group = |layout, [a, b]: [usize; 2]| {
            bind_group(device, label, layout, [a, b].map(|i| wgpu::BindingResource::TextureView(&mips[i])))
        };
        let coarsen = (2..mips.len()).map(|level| group(&pipelines.coarsen_layout, [level, level - 1]));
        Self {
            fits: (size, layers),
            side,
            layers,
            finest: group(&pipelines.finest_layout, [1, 0]),
            coarsen: coarsen.collect(),
            view: view(0, None),
            coarsest,
        }
    }

    /// Whether they are for just such maps.
    pub(crate) fn fits(&self, size_and_layers: (u32, u32)) -> bool {
        self.fits == size_and_layers
    }
}

#[cfg(test)]
mod tests {
    use super::shape;

    #[test]
    fn every_level_halves_the_one_below() {
        for size in (1..70).chain([500, 512, 513, 2049, 4096, 8192]) {
            let (coarsest, side) = shape(size);
            assert!(side >= size && side % (1 << coarsest) == 0 && coarsest >= 1, "{size}");
            assert!(side <= size.next_power_of_two().max(2), "{size}: {side}");
            assert!(side >> coarsest <= LEAST_BLOCKS_OR_LESS, "{size}: {}", side >> coarsest);
        }
    }

    const LEAST_BLOCKS_OR_LESS: u32 = super::LEAST_BLOCKS;
}
