//! The lit volume drawn as a mesh: pipelines at creation, bindings by frame, passes into the caller's encoder.

use std::collections::HashMap;

use common::gpu::passes::{Attachments, begin_pass, bind_group, block};
use common::gpu::{
    Accumulator, LightBinding, MediumUniform, PassTimer, Uniform, Variant, ViewUniform, make_buffer,
    upload_tables,
};
use common::panels::panels_for;
use common::{Light, Lobe, Medium, Phase, View};

use crate::pipelines::{FacePipelines, Layouts, LightForm};
use crate::table::build_tables;
use crate::tessellation::{self, FULL_ARGUMENTS};
use crate::{Error, Evaluation, Inputs, Options, Tessellation};

/// Names of this module's passes; the middle three come once for each projection of each light.
pub(crate) const PASSES: [&str; 5] = [
    "billeter-plv: clear",
    tessellation::PASSES[0],
    tessellation::PASSES[1],
    "billeter-plv: draw volumes",
    "billeter-plv: add airlight",
];

/// Draws airlight as faces of the light volume.
pub(crate) struct Mesh {
    options: Options,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    layouts: Layouts,
    draws: wgpu::Buffer,
    draw_group: wgpu::BindGroup,
    accumulator: Accumulator,
    /// By what they are made for, once there is such a light.
    pipelines: HashMap<(LightForm, Variant), FacePipelines>,
    tessellation: Option<(tessellation::Pipelines, f32)>,
    tables: Option<(Vec<Lobe>, wgpu::TextureView)>,
    buffers: Option<tessellation::Buffers>,
    /// Draw arguments of every projection of every light, kept for counting.
    counts: Option<wgpu::Buffer>,
    frame: Option<wgpu::BindGroup>,
    phase: Option<Phase>,
    lights: Vec<DrawnLight>,
}

/// What `encode` needs of a light.
struct DrawnLight {
    binding: LightBinding,
    form: LightForm,
    faces: FacePipelines,
}

/// Bytes between two `Draw` blocks: the largest alignment that a device may ask for.
const DRAW_STRIDE: u64 = 256;

