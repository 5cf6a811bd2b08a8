//! A scene's triangles and materials on the GPU. Uploaded once; per frame only placements change.

use glam::{Mat4, Vec3, Vec4};

use crate::Scene;

/// Vertex and storage buffers of a scene.
pub(crate) struct SceneBuffers {
    vertices: wgpu::Buffer,
    objects: wgpu::Buffer,
    materials: wgpu::Buffer,
    ranges: Vec<std::ops::Range<u32>>,
}

/// Position, normal, material: 28 bytes.
const STRIDE: u64 = 28;

impl SceneBuffers {
    /// Uploads all meshes of `scene`; `None` when they do not fit into one buffer of this device.
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene) -> Option<Self> {
        let limits = device.limits();
        let size = scene.triangle_count() as u64 * 3 * STRIDE;
        if size > limits.max_buffer_size {
            return None;
        }
        let mut words: Vec<u32> = Vec::with_capacity(size as usize / 4);
        let mut ranges = Vec::with_capacity(scene.objects.len());
        for object in &scene.objects {
            let first = (words.len() as u64 * 4 / STRIDE) as u32;
            let mesh = &object.mesh;
            for (index, corners) in mesh.triangles.iter().enumerate() {
                let positions = corners.map(|v| mesh.positions[v as usize]);
                let flat =
                    (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalize_or_zero();
                let material = mesh.materials.get(index).copied().unwrap_or(0);
                for (position, &v) in positions.iter().zip(corners) {
                    let normal = mesh.normals.get(v as usize).copied().unwrap_or(flat);
                    words.extend(position.to_array().iter().chain(&normal.to_array()).map(|x| x.to_bits()));
                    words.push(material);
                }
            }
            ranges.push(first..(words.len() as u64 * 4 / STRIDE) as u32);
        }
        let upload = |label, bytes: &[u8], usage| {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                // A binding must not be empty.
                size: (bytes.len() as u64).max(128),
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let materials: Vec<Vec4> = scene
            .materials
            .iter()
            .flat_map(|material| [material.k_d.extend(material.exponent), material.k_s.extend(0.0)])
            .collect();
        let buffers = Self {
            vertices: upload("common: vertices", bytemuck::cast_slice(&words), wgpu::BufferUsages::VERTEX),
            objects: upload("common: objects", &object_bytes(scene), wgpu::BufferUsages::STORAGE),
            materials: upload(
                "common: materials",
                bytemuck::cast_slice(&materials),
                wgpu::BufferUsages::STORAGE,
            ),
            ranges,
        };
        Some(buffers)
    }

    /// Writes where the objects are now; `scene` is the one that was uploaded, at another time.
    pub(crate) fn update(&self, queue: &wgpu::Queue, scene: &Scene) {
        queue.write_buffer(&self.objects, 0, &object_bytes(scene));
    }

    /// Storage buffer of WGSL `array<Object>`.
    pub(crate) fn objects(&self) -> &wgpu::Buffer {
        &self.objects
    }

    /// Storage buffer of WGSL `array<Material>`.
    pub(crate) fn materials(&self) -> &wgpu::Buffer {
        &self.materials
    }

    /// Layout of the vertex buffer: position, normal, material.
    pub(crate) fn vertex_layout() -> wgpu::VertexBufferLayout<'static> {
        const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
            wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32];
        wgpu::VertexBufferLayout {
            array_stride: STRIDE,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &ATTRIBUTES,
        }
    }

    /// Draws all objects; the instance index is the object's.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        for (object, range) in self.ranges.iter().enumerate() {
            pass.draw(range.clone(), object as u32..object as u32 + 1);
        }
    }
}

/// `array<Object>`: placement, and the inverse transpose of its linear part for normals.
fn object_bytes(scene: &Scene) -> Vec<u8> {
    let matrices: Vec<Mat4> = scene
        .objects
        .iter()
        .flat_map(|object| {
            let place = object.world_from_object;
            let normals = place.matrix3.inverse().transpose();
            let columns = [normals.x_axis, normals.y_axis, normals.z_axis].map(|c| Vec3::from(c).extend(0.0));
            [Mat4::from(place), Mat4::from_cols(columns[0], columns[1], columns[2], Vec4::W)]
        })
        .collect();
    bytemuck::cast_slice(&matrices).to_vec()
}
