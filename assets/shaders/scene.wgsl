// Points and lines of constant size on the screen, each vertex in the frame of its station.

struct Uniforms {
    clip_from_world: mat4x4<f32>,
    // Stations 1, 2, 3, and the world itself.
    world_from_frame: array<mat4x4<f32>, 4>,
    viewport_pixels: vec2<f32>,
    pixels_per_point: f32,
    padding: f32,
};

@group(0) @binding(0) var<uniform> u: Uniforms;

struct PointInput {
    @builtin(vertex_index) corner: u32,
    @location(0) position: vec3<f32>,
    @location(1) frame: u32,
    @location(2) colour: vec4<f32>,
    @location(3) diameter: f32,
};

struct PointOutput {
    @builtin(position) clip: vec4<f32>,
    @location(0) colour: vec4<f32>,
    // From -1 to 1 across the disc.
    @location(1) offset: vec2<f32>,
    @location(2) radius_pixels: f32,
};

fn to_clip(position: vec3<f32>, frame: u32) -> vec4<f32> {
    return u.clip_from_world * u.world_from_frame[frame] * vec4<f32>(position, 1.0);
}

@vertex
fn point_vertex(in: PointInput) -> PointOutput {
    let offset = vec2<f32>(f32(in.corner & 1u), f32(in.corner >> 1u)) * 2.0 - 1.0;
    // Half a pixel more, for the soft edge.
    let radius = 0.5 * in.diameter * u.pixels_per_point + 0.5;
    var clip = to_clip(in.position, in.frame);
    let shift = offset * radius * 2.0 / u.viewport_pixels * clip.w;
    clip = vec4<f32>(clip.xy + shift, clip.zw);
    return PointOutput(clip, in.colour, offset, radius);
}

@fragment
fn point_fragment(in: PointOutput) -> @location(0) vec4<f32> {
    let inside_pixels = (1.0 - length(in.offset)) * in.radius_pixels;
    let alpha = clamp(inside_pixels, 0.0, 1.0) * in.colour.a;
    if alpha < 0.02 {
        discard;
    }
    return vec4<f32>(in.colour.rgb, alpha);
}

struct LineInput {
    @builtin(vertex_index) corner: u32,
    @location(0) a: vec3<f32>,
    @location(1) a_frame: u32,
    @location(2) b: vec3<f32>,
    @location(3) b_frame: u32,
    @location(4) colour: vec4<f32>,
    @location(5) width: f32,
};

struct LineOutput {
    @builtin(position) clip: vec4<f32>,
    @location(0) colour: vec4<f32>,
};

@vertex
fn line_vertex(in: LineInput) -> LineOutput {
    var a = to_clip(in.a, in.a_frame);
    var b = to_clip(in.b, in.b_frame);
    // Cut what is behind the near plane, or the perspective division turns it inside out.
    let near = 1e-4;
    if a.w < near && b.w >= near {
        a = mix(a, b, (near - a.w) / (b.w - a.w));
    } else if b.w < near && a.w >= near {
        b = mix(b, a, (near - b.w) / (a.w - b.w));
    }
    let a_pixels = a.xy / a.w * 0.5 * u.viewport_pixels;
    let b_pixels = b.xy / b.w * 0.5 * u.viewport_pixels;
    let along = b_pixels - a_pixels;
    let size = length(along);
    var normal = vec2<f32>(0.0, 1.0);
    if size > 1e-6 {
        normal = vec2<f32>(-along.y, along.x) / size;
    }
    let side = f32(in.corner & 1u) * 2.0 - 1.0;
    var clip = a;
    if in.corner >= 2u {
        clip = b;
    }
    let shift = normal * side * 0.5 * in.width * u.pixels_per_point;
    clip = vec4<f32>(clip.xy + shift * 2.0 / u.viewport_pixels * clip.w, clip.zw);
    return LineOutput(clip, in.colour);
}

@fragment
fn line_fragment(in: LineOutput) -> @location(0) vec4<f32> {
    return in.colour;
}
