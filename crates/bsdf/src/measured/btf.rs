//! Bidirectional texture functions: a picture of the surface for each pair of light and view directions.
//!
//! An index in text has one picture per line, `theta_i phi_i theta_o phi_o FILE`, angles in degrees, files relative to
//! the index. Texels are `π f`: one where a white Lambertian surface would be. Every light direction must be there for
//! every view direction. Between directions the three nearest of each are mixed by the inverse square of their
//! distance. (Dana et al. 1999, "Reflectance and Texture of Real-World Surfaces".)

use super::MeasuredError;
use std::path::PathBuf;
use steradian_math::{Vec2, Vec3};

/// Most pictures, and most texels of all together.
const MAX_PICTURES: usize = 1 << 14;
const MAX_TEXELS: usize = 1 << 27;
/// Number of directions that a lookup mixes.
const NEAREST: usize = 3;

/// One picture: linear RGB, row 0 at the top (v = 1).
#[derive(Clone, Debug)]
pub struct Slice {
    /// Texels per row and column.
    pub size: [usize; 2],
    /// Row by row.
    pub texels: Vec<Vec3>,
}

/// A stack of pictures.
#[derive(Clone, Debug)]
pub struct Btf {
    lights: Vec<Vec3>,
    views: Vec<Vec3>,
    size: [usize; 2],
    /// `[light][view][row][column]`, `f` in sr⁻¹.
    texels: Vec<[f32; 3]>,
}

/// A line of the index: light, view, file.
pub type Line = (Vec3, Vec3, PathBuf);

/// The lines of an index.
///
/// # Errors
/// The first line that cannot be understood.
pub fn index(text: &str) -> Result<Vec<Line>, MeasuredError> {
    let mut lines = Vec::new();
    for (number, line) in text.lines().enumerate().map(|(n, l)| (n + 1, l.trim())) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fault = || MeasuredError::Fault(format!("line {number}: wanted is theta_i phi_i theta_o phi_o FILE"));
        let mut rest = line;
        // Four angles, then the rest of the line as the name of the file.
        let mut angles = [0.0f32; 4];
        for a in &mut angles {
            let (cell, tail) = rest.split_once(char::is_whitespace).ok_or_else(fault)?;
            *a = cell.parse().ok().filter(|v: &f32| v.is_finite()).ok_or_else(fault)?;
            rest = tail.trim_start();
        }
        if [angles[0], angles[2]].iter().any(|a| !(0.0..90.0).contains(a)) {
            return Err(MeasuredError::Fault(format!("line {number}: angles from the normal are below 90 degrees")));
        }
        if lines.len() >= MAX_PICTURES {
            return Err(MeasuredError::Fault(format!("it has more than {MAX_PICTURES} pictures")));
        }
        // Direction from polar angle and azimuth.
        let direction = |theta: f32, phi: f32| {
            let ((s, c), (y, x)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
            Vec3::new(s * x, s * y, c)
        };
        lines.push((direction(angles[0], angles[1]), direction(angles[2], angles[3]), PathBuf::from(rest)));
    }
    if lines.is_empty() {
        return Err(MeasuredError::Fault("it names no pictures".into()));
    }
    Ok(lines)
}

impl Btf {
    /// From an index and a way to open its pictures.
    ///
    /// # Errors
    /// A picture that cannot be opened or has another size, or pairs of directions that are missing.
    pub fn new(lines: &[Line], mut open: impl FnMut(&PathBuf) -> Result<Slice, String>) -> Result<Self, MeasuredError> {
        let mut lights: Vec<Vec3> = Vec::new();
        let mut views: Vec<Vec3> = Vec::new();
        // Number the distinct directions; nearly equal ones are the same.
        let place = |list: &mut Vec<Vec3>, w: Vec3| {
            list.iter().position(|v| v.distance_squared(w) < 1e-8).unwrap_or_else(|| {
                list.push(w);
                list.len() - 1
            })
        };
        let pairs: Vec<_> = lines.iter().map(|l| (place(&mut lights, l.0), place(&mut views, l.1))).collect();
        // The pictures must be all pairs of lights and views.
        if lights.len() * views.len() != lines.len() {
            return Err(MeasuredError::Fault(format!(
                "its {} pictures are not those of {} lights from {} views",
                lines.len(),
                lights.len(),
                views.len()
            )));
        }
        let mut size = None;
        let mut texels = Vec::new();
        let mut seen = vec![false; lines.len()];
        for ((light, view), line) in pairs.iter().zip(lines) {
            let slice = open(&line.2).map_err(MeasuredError::Fault)?;
            let [w, h] = *size.get_or_insert(slice.size);
            let count = w.saturating_mul(h);
            if slice.size != [w, h] || slice.texels.len() != count || count == 0 {
                return Err(MeasuredError::Fault(format!("'{}' has another size than the rest", line.2.display())));
            }
            if count.saturating_mul(lines.len()) > MAX_TEXELS {
                return Err(MeasuredError::Fault(format!("{} pictures of {w} × {h} are too much", lines.len())));
            }
            texels.resize(count * lines.len(), [0.0; 3]);
            // Pictures are stored by light, then by view.
            let at = light * views.len() + view;
            if std::mem::replace(&mut seen[at], true) {
                return Err(MeasuredError::Fault(format!(
                    "'{}' has the directions of another picture",
                    line.2.display()
                )));
            }
            // Texels are π f: divide by π.
            for (to, from) in texels[at * count..][..count].iter_mut().zip(slice.texels) {
                let f = from / std::f32::consts::PI;
                *to = if f.is_finite() { f.max(Vec3::ZERO).to_array() } else { [0.0; 3] };
            }
        }
        Ok(Self { lights, views, size: size.unwrap_or([1, 1]), texels })
    }

