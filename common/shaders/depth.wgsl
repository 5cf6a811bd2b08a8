// Depth of a scene as a light's projection sees it.

struct Object {
    world_from_object: mat4x4f,
    normal_from_object: mat4x4f,
}

@group(0) @binding(0) var<uniform> clip_from_world: mat4x4f;
@group(0) @binding(1) var<storage, read> objects: array<Object>;

@vertex
fn vs_depth(@location(0) position: vec3f, @builtin(instance_index) index: u32) -> @builtin(position) vec4f {
    return clip_from_world * (objects[index].world_from_object * vec4f(position, 1.0));
}
