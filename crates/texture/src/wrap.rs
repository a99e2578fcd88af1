//! Wrap modes: the continuation of a picture beyond its sides.

use super::integers::fraction;
use steradian_math::Vec2;

/// Continuation of a picture outside the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// Its mirror image.
    Mirror,
    /// The nearest edge texel.
    Clamp,
    /// A colour.
    Border,
    /// Continuation on the sphere of which the picture is an octahedral map: each edge is joined to itself, turned
    /// about its middle. Both axes have it, or none.
    Octahedral,
}

/// Linear values of the channels of what lies beyond the picture's sides and beyond its top and bottom, for
/// [`Wrap::Border`].
pub type Borders = [[f32; 4]; 2];

/// Black, and nothing there.
pub const BLACK: Borders = [[0.0; 4]; 2];

impl Wrap {
    /// The texel that stands at index `i` of `n`; `None` for the border. Octahedral maps need the other axis too:
    /// [`Self::place`].
    #[inline]
    pub fn apply(self, i: i32, n: usize) -> Option<usize> {
        if i >= 0 && (i as usize) < n {
            return Some(i as usize);
        }
        self.outside(i64::from(i), n as i64)
    }

    /// The texel that stands at `x`, `y`, or the axis beyond whose border it is.
    #[inline]
    pub fn place([u, v]: [Self; 2], [x, y]: [i32; 2], [width, height]: [usize; 2]) -> Result<[usize; 2], usize> {
        let mut at = [u.apply(x, width).ok_or(0_usize)?, v.apply(y, height).ok_or(1_usize)?];
        if u == Self::Octahedral {
            // To cross an edge turns the other coordinate round.
            let is_odd = |i: i32, n: usize| i64::from(i).div_euclid(n as i64) % 2 != 0;
            if is_odd(y, height) {
                at[0] = width - 1 - at[0];
            }
            if is_odd(x, width) {
                at[1] = height - 1 - at[1];
            }
        }
        Ok(at)
    }

    #[cold]
    #[inline(never)]
    fn outside(self, i: i64, n: i64) -> Option<usize> {
        match self {
            // One step over the edge is the usual case, and division is slow.
            Self::Repeat if i >= -n && i < 2 * n => Some(if i < 0 { i + n } else { i - n } as usize),
            Self::Repeat => Some(i.rem_euclid(n) as usize),
            Self::Mirror | Self::Octahedral => {
                let k = i.rem_euclid(2 * n);
                Some(if k < n { k } else { 2 * n - 1 - k } as usize)
            }
            Self::Clamp => Some(i.clamp(0, n - 1) as usize),
            Self::Border => None,
        }
    }

    /// Coordinates in the unit square or near it that show the same, so that indices stay small.
    #[inline]
    pub fn reduce([u, v]: [Self; 2], uv: Vec2) -> Vec2 {
        let inside = 0.0..=1.0;
        if inside.contains(&uv.x) && inside.contains(&uv.y) {
            return uv;
        }
        if u == Self::Octahedral {
            // Two steps in a direction lead back; footprints need not be turned, since half a turn leaves them.
            return Vec2::new(2.0 * fraction(0.5 * uv.x), 2.0 * fraction(0.5 * uv.y));
        }
        Vec2::new(u.reduced(uv.x), v.reduced(uv.y))
    }

    #[inline]
    fn reduced(self, u: f32) -> f32 {
        match self {
            Self::Repeat if !(0.0..=1.0).contains(&u) => fraction(u),
            Self::Mirror if !(0.0..=2.0).contains(&u) => 2.0 * fraction(0.5 * u),
            _ => u,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::warp;

    #[test]
    fn indices_outside() {
        let at = |w: Wrap| (-3..5).map(|i| w.apply(i, 2).map_or(9, |x| x)).collect::<Vec<_>>();
        assert_eq!(at(Wrap::Repeat), [1, 0, 1, 0, 1, 0, 1, 0]);
        assert_eq!(at(Wrap::Mirror), [1, 1, 0, 0, 1, 1, 0, 0]);
        assert_eq!(at(Wrap::Clamp), [0, 0, 0, 0, 1, 1, 1, 1]);
        assert_eq!(at(Wrap::Border), [9, 9, 9, 0, 1, 9, 9, 9]);
        assert_eq!(Wrap::Repeat.apply(i32::MAX, 1), Some(0));
        assert_eq!(Wrap::Mirror.apply(i32::MIN, 3), Some(1));
        // The sides count first.
        assert_eq!(Wrap::place([Wrap::Border; 2], [-1, 9], [3, 3]), Err(0));
        assert_eq!(Wrap::place([Wrap::Repeat, Wrap::Border], [-1, 9], [3, 3]), Err(1));
    }

    #[test]
    fn reduced_coordinates_show_the_same() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Border, Wrap::Octahedral] {
            for i in -40..40 {
                let uv = Vec2::new((i as f32 + 0.5) / 8.0, (i * 7 % 32) as f32 / 8.0 + 0.01);
                let texel = |uv: Vec2| Wrap::place([wrap; 2], (uv * 4.0).floor().as_ivec2().to_array(), [4, 4]);
                assert_eq!(texel(Wrap::reduce([wrap; 2], uv)), texel(uv), "{wrap:?} {uv}");
            }
        }
    }

    /// Beyond each edge and corner of an octahedral map lies the texel that is nearest on the sphere.
    #[test]
    fn octahedral_maps_go_on_as_the_sphere_does() {
        const N: i32 = 16;
        let direction =
            |x: i32, y: i32| warp::equal_area_square_to_sphere(Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / N as f32);
        for along in 0..N {
            for (x, y, inner) in [
                (-1, along, [0, along]),
                (N, along, [N - 1, along]),
                (along, -1, [along, 0]),
                (along, N, [along, N - 1]),
            ] {
                let [i, j] = Wrap::place([Wrap::Octahedral; 2], [x, y], [N as usize; 2]).unwrap().map(|i| i as i32);
                let edge = direction(inner[0], inner[1]);
                let distance = (direction(i, j) - edge).length();
                // Of all texels on the edges but the two next to it along the same edge, none is nearer.
                let nearest = (0..N)
                    .flat_map(|k| [[0, k], [N - 1, k], [k, 0], [k, N - 1]])
                    .filter(|k| (k[0] - inner[0]).abs() + (k[1] - inner[1]).abs() > 1)
                    .map(|k| (direction(k[0], k[1]) - edge).length())
                    .fold(f32::INFINITY, f32::min);
                assert!(distance <= nearest + 1e-5, "{x} {y}: {i} {j}: {distance} {nearest}");
            }
        }
        // pbrt-v4's example: one texel beyond the left edge, the row counts from the other end.
        assert_eq!(Wrap::place([Wrap::Octahedral; 2], [-1, 3], [16, 16]), Ok([0, 12]));
        assert_eq!(Wrap::place([Wrap::Octahedral; 2], [-1, -1], [16, 16]), Ok([15, 15]));
    }
}
