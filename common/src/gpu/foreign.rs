//! Shadow maps that another program drew, with depth and borders as it likes.

mod reading;

use encase::ShaderType;
use glam::{Mat3, Mat4, Vec3};
use thiserror::Error;

use super::passes::binding::UNIFORM_AT_OFFSET;
use super::passes::{AdditivePipeline, bind_group, block, group_layout, pipeline_layout, shader_module};
use super::shadow::LightBinding;
use super::surface::{DEPTH_FORMAT, ShadowTexture, depth_only_pass, shadow_texture};
use super::{PassTimer, uniform_bytes};
use crate::Light;
use crate::shader::{FOREIGN, FULLSCREEN, LIGHT, SHADOW, compose};

/// Why a shadow map can't be read.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MapError {
    /// The texture is none that can be read.
    #[error("the shadow map's texture {problem}")]
    Texture {
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The light itself is not valid.
    #[error("the shadow map's {kind} light {problem}")]
    Light {
        /// Point, spot or directional.
        kind: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// Layers, matrices and the kind of light do not go together.
    #[error(
        "a {kind} light has a shadow map of {expected} projections; found {layers} layers and {matrices} matrices"
    )]
    Count {
        /// Point, spot or directional.
        kind: &'static str,
        /// Projections that it needs.
        expected: usize,
        /// Layers of the texture.
        layers: usize,
        /// Matrices given.
        matrices: usize,
    },
    /// A projection is not that of the light.
    #[error("projection {index} of the {kind} light's shadow map {problem}")]
    Projection {
        /// Which.
        index: usize,
        /// Point, spot or directional.
        kind: &'static str,
        /// What is wrong.
        problem: String,
    },
}

/// A shadow map of your own renderer, made readable for techniques.
///
/// The map may have standard or reversed depth, with or without a far plane, and its frustum may end at the edges of the
/// border texels, as usual, or anywhere else: the matrices that it was drawn with say all that. Where it is as techniques
/// read maps (reversed, no far plane), it is bound as it is; else one small pass writes a copy, `Depth32Float` of the same
/// size.
///
/// Each frame: draw your map; [`ForeignMap::prepare`], whose [`LightBinding`] goes into a technique's inputs;
/// [`ForeignMap::encode`] behind your shadow pass and before the technique's `encode`.
///
/// Read are single maps: one for all that a spot or directional light shines on, six for a point light. A directional
/// light's cascades are several; give one that has all casters in it. Outside of a map nothing casts.
pub struct ForeignMap {
    map: wgpu::TextureView,
    size: u32,
    layers: u32,
    /// Made once it is needed.
    conversion: Option<Conversion>,
    /// Whether the frame prepared last needs it.
    converts: bool,
}

/// The pass that writes a copy in our conventions, and the copy.
struct Conversion {
    pipeline: wgpu::RenderPipeline,
    readings: wgpu::Buffer,
    group: wgpu::BindGroup,
    texture: ShadowTexture,
}

/// Twin of WGSL `Reading`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct ReadingUniform {
    clip_from_plane: Mat3,
    scale: f32,
    offset: f32,
    layer: u32,
}

/// Bytes between two readings in their buffer: the largest alignment that a device may ask for.
const READING_STRIDE: u64 = 256;

impl ForeignMap {
    /// Name of its pass, which comes once for each layer that is converted.
    pub const PASS: &'static str = "common: read foreign shadow map";

