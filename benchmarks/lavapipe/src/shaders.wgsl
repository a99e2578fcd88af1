// The shaders of the rows, as `ours.rs` has them.

struct Uniforms {
    matrix: mat4x4f,
    layers: f32,
}

@group(0) @binding(0) var<uniform> uniforms: Uniforms;
@group(0) @binding(1) var board: texture_2d<f32>;
@group(0) @binding(2) var trilinear: sampler;

struct Lit {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
}

struct Textured {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

const to_light = vec3f(0.36, 0.48, 0.8);
const to_eye = vec3f(0.0, 0.0, 1.0);

// Later layers lie in front.
fn clip(point: vec3f, instance: u32) -> vec4f {
    let p = uniforms.matrix * vec4f(point, 1.0);
    let depth = (p.z + (uniforms.layers - 1.0 - f32(instance)) * p.w) / uniforms.layers;
    return vec4f(p.xy, depth, p.w);
}

@vertex fn depth_vertex(@location(0) point: vec3f, @builtin(instance_index) i: u32) -> @builtin(position) vec4f {
    return clip(point, i);
}

@vertex fn lit_vertex(@location(0) point: vec3f, @location(1) normal: vec3f, @builtin(instance_index) i: u32) -> Lit {
    return Lit(clip(point, i), normal);
}

@vertex fn textured_vertex(@location(0) point: vec3f, @builtin(instance_index) i: u32) -> Textured {
    return Textured(clip(point, i), 3.0 * point.xy);
}

@fragment fn lit(in: Lit) -> @location(0) vec4f {
    let light = max(dot(normalize(in.normal), to_light), 0.0);
    return vec4f(light, light, light, 1.0);
}

@fragment fn textured(in: Textured) -> @location(0) vec4f {
    return textureSample(board, trilinear, in.uv);
}

@fragment fn phong(in: Lit) -> @location(0) vec4f {
    let n = normalize(in.normal);
    let mirrored = 2.0 * dot(n, to_light) * n - to_light;
    let s = max(dot(mirrored, to_eye), 0.0);
    let s2 = s * s;
    let s4 = s2 * s2;
    let s8 = s4 * s4;
    let s16 = s8 * s8;
    return vec4f(vec3f(0.6, 0.3, 0.2) * max(dot(n, to_light), 0.0) + s16 * s16, 1.0);
}
