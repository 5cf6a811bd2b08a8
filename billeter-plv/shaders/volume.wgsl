// The light volume: its mesh is the shadow map, its fragments are airlight from the eye.
// Needs view, phase, medium, light, kind, haze, shadow, table, airlight, grid.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var scene_depth: texture_depth_2d;
@group(0) @binding(3) var tables: texture_2d_array<f32>;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;

@group(2) @binding(0) var<uniform> draw: Draw;

struct Fragment {
    @builtin(position) @invariant clip: vec4f,
    /// From the eye [m].
    @location(0) offset: vec3f,
    /// xyz: offset of the face's first corner [m]; w: more texels than the face spans, 0 where that is not known.
    @location(1) @interpolate(flat) corner: vec4f,
}

/// More texels than lie between the corners of a face of the full mesh, of which two may have moved.
const FACE_TEXELS: f32 = 4.0;

fn fragment_at(position: vec3f, texels: f32) -> Fragment {
    let offset = position - view.eye;
    return Fragment(view.clip_from_world * vec4f(position, 1.0), offset, vec4f(offset, texels));
}

/// World position of a texel's vertex.
fn texel_position(layer: u32, texel: vec2u) -> vec3f {
    let vertex = texel_vertex(layer, texel);
    let plane = shadow_texel_plane(vertex.texel, light.shadow_size);
    return shadow_position(KIND, light.layers[layer], plane, vertex.distance);
}

/// The full mesh: one triangle strip for each row of cells.
@vertex
fn vs_strip(@builtin(vertex_index) index: u32, @builtin(instance_index) row: u32) -> Fragment {
    return fragment_at(texel_position(draw.layer, vec2u(index >> 1u, row + (index & 1u))), FACE_TEXELS);
}

/// The adaptive mesh: indices name vertices of a grid of 2^k + 1 on a side.
@vertex
fn vs_indexed(@builtin(vertex_index) index: u32) -> Fragment {
    let side = grid_cells(light.shadow_size) + 1u;
    return fragment_at(texel_position(draw.layer, vec2u(index % side, index / side)), 0.0);
}

/// Texel on the map's border, `step` steps counter-clockwise (seen from the light) along `side`:
/// 0 bottom, 1 right, 2 top, 3 left. Rows run downwards.
fn border_texel(side: u32, step: u32) -> vec2u {
    let last = u32(light.shadow_size) - 1u;
    switch side {
        case 0u: { return vec2u(step, last); }
        case 1u: { return vec2u(last, last - step); }
        case 2u: { return vec2u(last - step, 0u); }
        default: { return vec2u(0u, step); }
    }
}

/// Outward axis of a side of a layer.
fn side_axis(layer: ShadowLayer, side: u32) -> vec3f {
    switch side {
        case 0u: { return -layer.up; }
        case 1u: { return layer.right; }
        case 2u: { return layer.up; }
        default: { return -layer.right; }
    }
}

/// The cube face that lies beyond a side of the layer drawn.
fn neighbour(side: u32) -> u32 {
    let axis = side_axis(light.layers[draw.layer], side);
    for (var i = 0u; i < 6u; i += 1u) {
        if dot(light.layers[i].forward, axis) > 0.5 {
            return i;
        }
    }
    return draw.layer;
}

/// Where the wall below a border texel ends: at the apex of a spot, on the far plane of a directional
/// light, on the neighbouring face of a point light.
fn border_base(texel: vec2u, beyond: u32) -> vec3f {
    let layer = light.layers[draw.layer];
    if KIND == LIGHT_SPOT {
        return layer.origin;
    }
    let plane = shadow_texel_plane(vec2f(texel), light.shadow_size);
    if KIND == LIGHT_DIRECTIONAL {
        return shadow_position(KIND, layer, plane, light.far);
    }
    // The same direction in the neighbour's frame.
    let direction = plane.x * layer.right + plane.y * layer.up + layer.forward;
    let other = light.layers[beyond];
    let scale = 1.0 / dot(direction, other.forward);
    let there = vec2f(dot(direction, other.right), -dot(direction, other.up)) * scale;
    return texel_position(beyond, vec2u(round((there * 0.5 + 0.5) * (light.shadow_size - 1.0))));
}

/// Instance 0: walls that close the volume along the map's border, two triangles for each cell of the
/// border. Instance 1: the far plane of a directional light's shadow, a fan around its centre.
@vertex
fn vs_closure(@builtin(vertex_index) index: u32, @builtin(instance_index) part: u32) -> Fragment {
    if part == 0u {
        return wall(index);
    }
    return cap(index);
}

