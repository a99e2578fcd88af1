//! A compute shader counts the brightnesses of a picture, each group in memory of its own; the histogram is drawn into
//! `compute_histogram.png`.

use std::sync::atomic::{AtomicU32, Ordering};

use steradian_raster::{
    ColorTarget, ComputeShader, Draw, Extent, Format, Fragment, Framebuffer, Invocation, Pipeline, Program, Result,
    State, Vertex, VertexInput, dispatch, fragment,
    glam::{Vec2, Vec4},
    varyings,
};

varyings! {
    struct Place {
        at: Vec2,
    }
}

/// Counts the brightnesses of a picture.
struct Histogram<'a> {
    picture: &'a ColorTarget,
    counts: &'a [AtomicU32; 64],
}

/// The counts of a group.
struct Counts([u32; 64]);

impl Default for Counts {
    fn default() -> Self {
        Self([0; 64])
    }
}

impl ComputeShader for Histogram<'_> {
    type Shared = Counts;
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [16, 16, 1];
    const PHASES: u32 = 2;

    fn shade(&self, phase: u32, at: Invocation, (): &mut (), shared: &mut Counts) {
        if phase == 0 {
            if let Some(color) = self.picture.pixel(at.global[0], at.global[1]) {
                let brightness = 0.25 * color.x + 0.5 * color.y + 0.25 * color.z;
                shared.0[(brightness * 63.99) as usize] += 1;
            }
        } else if at.index < 64 {
            self.counts[at.index as usize].fetch_add(shared.0[at.index as usize], Ordering::Relaxed);
        }
    }
}

/// Draws a colour for each place, (0, 0) at the top left to (1, 1).
fn paint(shader: impl Fn(Vec2) -> Vec4 + Sync) -> Result<ColorTarget> {
    let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(256, 192), Format::Rgba8Unorm)?;
    let vertex = |input: VertexInput| {
        let [x, y] = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]][input.vertex as usize];
        Vertex::new(Vec4::new(2.0 * x - 1.0, 1.0 - 2.0 * y, 0.5, 1.0), Place { at: Vec2::new(x, y) })
    };
    let program = Program::new(vertex, fragment(|f: &Fragment<Place>| shader(f.varyings().at)));
    Pipeline::new(program, State::default(), framebuffer.layout())?.draw(&mut framebuffer, &Draw::vertices(0..3))?;
    Ok(framebuffer.color(0).clone())
}

/// The histogram of a few soft discs.
pub fn picture() -> Result<ColorTarget> {
    let discs = paint(|at| {
        let disc = |x: f32, y: f32, r: f32| (1.0 - (at - Vec2::new(x, y)).length() / r).max(0.0);
        Vec4::splat((disc(0.3, 0.4, 0.5) + disc(0.8, 0.7, 0.3)).min(1.0))
    })?;
    let counts = std::array::from_fn(|_| AtomicU32::new(0));
    dispatch(&Histogram { picture: &discs, counts: &counts }, [16, 12, 1])?;
    let counts = counts.map(AtomicU32::into_inner);
    // The first bin has all that is black; the others give the scale.
    let largest = counts[1..].iter().copied().max().unwrap_or(1).max(1);
    paint(move |at| {
        let height = counts[((at.x * 64.0) as usize).min(63)] as f32 / largest as f32;
        if 1.0 - at.y < 0.95 * height { Vec4::new(0.95, 0.7, 0.2, 1.0) } else { Vec4::new(0.1, 0.12, 0.15, 1.0) }
    })
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    Ok(steradian_image::write("compute_histogram.png".as_ref(), &picture()?.to_image()?, &Default::default())?)
}
