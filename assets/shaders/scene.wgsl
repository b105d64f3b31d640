// Points and lines of constant size on the screen, each vertex in the frame of its station.

struct Uniforms {
    clip_from_world: mat4x4<f32>,
    // Eight stations, and the world itself.
    world_from_frame: array<mat4x4<f32>, 9>,
    background: vec4<f32>,
    viewport_pixels: vec2<f32>,
    // Times since the first measurement (s); readings and tracks at others are dimmed.
    selection: vec2<f32>,
    pixels_per_point: f32,
    // A bit for each fate that is shown.
    shown_fates: u32,
    // From when to when the trail goes.
    trail: vec2<f32>,
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

fn disc(corner: u32, centre: vec4<f32>, diameter: f32, colour: vec4<f32>) -> PointOutput {
    let offset = vec2<f32>(f32(corner & 1u), f32(corner >> 1u)) * 2.0 - 1.0;
    // Half a pixel more, for the soft edge.
    let radius = 0.5 * diameter * u.pixels_per_point + 0.5;
    let shift = offset * radius * 2.0 / u.viewport_pixels * centre.w;
    let clip = vec4<f32>(centre.xy + shift, centre.zw);
    return PointOutput(clip, colour, offset, radius);
}

@vertex
fn point_vertex(in: PointInput) -> PointOutput {
    return disc(in.corner, to_clip(in.position, in.frame), in.diameter, in.colour);
}

// In the last byte of a cloud's colour: the station's number, and
const STATION: u32 = 7u;
const LARGE: u32 = 8u;
const JOINED: u32 = 16u;
// Above these the number of a reading's fate.
const FATE: u32 = 5u;

// How much of a colour is left outside of the selection.
const DIMMED: f32 = 0.25;

fn at_time(colour: vec4<u32>, time: f32) -> vec4<f32> {
    var rgb = vec3<f32>(colour.rgb) / 255.0;
    if time < u.selection.x || time > u.selection.y {
        rgb = mix(u.background.rgb, rgb, DIMMED);
    }
    return vec4<f32>(rgb, 1.0);
}

struct ReadingInput {
    @builtin(vertex_index) corner: u32,
    // And the time.
    @location(0) position: vec4<f32>,
    @location(1) colour: vec4<u32>,
};

@vertex
fn reading_vertex(in: ReadingInput) -> PointOutput {
    let style = in.colour.a;
    if ((u.shown_fates >> (style >> FATE)) & 1u) == 0u {
        // Beyond the far plane: nothing is drawn.
        return PointOutput(vec4<f32>(0.0, 0.0, 2.0, 1.0), vec4<f32>(0.0), vec2<f32>(0.0), 0.0);
    }
    let diameter = select(2.5, 4.0, (style & LARGE) != 0u);
    let centre = to_clip(in.position.xyz, style & STATION);
    return disc(in.corner, centre, diameter, at_time(in.colour, in.position.w));
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

fn line(corner: u32, start: vec4<f32>, end: vec4<f32>, width: f32, colour: vec4<f32>) -> LineOutput {
    var a = start;
    var b = end;
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
    let side = f32(corner & 1u) * 2.0 - 1.0;
    var clip = a;
    if corner >= 2u {
        clip = b;
    }
    let shift = normal * side * 0.5 * width * u.pixels_per_point;
    clip = vec4<f32>(clip.xy + shift * 2.0 / u.viewport_pixels * clip.w, clip.zw);
    return LineOutput(clip, colour);
}

@vertex
fn line_vertex(in: LineInput) -> LineOutput {
    let a = to_clip(in.a, in.a_frame);
    let b = to_clip(in.b, in.b_frame);
    return line(in.corner, a, b, in.width, in.colour);
}

struct TrackInput {
    @builtin(vertex_index) corner: u32,
    // Two points that follow each other, and their times; the colour is the later one's.
    @location(0) a: vec4<f32>,
    @location(1) b: vec4<f32>,
    @location(2) colour: vec4<u32>,
};

@vertex
fn track_vertex(in: TrackInput) -> LineOutput {
    let style = in.colour.a;
    if (style & JOINED) == 0u {
        // Beyond the far plane: nothing is drawn.
        return LineOutput(vec4<f32>(0.0, 0.0, 2.0, 1.0), vec4<f32>(0.0));
    }
    let frame = style & STATION;
    let a = to_clip(in.a.xyz, frame);
    let b = to_clip(in.b.xyz, frame);
    return line(in.corner, a, b, 1.6, at_time(in.colour, in.b.w));
}

// How wide the trail is where it begins and where it ends.
const TRAIL_WIDTHS: vec2<f32> = vec2<f32>(2.0, 5.0);
// By so much depth the trail lies over the readings that it goes through: about a hundredth of the distance.
const TRAIL_NEARER: f32 = 1e-4;

@vertex
fn trail_vertex(in: TrackInput) -> LineOutput {
    let style = in.colour.a;
    let elapsed = in.b.w - in.a.w;
    // Cut at both ends of the trail.
    let shares = clamp((u.trail - in.a.w) / max(elapsed, 1e-6), vec2<f32>(0.0), vec2<f32>(1.0));
    if (style & JOINED) == 0u || shares.x >= shares.y {
        // Beyond the far plane: nothing is drawn.
        return LineOutput(vec4<f32>(0.0, 0.0, 2.0, 1.0), vec4<f32>(0.0));
    }
    let frame = style & STATION;
    let a = to_clip(mix(in.a.xyz, in.b.xyz, shares.x), frame);
    let b = to_clip(mix(in.a.xyz, in.b.xyz, shares.y), frame);
    // The corners 0 and 1 are at a.
    let time = in.a.w + elapsed * select(shares.x, shares.y, in.corner >= 2u);
    let youth = (time - u.trail.x) / (u.trail.y - u.trail.x);
    let width = mix(TRAIL_WIDTHS.x, TRAIL_WIDTHS.y, youth);
    var out = line(in.corner, a, b, width, vec4<f32>(at_time(in.colour, time).rgb, youth));
    out.clip.z -= TRAIL_NEARER * out.clip.w;
    return out;
}

@fragment
fn line_fragment(in: LineOutput) -> @location(0) vec4<f32> {
    return in.colour;
}