impl Mesh {
    /// Builds pipelines and all that no frame changes.
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue, options: &Options) -> Result<Self, Error> {
        let Options { target_format, accumulation, clamp_negative, .. } = *options;
        let accumulator = Accumulator::new(device, target_format, accumulation, clamp_negative)?;
        let layouts = Layouts::new(device);
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let draws = make_buffer(device, "billeter-plv: draws", 6 * DRAW_STRIDE, usage)?;
        for layer in 0..6u32 {
            queue.write_buffer(&draws, u64::from(layer) * DRAW_STRIDE, &layer.to_le_bytes());
        }
        let draw_group = bind_group(device, "billeter-plv: draws", &layouts.draw, [block(&draws, 8)]);
        let tessellation = match options.tessellation {
            Tessellation::Full => None,
            Tessellation::Adaptive { tolerance } => {
                Some((tessellation::Pipelines::new(device, options.upright_walls), tolerance))
            }
        };
        Ok(Self {
            options: *options,
            view: Uniform::new(device, "billeter-plv: view"),
            medium: Uniform::new(device, "billeter-plv: medium"),
            layouts,
            draws,
            draw_group,
            accumulator,
            pipelines: HashMap::new(),
            tessellation,
            tables: None,
            buffers: None,
            counts: None,
            frame: None,
            phase: None,
            lights: Vec::new(),
        })
    }

    /// Allocates what depends on the size of the view \[pixels\].
    pub(crate) fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) {
        self.accumulator.resize(device, "billeter-plv: accumulated airlight", (width, height));
    }

    /// Uploads what this frame needs; once per submit. Refuses what the technique can't model.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
    ) -> Result<(), Error> {
        let View { width, height, .. } = *inputs.view;
        Accumulator::check_size(device, (width, height))?;
        for (index, light) in inputs.lights.iter().enumerate() {
            self.refuse(index, &light.light)?;
        }
        if !self.accumulator.has_size((width, height)) {
            self.resize(device, width, height);
        }
        self.prepare_buffers(device, queue, inputs.lights)?;
        self.prepare_tables(device, queue, inputs.medium);
        self.view.write(queue, &ViewUniform::from(inputs.view));
        self.medium.write(queue, &MediumUniform::from(inputs.medium));
        self.prepare_draws(queue, inputs.medium);
        self.frame = self.tables.as_ref().map(|(_, tables)| {
            let resources = [
                self.view.buffer.as_entire_binding(),
                self.medium.buffer.as_entire_binding(),
                wgpu::BindingResource::TextureView(inputs.depth),
                wgpu::BindingResource::TextureView(tables),
            ];
            bind_group(device, "billeter-plv: frame", &self.layouts.frame, resources)
        });
        let Self { layouts, options, accumulator, pipelines, .. } = self;
        let drawn = |binding: &LightBinding| {
            let eye = inputs.view.camera.eye;
            let form = LightForm::of(&binding.light, eye, inputs.medium, options.evaluation);
            let variant = Variant::new(&binding.light, inputs.medium);
            let make = || FacePipelines::new(device, layouts, options, accumulator.format(), form, variant);
            let faces = pipelines.entry((form, variant)).or_insert_with(make).clone();
            DrawnLight { binding: binding.clone(), form, faces }
        };
        self.lights = inputs.lights.iter().map(drawn).collect();
        Ok(())
    }

    /// An error for a light that would be drawn wrongly.
    fn refuse(&self, index: usize, light: &Light) -> Result<(), Error> {
        let Light::Spot(spot) = light else { return Ok(()) };
        let soft = spot.inner_angle < spot.outer_angle;
        if matches!(self.options.evaluation, Evaluation::Table { .. }) && soft {
            let what = "its edge is soft, which a table of constant intensity does not hold; use \
                        Evaluation::Quadrature or make inner_angle equal outer_angle";
            return Err(Error::Unsupported { light: index, what });
        }
        Ok(())
    }

    fn prepare_buffers(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        lights: &[LightBinding],
    ) -> Result<(), Error> {
        let Some((pipelines, tolerance)) = &self.tessellation else { return Ok(()) };
        let size = lights.iter().map(|light| light.projection.size).max().unwrap_or(0);
        if size >= tessellation::LEAST_SIZE
            && self.buffers.as_ref().is_none_or(|buffers| buffers.size() != size)
        {
            self.buffers = None;
            self.buffers =
                Some(tessellation::Buffers::new(device, queue, pipelines, &self.view, size, *tolerance)?);
        }
        let layers: usize = lights.iter().map(|light| light.projection.layers.len()).sum();
        let needed = layers.max(1) as u64 * tessellation::ARGUMENTS_SIZE;
        if self.counts.as_ref().is_none_or(|counts| counts.size() != needed) {
            let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            self.counts = Some(make_buffer(device, "billeter-plv: counts", needed, usage)?);
        }
        Ok(())
    }

    /// How many panels this phase function takes, into every `Draw` block behind the layer's number.
    fn prepare_draws(&mut self, queue: &wgpu::Queue, medium: &Medium) {
        if self.phase.as_ref() == Some(&medium.phase) {
            return;
        }
        let least = match self.options.evaluation {
            Evaluation::Quadrature { panels } => panels,
            Evaluation::Table { .. } => 2,
        };
        let panels = panels_for(&medium.phase, least);
        for layer in 0..6 {
            queue.write_buffer(&self.draws, layer * DRAW_STRIDE + 4, &panels.to_le_bytes());
        }
        self.phase = Some(medium.phase.clone());
    }

    /// Tables of the medium's phase function, or a texel that stands for none.
    fn prepare_tables(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, medium: &Medium) {
        let (lobes, [width, height], format) = match self.options.evaluation {
            Evaluation::Table { width, height, format } => {
                (medium.phase.lobes.iter().map(|(_, lobe)| *lobe).collect(), [width, height], format)
            }
            Evaluation::Quadrature { .. } => (Vec::new(), [4, 2], common::gpu::TableFormat::F32),
        };
        if self.tables.as_ref().is_some_and(|(built, _)| *built == lobes) {
            return;
        }
        let built: Vec<_> = if lobes.is_empty() {
            build_tables(Lobe::Isotropic, width, height).into()
        } else {
            lobes.iter().flat_map(|&lobe| build_tables(lobe, width, height)).collect()
        };
        let tables: Vec<_> = built.iter().collect();
        let view = upload_tables(device, queue, "billeter-plv: airlight tables", &tables, format);
        self.tables = Some((lobes, view));
    }

    /// Encodes all passes; airlight is added to `target`. Nothing without a [`Mesh::prepare`].
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let (Some(accumulated), Some(frame)) = (self.accumulator.view(), &self.frame) else { return };
        self.accumulator.encode_clear(encoder, PASSES[0], timer);
        let mut counted = 0;
        for light in &self.lights {
            for layer in 0..light.binding.projection.layers.len() as u32 {
                self.encode_layer(encoder, accumulated, frame, light, layer, timer);
                if let (Some(buffers), Some(counts)) = (&self.buffers, &self.counts)
                    && buffers.size() == light.binding.projection.size
                {
                    let size = tessellation::ARGUMENTS_SIZE;
                    encoder.copy_buffer_to_buffer(&buffers.arguments, 0, counts, counted * size, Some(size));
                    counted += 1;
                }
            }
        }
        self.accumulator.encode_add(encoder, target, PASSES[4], timer);
    }

    fn encode_layer(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        accumulated: &wgpu::TextureView,
        frame: &wgpu::BindGroup,
        light: &DrawnLight,
        layer: u32,
        timer: &mut PassTimer,
    ) {
        let faces = &light.faces;
        let directional = light.form == LightForm::Directional;
        let size = light.binding.projection.size;
        let adaptive = match (&self.tessellation, &self.buffers) {
            (Some((pipelines, _)), Some(buffers)) if buffers.size() == size => {
                pipelines.encode(encoder, buffers, &light.binding, layer, timer);
                Some(buffers)
            }
            _ => None,
        };
        let mut pass = begin_pass(encoder, Attachments::onto(accumulated), PASSES[3], timer);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, &light.binding.bind_group, &[]);
        pass.set_bind_group(2, &self.draw_group, &[layer * DRAW_STRIDE as u32]);
        if directional {
            pass.set_pipeline(&faces.everywhere);
            pass.draw(0..3, 0..1);
        }
        pass.set_pipeline(&faces.strips);
        match adaptive {
            Some(buffers) => {
                pass.draw_indirect(&buffers.arguments, FULL_ARGUMENTS);
                pass.set_pipeline(&faces.indexed);
                pass.set_index_buffer(buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed_indirect(&buffers.arguments, 0);
            }
            None => pass.draw(0..2 * size, 0..size - 1),
        }
        pass.set_pipeline(&faces.closure);
        pass.draw(0..24 * (size - 1), 0..if directional { 2 } else { 1 });
    }

    /// See [`Renderer::read_adaptive_triangles`](crate::Renderer::read_adaptive_triangles).
    pub(crate) fn read_adaptive_triangles(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Option<u32> {
        let (buffers, counts) = (self.buffers.as_ref()?, self.counts.as_ref()?);
        let projections = self.lights.iter().map(|light| &light.binding.projection);
        let layers: usize = projections.filter(|p| p.size == buffers.size()).map(|p| p.layers.len()).sum();
        const WORDS: usize = tessellation::ARGUMENTS_SIZE as usize / 4;
        let arguments = common::gpu::read_u32s(device, queue, counts, WORDS * layers)?;
        // Indices and instances of the adaptive mesh; where it has no instance, cells of the full one.
        let triangles = |a: &[u32]| if a[1] == 1 { a[0] / 3 } else { 2 * a[6] * a[6] };
        Some(arguments.chunks_exact(WORDS).map(triangles).sum())
    }
}