fn wall(index: u32) -> Fragment {
    let cells = u32(light.shadow_size) - 1u;
    let cell = index / 6u;
    let side = cell / cells;
    // (v1, v0, b0), (v1, b0, b1): runs against the mesh's own border, so the surface is oriented.
    let corner = index % 6u;
    let end = corner == 0u || corner == 3u || corner == 5u;
    let base = corner == 2u || corner == 4u || corner == 5u;
    let texel = border_texel(side, cell % cells + select(0u, 1u, end));
    var beyond = draw.layer;
    if KIND == LIGHT_POINT {
        beyond = neighbour(side);
        if beyond < draw.layer {
            // The neighbour has drawn this wall.
            return nowhere();
        }
    }
    if base {
        return fragment_at(border_base(texel, beyond), FACE_TEXELS);
    }
    return fragment_at(texel_position(draw.layer, texel), FACE_TEXELS);
}

/// Faces away from the light.
fn cap(index: u32) -> Fragment {
    let corner = index % 3u;
    if corner == 0u {
        let layer = light.layers[0];
        return fragment_at(layer.origin + layer.forward * light.far, 0.0);
    }
    let cells = u32(light.shadow_size) - 1u;
    let cell = index / 3u;
    if cell >= 4u * cells {
        // As many vertices are drawn as walls have: twice what a fan needs.
        return nowhere();
    }
    let step = cell % cells + select(0u, 1u, corner == 1u);
    return fragment_at(border_base(border_texel(cell / cells, step), 0u), 0.0);
}

/// A vertex of a triangle that is not drawn.
fn nowhere() -> Fragment {
    return Fragment(vec4f(0.0, 0.0, 0.0, 1.0), vec3f(0.0), vec4f(0.0));
}

@vertex
fn vs_everywhere(@builtin(vertex_index) index: u32) -> Fragment {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Fragment(vec4f(corner * 2.0 - 1.0, 0.0, 1.0), vec3f(0.0), vec4f(0.0));
}

/// Distance along a pixel's ray to the scene.
fn scene_distance(pixel: vec2f, direction: vec3f) -> f32 {
    return view_distance(view, textureLoad(scene_depth, vec2i(pixel), 0), direction);
}

/// Distances along a ray [m] between which it meets a face: where it passes the light's beam through the face's first
/// corner, as near as the face's texels. Seen edge-on, a face is so thin that what is interpolated may lie anywhere.
fn face_span(direction: vec3f, corner: vec3f, texels: f32) -> vec2f {
    let parallel = KIND == LIGHT_DIRECTIONAL;
    let to_light = light.position - view.eye;
    let beam = select(normalize(corner - to_light), light.direction, parallel);
    let base = select(to_light, corner - dot(corner, beam) * beam, parallel);
    let cosine = dot(beam, direction);
    let sine = length(cross(beam, direction));
    // The ray's place nearest to the beam, and how far that is along the beam.
    let along_ray = dot(base - dot(base, beam) * beam, direction) / max(sine * sine, 1e-12);
    let along_beam = cosine * along_ray - dot(base, beam);
    let layer = light.layers[draw.layer];
    let width = texels * 2.0 * max(length(layer.right), length(layer.up)) / light.shadow_size;
    var slack = width / max(sine, 1e-9);
    if !parallel {
        // Beams widen: a ray that turns away from one more slowly may never leave it.
        slack = select(1e30, width * abs(along_beam) / (sine - width), sine > width);
    }
    // What rounding makes of the nearest place: of world positions, however near eye and light are to each other.
    slack += 1e-6 * (length(base) + length(view.eye)) / max(sine * sine, 1e-12);
    return along_ray + vec2f(-slack, slack);
}

/// A face of the volume: airlight from the eye to the nearer of face and scene, added where the ray leaves
/// the light (it sees the side that faces the light) and taken away where it enters.
@fragment
fn fs_face(fragment: Fragment, @builtin(front_facing) leaves: bool) -> @location(0) vec4f {
    let direction = view_ray(view, fragment.clip.xy);
    let span = face_span(direction, fragment.corner.xyz, fragment.corner.w);
    // What is seen is not behind the eye: where a face is too thin to be interpolated, its first corner says as much.
    let offset = select(fragment.corner.xyz, fragment.offset, dot(fragment.offset, direction) > 0.0);
    let interpolated = dot(offset, direction);
    let known = fragment.corner.w > 0.0;
    let face = max(select(interpolated, clamp(interpolated, span.x, span.y), known), 0.0);
    let value = airlight(view.eye, direction, min(face, scene_distance(fragment.clip.xy, direction)));
    return vec4f(select(-value, value, leaves), 0.0);
}

/// All the ray: light that no projection bounds shines everywhere but in its shadow volume.
@fragment
fn fs_everywhere(fragment: Fragment) -> @location(0) vec4f {
    let direction = view_ray(view, fragment.clip.xy);
    return vec4f(airlight(view.eye, direction, scene_distance(fragment.clip.xy, direction)), 0.0);
}
