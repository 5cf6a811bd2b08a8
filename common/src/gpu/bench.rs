//! The WGSL test bench: validates shader text without a GPU, holds uniform blocks to their WGSL
//! layout, and runs WGSL functions so that they can be compared with their Rust twins.

mod branches;
#[cfg(feature = "reference")]
pub mod scenes;

use std::sync::OnceLock;

use glam::Vec4;

pub use branches::uniform_branches;

use super::{Context, ContextOptions, readback::read_bytes};

/// The context that all tests of a program share.
///
/// # Panics
/// Where there is no adapter: the sentence says what to install.
pub fn context() -> &'static Context {
    static CONTEXT: OnceLock<Context> = OnceLock::new();
    CONTEXT.get_or_init(|| match Context::new(&ContextOptions::default()) {
        Ok(context) => context,
        Err(error) => panic!("{error}"),
    })
}

/// Parses and validates composed WGSL, without a GPU and without optional features.
///
/// # Errors
/// What the compiler says, with the line.
pub fn validate_wgsl(source: &str) -> Result<naga::Module, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let flags = naga::valid::ValidationFlags::all();
    naga::valid::Validator::new(flags, naga::valid::Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    Ok(module)
}

/// Storage buffers that each entry point of composed WGSL uses: there are at most eight of them everywhere.
///
/// # Errors
/// What the compiler says, with the line.
pub fn storage_buffers(source: &str) -> Result<Vec<(String, usize)>, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let flags = naga::valid::ValidationFlags::all();
    let info = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty())
        .validate(&module)
        .map_err(|error| error.emit_to_string(source))?;
    let storage =
        |variable: &naga::GlobalVariable| matches!(variable.space, naga::AddressSpace::Storage { .. });
    let used = |(index, entry): (usize, &naga::EntryPoint)| {
        let info = info.get_entry_point(index);
        let of_entry =
            module.global_variables.iter().filter(|(handle, v)| storage(v) && !info[*handle].is_empty());
        (entry.name.clone(), of_entry.count())
    };
    Ok(module.entry_points.iter().enumerate().map(used).collect())
}

/// Checks that every member of the WGSL struct `name` lies where the uniform's bytes have it: `expect`
/// lists all members in order, each with the value (a float or the bits of an integer) that `bytes`
/// must hold at the member's first component.
///
/// # Errors
/// The member that lies elsewhere, or what else differs.
pub fn check_uniform_layout(
    source: &str,
    name: &str,
    bytes: &[u8],
    expect: &[(&str, u32)],
) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let found = module.types.iter().find_map(|(_, ty)| match &ty.inner {
        naga::TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => {
            Some((members, *span))
        }
        _ => None,
    });
    let (members, span) = found.ok_or_else(|| format!("the shader has no struct {name}"))?;
    if bytes.len() != span as usize {
        return Err(format!("{name}: {} bytes in Rust, {span} in WGSL", bytes.len()));
    }
    if members.len() != expect.len() {
        return Err(format!("{name}: {} members expected, {} in WGSL", expect.len(), members.len()));
    }
    for (member, &(field, value)) in members.iter().zip(expect) {
        if member.name.as_deref() != Some(field) {
            return Err(format!("{name}: expected member {field}, WGSL has {:?}", member.name));
        }
        let at = member.offset as usize;
        let word = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
        if word != Some(value) {
            return Err(format!("{name}.{field}: {word:?} at offset {at}, expected {value}"));
        }
    }
    Ok(())
}

/// Evaluates a WGSL expression of type `vec4f` in `x: vec4f` for each input, on the GPU. `chunks` are
/// joined in order before it; `prelude` runs first in the body; `textures` are declared by name and type
/// (`"tables: texture_2d_array<f32>"`).
///
/// # Panics
/// When the shader does not compile or the device is lost.
pub fn eval_wgsl(
    context: &Context,
    chunks: &[&str],
    textures: &[(&str, &wgpu::TextureView)],
    prelude: &str,
    expression: &str,
    inputs: &[Vec4],
) -> Vec<Vec4> {
    let (device, queue) = (&context.device, &context.queue);
    let declared: String = textures
        .iter()
        .enumerate()
        .map(|(i, (declaration, _))| format!("@group(1) @binding({i}) var {declaration};\n"))
        .collect();
    let source = format!(
        "{declared}{}
        @group(0) @binding(0) var<storage, read> bench_inputs: array<vec4f>;
        @group(0) @binding(1) var<storage, read_write> bench_outputs: array<vec4f>;
        @compute @workgroup_size(64)
        fn bench_main(@builtin(global_invocation_id) id: vec3u) {{
            if id.x >= arrayLength(&bench_inputs) {{ return; }}
            let x = bench_inputs[id.x];
            {prelude}
            bench_outputs[id.x] = {expression};
        }}",
        chunks.join("\n")
    );
    if let Err(message) = validate_wgsl(&source) {
        panic!("{message}");
    }
    let size = (inputs.len() * 16) as u64;
    let buffer = |label, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    };
    let input = buffer("bench: inputs", wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST);
    let output = buffer(
        "bench: outputs",
        wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
    );
    queue.write_buffer(&input, 0, bytemuck::cast_slice(inputs));
    // NaN beforehand: a shader that wrote nothing differs from one that wrote 0.
    queue.write_buffer(&output, 0, &vec![0xff; size as usize]);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("bench"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("bench"),
        layout: None,
        module: &module,
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("bench"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
        ],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        if !textures.is_empty() {
            pass.set_bind_group(1, &texture_group(device, &pipeline, textures), &[]);
        }
        pass.dispatch_workgroups((inputs.len() as u32).div_ceil(64), 1, 1);
    }
    queue.submit([encoder.finish()]);
    let bytes = read_bytes(device, queue, &output, size).expect("the device is there");
    if let Some(message) = context.take_error() {
        panic!("{message}");
    }
    bytemuck::pod_collect_to_vec(&bytes)
}

fn texture_group(
    device: &wgpu::Device,
    pipeline: &wgpu::ComputePipeline,
    textures: &[(&str, &wgpu::TextureView)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = textures
        .iter()
        .zip(0..)
        .map(|(&(_, view), binding)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("bench: textures"),
        layout: &pipeline.get_bind_group_layout(1),
        entries: &entries,
    })
}