    /// `f` (sr⁻¹) in linear RGB at a place of the texture.
    pub fn eval(&self, wo: Vec3, wi: Vec3, uv: Vec2) -> Vec3 {
        // Mix the three nearest lights with the three nearest views.
        let (lights, views) = (nearest(&self.lights, wi), nearest(&self.views, wo));
        let mut value = Vec3::ZERO;
        for (l, wl) in lights {
            for (v, wv) in views {
                if wl * wv > 0.0 {
                    value += wl * wv * self.texel(l * self.views.len() + v, uv);
                }
            }
        }
        value
    }

    /// Mean over the texture: for fitting the density of directions.
    pub fn mean(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        // Average over a coarse grid of places, enough to fit a density.
        let n = 4;
        (0..n * n)
            .map(|i| Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32)
            .map(|uv| self.eval(wo, wi, uv))
            .sum::<Vec3>()
            / (n * n) as f32
    }

    /// Bilinear, repeating.
    fn texel(&self, picture: usize, uv: Vec2) -> Vec3 {
        let [w, h] = self.size;
        let place = |x: f32, n: usize| {
            // Centres of texels at half-integer places; the texture repeats.
            let x = (x - x.floor()) * n as f32 - 0.5;
            let low = x.floor();
            (
                (low as isize).rem_euclid(n as isize) as usize,
                (low as isize + 1).rem_euclid(n as isize) as usize,
                x - low,
            )
        };
        let ((x0, x1, fx), (y0, y1, fy)) = (place(uv.x, w), place(1.0 - uv.y, h));
        let at = |x: usize, y: usize| Vec3::from(self.texels[(picture * h + y) * w + x]);
        at(x0, y0).lerp(at(x1, y0), fx).lerp(at(x0, y1).lerp(at(x1, y1), fx), fy)
    }
}

/// The nearest directions and their weights, which add up to one.
fn nearest(list: &[Vec3], w: Vec3) -> [(usize, f32); NEAREST] {
    let mut best = [(0, f32::INFINITY); NEAREST];
    // Insert each direction into the sorted list of the nearest so far.
    for (i, v) in list.iter().enumerate() {
        let d = v.distance_squared(w);
        let mut entry = (i, d);
        for b in &mut best {
            if entry.1 < b.1 {
                std::mem::swap(b, &mut entry);
            }
        }
    }
    // Shepard's weights: the inverse of the squared distance, normalised.
    let weights = best.map(|b| if b.1.is_finite() { 1.0 / (b.1 + 1e-6) } else { 0.0 });
    let sum: f32 = weights.iter().sum();
    std::array::from_fn(|i| (best[i].0, weights[i] / sum))
}

/// A stack of 2 × 2 pictures of `π f(light, view)`, tinted by column.
pub fn stack(f: impl Fn(Vec3, Vec3) -> f32) -> Result<Btf, MeasuredError> {
    let mut text = String::new();
    for ti in [0, 30, 60, 80] {
        for pi in (0..360).step_by(60) {
            for to in [0, 30, 60, 80] {
                for po in (0..360).step_by(60) {
                    if (ti > 0 || pi == 0) && (to > 0 || po == 0) {
                        text += &format!("{ti} {pi} {to} {po} {ti}_{pi}_{to}_{po}.png\n");
                    }
                }
            }
        }
    }
    let lines = index(&text)?;
    let mut i = 0;
    Btf::new(&lines, |_| {
        let v = std::f32::consts::PI * f(lines[i].0, lines[i].1);
        i += 1;
        Ok(Slice {
            size: [2, 2],
            texels: vec![Vec3::splat(v), Vec3::new(v, 0.0, 0.0), Vec3::splat(v), Vec3::new(v, 0.0, 0.0)],
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_pairs_come_back_at_their_texels() {
        let f = |l: Vec3, v: Vec3| 0.1 + 0.05 * l.z + 0.02 * v.x;
        let btf = stack(f).expect("complete");
        let (wi, wo) = (Vec3::Z, Vec3::new(0.5, 0.0, 0.75f32.sqrt()));
        let left = btf.eval(wo, wi, Vec2::new(0.25, 0.25));
        assert!((left - Vec3::splat(f(wi, wo))).abs().max_element() < 1e-3, "{left}");
        let right = btf.eval(wo, wi, Vec2::new(0.75, 0.25));
        assert!(right.y < 1e-4 && (right.x - f(wi, wo)).abs() < 1e-3, "{right}");
    }

    #[test]
    fn hostile_stacks_are_refused() {
        for bad in ["", "0 0 0 a.png", "0 0 x 0 a.png", "0 0 95 0 a.png", "nan 0 0 0 a.png", "0 0 0 0"] {
            assert!(index(bad).is_err(), "{bad:?}");
        }
        let slice = |w: usize, h: usize| Ok(Slice { size: [w, h], texels: vec![Vec3::ONE; w * h] });
        let two = index("0 0 0 0 a\n30 0 0 0 b").expect("sound");
        assert!(Btf::new(&two, |_| slice(1, 1)).is_ok());
        let mut n = 0;
        let growing = Btf::new(&two, |_| {
            n += 1;
            slice(n, 1)
        });
        assert!(growing.is_err(), "sizes differ");
        assert!(Btf::new(&two, |_| Err("missing".into())).is_err());
        assert!(Btf::new(&two, |_| slice(0, 0)).is_err(), "no texels");
        assert!(Btf::new(&two, |_| Ok(Slice { size: [usize::MAX, 2], texels: Vec::new() })).is_err());
        let gap = index("0 0 0 0 a\n30 0 30 0 b").expect("sound");
        assert!(Btf::new(&gap, |_| slice(1, 1)).is_err(), "pairs are missing");
    }
}