    /// Reads `layers` of `texture`: one, or six for a point light. The texture is square, of any depth format and of usage
    /// `TEXTURE_BINDING`, has one sample, and stays the same from frame to frame; where yours is replaced, make another.
    ///
    /// # Errors
    /// [`MapError::Texture`], for a texture that is not all of this.
    pub fn new(texture: &wgpu::Texture, layers: std::ops::Range<u32>) -> Result<Self, MapError> {
        let wrong = |problem| Err(MapError::Texture { problem });
        if !texture.format().has_depth_aspect() {
            return wrong("holds no depth");
        }
        if texture.width() != texture.height() || texture.width() < 2 {
            return wrong("is not a square of at least 2 texels");
        }
        if texture.dimension() != wgpu::TextureDimension::D2 || texture.sample_count() != 1 {
            return wrong("is not two-dimensional with one sample for each texel");
        }
        if !texture.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING) {
            return wrong("lacks the usage TEXTURE_BINDING");
        }
        if layers.is_empty() || layers.end > texture.depth_or_array_layers() {
            return wrong("does not have the layers asked for");
        }
        let map = texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("common: foreign shadow map"),
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            aspect: wgpu::TextureAspect::DepthOnly,
            base_array_layer: layers.start,
            array_layer_count: Some(layers.len() as u32),
            mip_level_count: Some(1),
            ..Default::default()
        });
        Ok(Self {
            map,
            size: texture.width(),
            layers: layers.len() as u32,
            conversion: None,
            converts: false,
        })
    }

    /// The light with its map, for the inputs of a technique. One call per submit.
    ///
    /// - `clip_from_world`: the matrices that the map's layers are drawn with, one for each, in wgpu's clip space: a
    ///   perspective at a spot's apex that has all its cone in it; a parallel projection along a directional light; six
    ///   perspectives of 90° or more along the axes for a point light, in any order and turned in any way.
    /// - `bounds`: low and high corner of the scene \[m\]; what is beyond some hundred times of it does not matter.
    ///
    /// # Errors
    /// [`MapError`], for another number of layers or matrices than the light has, a light that is not valid, and a matrix
    /// that is no such projection.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        light: &Light,
        clip_from_world: &[Mat4],
        bounds: (Vec3, Vec3),
    ) -> Result<LightBinding, MapError> {
        let kind = light.kind();
        let expected = if kind == "point" { 6 } else { 1 };
        let (layers, matrices) = (self.layers as usize, clip_from_world.len());
        if [layers, matrices] != [expected; 2] {
            return Err(MapError::Count { kind, expected, layers, matrices });
        }
        if let Some(problem) = light.problem() {
            return Err(MapError::Light { kind, problem });
        }
        let (projection, readings) = reading::read(light, bounds, self.size, clip_from_world)
            .map_err(|(index, problem)| MapError::Projection { index, kind, problem })?;
        self.converts = !(0..).zip(&readings).all(|(layer, reading)| reading.is_trivial(layer, self.size));
        if !self.converts {
            return Ok(LightBinding::new(device, queue, light, projection, &self.map));
        }
        let conversion =
            self.conversion.get_or_insert_with(|| Conversion::new(device, &self.map, self.size, self.layers));
        for (offset, reading) in (0..).step_by(READING_STRIDE as usize).zip(&readings) {
            queue.write_buffer(&conversion.readings, offset, &uniform_bytes(reading));
        }
        Ok(LightBinding::new(device, queue, light, projection, &conversion.texture.array))
    }

    /// Copies the map that has been drawn by now, if the frame prepared last needs a copy.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, timer: &mut PassTimer) {
        let Some(conversion) = self.conversion.as_ref().filter(|_| self.converts) else { return };
        for (offset, layer) in (0..).step_by(READING_STRIDE as usize).zip(&conversion.texture.layers) {
            let mut pass = depth_only_pass(encoder, layer, Self::PASS, timer);
            pass.set_pipeline(&conversion.pipeline);
            pass.set_bind_group(0, &conversion.group, &[offset]);
            pass.draw(0..3, 0..1);
        }
    }

    /// The WGSL of its pass, composed: for validation without a GPU.
    pub fn shader() -> String {
        compose(&[FULLSCREEN, LIGHT, SHADOW, FOREIGN])
    }
}

impl Conversion {
    fn new(device: &wgpu::Device, map: &wgpu::TextureView, size: u32, layers: u32) -> Self {
        let label = ForeignMap::PASS;
        let depth = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        let layout = group_layout(device, label, &[UNIFORM_AT_OFFSET, depth]);
        let readings = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: u64::from(layers) * READING_STRIDE,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let pipeline = AdditivePipeline {
            layout: Some(&pipeline_layout(device, label, &[&layout])),
            module: &shader_module(device, label, ForeignMap::shader()),
            entries: ["vs_fullscreen", "fs_foreign"],
            constants: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            buffers: &[],
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            target: None,
            adds: false,
        };
        let resources =
            [block(&readings, ReadingUniform::min_size().get()), wgpu::BindingResource::TextureView(map)];
        let group = bind_group(device, label, &layout, resources);
        let texture = shadow_texture(device, size, layers);
        Self { pipeline: pipeline.build(device), readings, group, texture }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::bench::{check_uniform_layout, uniform_branches};

    #[test]
    fn reading_lies_as_wgsl_has_it() {
        let clip_from_plane = Mat3::from_diagonal(Vec3::ONE);
        let block = ReadingUniform { clip_from_plane, scale: 2.0, offset: 3.0, layer: 4 };
        let f = f32::to_bits;
        let expect = [("clip_from_plane", f(1.0)), ("scale", f(2.0)), ("offset", f(3.0)), ("layer", 4)];
        check_uniform_layout(&ForeignMap::shader(), "Reading", &uniform_bytes(&block), &expect).unwrap();
        assert_eq!(uniform_branches(&ForeignMap::shader()).unwrap(), [""; 0]);
    }
}
