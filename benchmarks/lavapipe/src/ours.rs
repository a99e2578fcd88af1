//! The frames of our pipeline.

use crate::work::{HEIGHT, Row, Shading, WIDTH};
use steradian_raster::{
    Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, Result, State, Varyings, Vertex, VertexInput,
    fragment,
    fragment::Quad,
    glam::{Vec2, Vec3, Vec4},
    stages::{DepthOnly, FragmentShader},
    state::{DepthState, Multisample},
    texture::{Lod, Sampler, Texture},
    varyings,
};

varyings! {
    struct Lit {
        normal: Vec3,
    }
}

varyings! {
    struct Textured {
        uv: Vec2,
    }
}

const TO_LIGHT: Vec3 = Vec3::new(0.36, 0.48, 0.8);

/// Something that draws a frame, resolves its samples, and gives the bytes of the picture if asked for: four of colour
/// for each pixel, or a depth as `f32`.
pub type Frame<'a> = Box<dyn FnMut(bool) -> Result<Vec<u8>> + 'a>;

/// The frame of a row.
pub fn frame<'a>(row: &'a Row, texture: &'a Texture) -> Result<Frame<'a>> {
    let normal = |v: usize| Lit { normal: row.mesh.normals[v] };
    match row.shading {
        Shading::Depth => with(row, |_| (), DepthOnly::new()),
        Shading::Lit => with(row, normal, Light::<false>),
        Shading::Phong => with(row, normal, Light::<true>),
        Shading::Textured => {
            let sampler = Sampler::default();
            let textured = move |f: &Fragment<Textured>| {
                let lod = Lod::Gradients(f.dx(|v| v.uv).extend(0.0), f.dy(|v| v.uv).extend(0.0));
                sampler.sample(&texture.view(), f.varyings().uv.extend(0.0).extend(0.0), lod)
            };
            with(row, |v| Textured { uv: 3.0 * row.mesh.points[v].truncate() }, fragment(textured))
        }
    }
}

/// Square roots, written out so that they become one instruction.
#[inline(always)]
fn roots(x: Vec4) -> Vec4 {
    Vec4::new(x.x.sqrt(), x.y.sqrt(), x.z.sqrt(), x.w.sqrt())
}

/// The two models of light, in the four lanes of a quad; Phong's where `SHINES`.
struct Light<const SHINES: bool>;

impl<const SHINES: bool> FragmentShader for Light<SHINES> {
    type Varyings = Lit;
    type Output = Vec4;

    #[inline(always)]
    fn shade(&self, fragment: &Fragment<Lit>) -> Vec4 {
        self.shade_quad(fragment.quad)[fragment.lane]
    }

    #[inline(always)]
    fn shade_quad(&self, quad: &Quad<Lit>) -> [Vec4; 4] {
        let [a, b, c, d] = &quad.varyings;
        let lanes = |axis: usize| Vec4::new(a.normal[axis], b.normal[axis], c.normal[axis], d.normal[axis]);
        let [x, y, z] = [lanes(0), lanes(1), lanes(2)];
        let scale = 1.0 / roots(x * x + y * y + z * z);
        let cosine = (x * TO_LIGHT.x + y * TO_LIGHT.y + z * TO_LIGHT.z) * scale;
        let light = cosine.max(Vec4::ZERO);
        if !SHINES {
            let grey = |light: f32| Vec4::new(light, light, light, 1.0);
            return [grey(light.x), grey(light.y), grey(light.z), grey(light.w)];
        }
        // The third component of the mirrored direction, since the eye is there.
        let s = (2.0 * cosine * (z * scale) - TO_LIGHT.z).max(Vec4::ZERO);
        let s2 = s * s;
        let s4 = s2 * s2;
        let s8 = s4 * s4;
        let s16 = s8 * s8;
        let shine = s16 * s16;
        let color = |light: f32, shine: f32| (Vec3::new(0.6, 0.3, 0.2) * light + shine).extend(1.0);
        [color(light.x, shine.x), color(light.y, shine.y), color(light.z, shine.z), color(light.w, shine.w)]
    }
}

fn with<'a, V, F>(row: &'a Row, varyings: impl Fn(usize) -> V + Sync + 'a, shader: F) -> Result<Frame<'a>>
where
    V: Varyings + 'a,
    F: FragmentShader<Varyings = V> + 'a,
{
    let extent = Extent::new(WIDTH, HEIGHT).samples(row.samples);
    let mut framebuffer = match row.shading {
        Shading::Depth => Framebuffer::with_depth(extent)?,
        _ => Framebuffer::with_color_and_depth(extent, Format::Rgba8Unorm)?,
    };
    let layers = row.layers as f32;
    let vertex = move |input: VertexInput| {
        let v = input.vertex as usize;
        let mut p = row.mesh.matrix * row.mesh.points[v].extend(1.0);
        // Later layers lie in front.
        p.z = (p.z + (layers - 1.0 - input.instance as f32) * p.w) / layers;
        Vertex::new(p, varyings(v))
    };
    let depth = Some(DepthState::LESS);
    let state = State { depth, multisample: Multisample::samples(row.samples), ..State::default() };
    let pipeline = Pipeline::new(Program::new(vertex, shader), state, framebuffer.layout())?;
    Ok(Box::new(move |wanted| {
        framebuffer.clear(Vec4::ZERO, 1.0, 0);
        pipeline.draw(&mut framebuffer, &Draw::indexed(&row.mesh.indices).instances(0..row.layers))?;
        let resolved = (row.samples > 1).then(|| framebuffer.color(0).resolve());
        Ok(match (wanted, row.shading) {
            (false, _) => Vec::new(),
            (true, Shading::Depth) => {
                let depths = framebuffer.depth().map(|depths| depths.to_rows(0));
                depths.unwrap_or_default().into_iter().flat_map(f32::to_le_bytes).collect()
            }
            (true, _) => resolved.as_ref().unwrap_or(framebuffer.color(0)).to_bytes(0),
        })
    }))
}
