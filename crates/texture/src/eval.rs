//! Evaluating trees of textures, with a stack of our own: their depth is the input's.
//!
//! A texture refers to earlier textures by index, so that trees cannot be cyclic; they may be of any depth.

use super::{OwnValue, Texture, TextureContext, TextureId, Textures, adjust, own};
use steradian_math::{
    Spectrum, Vec3,
    spectra::{
        ColorMode, Wavelengths, role,
        role::{Color, Role},
    },
};

/// Kind of value requested from a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Want<'a> {
    /// One number, in the first lane.
    Float,
    /// Linear Rec.709, in three lanes.
    Rgb,
    /// The lanes of a path.
    Spectrum(Role, &'a Wavelengths),
}

/// Next step of an evaluation; operands are on the stack of values.
#[derive(Clone, Copy)]
enum Step<'a> {
    /// Evaluate a texture.
    Visit(TextureId, Want<'a>),
    /// Multiply the two topmost values.
    Multiply,
    /// Add the topmost, times a number, to the one below.
    AddScaled(f32),
    /// Go on with the parts of a mix, whose amount is the topmost value.
    Choose(TextureId, Want<'a>),
    /// Interpolate between the two topmost.
    Mix(f32),
    /// Adjust the colour on top.
    Adjust(TextureId, Want<'a>),
}

/// A stack that allocates only when it grows deep.
struct Stack<T, const N: usize> {
    shallow: [T; N],
    len: usize,
    deep: Vec<T>,
}

impl<T: Copy, const N: usize> Stack<T, N> {
    #[inline]
    fn new(fill: T) -> Self {
        Self { shallow: [fill; N], len: 0, deep: Vec::new() }
    }

    #[inline]
    fn push(&mut self, v: T) {
        if self.len < N {
            self.shallow[self.len] = v;
            self.len += 1;
        } else {
            self.deep.push(v);
        }
    }

    #[inline]
    fn pop(&mut self) -> Option<T> {
        if let Some(v) = self.deep.pop() {
            return Some(v);
        }
        self.len = self.len.checked_sub(1)?;
        Some(self.shallow[self.len])
    }
}

impl Textures {
    /// The spectral value at a point. `role` says what RGB texels stand for.
    #[inline]
    pub fn spectrum(&self, id: TextureId, at: &TextureContext, role: Role, lambda: &Wavelengths) -> Spectrum {
        let want = Want::Spectrum(role, lambda);
        self.leaf(id, at, want).unwrap_or_else(|| self.tree(id, at, want))
    }

    /// The scalar value at a point: the mean of the components of coloured textures.
    #[inline]
    pub fn float(&self, id: TextureId, at: &TextureContext) -> f32 {
        self.leaf(id, at, Want::Float).unwrap_or_else(|| self.tree(id, at, Want::Float))[0]
    }

    /// The value at a point as linear Rec.709, not clamped: for normals and displacements.
    #[inline]
    pub fn rgb(&self, id: TextureId, at: &TextureContext) -> Vec3 {
        Vec3::from(self.leaf(id, at, Want::Rgb).unwrap_or_else(|| self.tree(id, at, Want::Rgb)).to_rgb())
    }

    /// Three components as what is asked for.
    #[inline]
    fn as_wanted(&self, rgb: Vec3, want: Want) -> Spectrum {
        match want {
            Want::Float => Spectrum::splat(adjust::mean(rgb)),
            Want::Rgb => Spectrum::rgb(rgb.x, rgb.y, rgb.z),
            Want::Spectrum(role, lambda) => role::texel(rgb, role, lambda, self.mode),
        }
    }

    /// The value of a texture without parts.
    #[inline]
    fn leaf(&self, id: TextureId, at: &TextureContext, want: Want) -> Option<Spectrum> {
        Some(match &self.nodes[id.0 as usize] {
            Texture::Constant(c) => match want {
                Want::Float => Spectrum::splat(match (c, self.mode) {
                    (Color::Lanes(s), ColorMode::Rgb) => (s[0] + s[1] + s[2]) / 3.0,
                    (Color::Lanes(s), ColorMode::Spectral) => s[0],
                    (c, _) => c.luminance(self.mode),
                }),
                Want::Rgb => match c {
                    Color::Lanes(s) => *s,
                    Color::Spectral(_) => self.as_wanted(self.rgbs.get(&id.0).copied().unwrap_or(Vec3::ZERO), want),
                },
                Want::Spectrum(_, lambda) => c.eval(lambda),
            },
            Texture::Image(image) => match want {
                Want::Float => Spectrum::splat(image.float(at)),
                _ => self.as_wanted(image.rgb(at).unwrap_or(Vec3::ZERO), want),
            },
            Texture::DistanceField(field) => Spectrum::splat(field.value(at)),
            Texture::Time => Spectrum::splat(at.time),
            Texture::MeshAttribute { name, domain, scale } => match super::attribute(name, *domain, at) {
                Some((_, 3..))
                    if let (Want::Spectrum(Role::Albedo, lambda), Some((mesh, triangle, uv))) = (want, at.mesh)
                        && let Some(s) = mesh.attribute_spectrum(name, *domain, triangle, uv, lambda) =>
                {
                    s * *scale
                }
                Some((v, 1)) => Spectrum::splat(v[0] * scale),
                Some((v, _)) => self.as_wanted(Vec3::new(v[0], v[1], v[2]) * *scale, want),
                None => Spectrum::ZERO,
            },
            Texture::Grid(grid) => match grid.value(at) {
                (v, 1) => Spectrum::splat(v.x),
                (v, _) => self.as_wanted(v, want),
            },
            Texture::Formula(formula) => match formula.value(at) {
                (v, 1) => Spectrum::splat(v.x),
                (v, _) => self.as_wanted(v, want),
            },
            Texture::Own(own, mapping) => match own::value(&**own, mapping, at) {
                OwnValue::Number(v) => Spectrum::splat(v),
                OwnValue::Rgb(v) => self.as_wanted(v, want),
            },
            Texture::Pattern(pattern) => Spectrum::splat(pattern.value(at)),
            Texture::Scale(..) | Texture::Add(..) | Texture::Mix(..) | Texture::Triplanar(..) | Texture::Adjust(..) => {
                return None;
            }
        })
    }

    /// The value of a texture with parts.
    fn tree(&self, id: TextureId, at: &TextureContext, want: Want) -> Spectrum {
        let mut steps = Stack::<_, 24>::new(Step::Multiply);
        let mut values = Stack::<_, 24>::new(Spectrum::ZERO);
        steps.push(Step::Visit(id, want));
        while let Some(step) = steps.pop() {
            match step {
                Step::Visit(id, want) => match self.leaf(id, at, want) {
                    Some(v) => values.push(v),
                    None => self.open(id, at, want, &mut steps, &mut values),
                },
                Step::Choose(id, want) => {
                    let t = values.pop().map_or(0.0, |v| v[0]);
                    let Texture::Mix(a, b, _) = self.nodes[id.0 as usize] else { continue };
                    if t == 0.0 {
                        steps.push(Step::Visit(a, want));
                    } else if t == 1.0 {
                        steps.push(Step::Visit(b, want));
                    } else {
                        steps.push(Step::Mix(t));
                        steps.push(Step::Visit(b, want));
                        steps.push(Step::Visit(a, want));
                    }
                }
                Step::Adjust(id, want) => {
                    let v = values.pop().unwrap_or(Spectrum::ZERO);
                    let Texture::Adjust(_, adjust) = &self.nodes[id.0 as usize] else { continue };
                    values.push(self.as_wanted(adjust.apply(Vec3::from(v.to_rgb())), want));
                }
                Step::Multiply | Step::AddScaled(_) | Step::Mix(_) => {
                    let (Some(b), Some(a)) = (values.pop(), values.pop()) else { break };
                    values.push(match step {
                        Step::AddScaled(k) => a + b * k,
                        Step::Mix(t) => a * (1.0 - t) + b * t,
                        _ => a * b,
                    });
                }
            }
        }
        values.pop().unwrap_or(Spectrum::ZERO)
    }

    /// Puts the parts of a texture on the stack.
    fn open<'a>(
        &self,
        id: TextureId,
        at: &TextureContext,
        want: Want<'a>,
        steps: &mut Stack<Step<'a>, 24>,
        values: &mut Stack<Spectrum, 24>,
    ) {
        match &self.nodes[id.0 as usize] {
            Texture::Scale(a, b) => {
                // A factor has no bounds, and white light is not a factor.
                let factor = match want {
                    Want::Spectrum(_, lambda) => Want::Spectrum(Role::Unbounded, lambda),
                    _ => want,
                };
                for step in [Step::Multiply, Step::Visit(*b, factor), Step::Visit(*a, want)] {
                    steps.push(step);
                }
            }
            Texture::Add(a, b) => {
                for step in [Step::AddScaled(1.0), Step::Visit(*b, want), Step::Visit(*a, want)] {
                    steps.push(step);
                }
            }
            Texture::Mix(_, _, amount) => {
                steps.push(Step::Choose(id, want));
                steps.push(Step::Visit(*amount, Want::Float));
            }
            Texture::Triplanar(parts, planes) => {
                values.push(Spectrum::ZERO);
                for (part, weight) in parts.iter().zip(planes.weights(at)) {
                    if weight > 0.0 {
                        steps.push(Step::AddScaled(weight));
                        steps.push(Step::Visit(*part, want));
                    }
                }
            }
            Texture::Adjust(part, _) => {
                steps.push(Step::Adjust(id, want));
                steps.push(Step::Visit(*part, Want::Rgb));
            }
            _ => values.push(Spectrum::ZERO),
        }
    }
}
