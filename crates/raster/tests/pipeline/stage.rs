//! Small shaders and random numbers for the tests.

use steradian_raster::{
    ColorTarget, Counters, DepthFormat, DepthTarget, Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program,
    State, StencilTarget, Vertex, VertexInput, fragment,
    glam::{Vec3, Vec4},
    varyings,
};

varyings! {
    /// A colour.
    pub struct Color {
        pub color: Vec4,
    }
}

/// A generator of numbers that are the same each time (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In [low, high).
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
}

/// Clip space of a point in pixels (y down) of a square picture.
pub fn at_pixel(x: f32, y: f32, size: u32) -> Vec4 {
    let size = size as f32;
    Vec4::new(2.0 * x / size - 1.0, 1.0 - 2.0 * y / size, 0.5, 1.0)
}

/// Colour of 32-bit floats, depth and stencil.
pub fn framebuffer(size: u32, samples: u32) -> Framebuffer {
    let extent = Extent::new(size, size).samples(samples);
    Framebuffer::new(
        vec![ColorTarget::new(extent, Format::Rgba32Float).unwrap()],
        Some(DepthTarget::new(extent, DepthFormat::Float32).unwrap()),
        Some(StencilTarget::new(extent).unwrap()),
    )
    .unwrap()
}

/// Draws vertices with a colour each.
pub fn draw(framebuffer: &mut Framebuffer, state: State, vertices: &[(Vec4, Vec4)]) -> Counters {
    let vertex = |input: VertexInput| {
        let (position, color) = vertices[input.vertex as usize];
        Vertex::new(position, Color { color })
    };
    let program = Program::new(vertex, fragment(|f: &Fragment<Color>| f.varyings().color));
    let pipeline = Pipeline::new(program, state, framebuffer.layout()).unwrap();
    pipeline.draw(framebuffer, &Draw::vertices(0..vertices.len() as u32)).unwrap()
}

/// Draws vertices in one colour.
pub fn draw_white(framebuffer: &mut Framebuffer, state: State, vertices: &[Vec4]) -> Counters {
    let vertices: Vec<_> = vertices.iter().map(|p| (*p, Vec4::ONE)).collect();
    draw(framebuffer, state, &vertices)
}

/// The red values, row by row.
pub fn reds(framebuffer: &Framebuffer) -> Vec<f32> {
    let Extent { width, height, .. } = framebuffer.extent();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    pixels.map(|(x, y)| framebuffer.color(0).pixel(x, y).unwrap().x).collect()
}

/// A hash of the bytes of all layers of a colour target.
pub fn fingerprint(target: &ColorTarget) -> u64 {
    let bytes = (0..target.extent().layers).flat_map(|layer| target.to_bytes(layer));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// A perspective projection with depths from 0 (near) to 1 (far): 90° both ways, looking along −z.
pub fn perspective(p: Vec3, near: f32, far: f32) -> Vec4 {
    Vec4::new(p.x, p.y, far * (-p.z - near) / (far - near), -p.z)
}
