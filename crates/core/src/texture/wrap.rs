//! What lies outside of a picture.

use super::whole::fraction;

/// What lies outside of the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// Its mirror image.
    Mirror,
    /// The nearest edge texel.
    Clamp,
    /// Black.
    Black,
}

impl Wrap {
    /// By name.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "repeat" => Self::Repeat,
            "mirror" => Self::Mirror,
            "clamp" => Self::Clamp,
            "black" => Self::Black,
            _ => return None,
        })
    }

    /// The texel that stands at index `i` of `n`; `None` for black.
    #[inline]
    pub fn apply(self, i: i32, n: usize) -> Option<usize> {
        if i >= 0 && (i as usize) < n {
            return Some(i as usize);
        }
        self.outside(i64::from(i), n as i64)
    }

    #[cold]
    #[inline(never)]
    fn outside(self, i: i64, n: i64) -> Option<usize> {
        match self {
            // One step over the edge is the usual case, and division is slow.
            Self::Repeat if i >= -n && i < 2 * n => Some(if i < 0 { i + n } else { i - n } as usize),
            Self::Repeat => Some(i.rem_euclid(n) as usize),
            Self::Mirror => {
                let k = i.rem_euclid(2 * n);
                Some(if k < n { k } else { 2 * n - 1 - k } as usize)
            }
            Self::Clamp => Some(i.clamp(0, n - 1) as usize),
            Self::Black => None,
        }
    }

    /// A coordinate in the unit square or near it that shows the same, so that indices stay small.
    #[inline]
    pub fn reduce(self, u: f32) -> f32 {
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

    #[test]
    fn indices_outside() {
        let at = |w: Wrap| (-3..5).map(|i| w.apply(i, 2).map_or(9, |x| x)).collect::<Vec<_>>();
        assert_eq!(at(Wrap::Repeat), [1, 0, 1, 0, 1, 0, 1, 0]);
        assert_eq!(at(Wrap::Mirror), [1, 1, 0, 0, 1, 1, 0, 0]);
        assert_eq!(at(Wrap::Clamp), [0, 0, 0, 0, 1, 1, 1, 1]);
        assert_eq!(at(Wrap::Black), [9, 9, 9, 0, 1, 9, 9, 9]);
        assert_eq!(Wrap::Repeat.apply(i32::MAX, 1), Some(0));
        assert_eq!(Wrap::Mirror.apply(i32::MIN, 3), Some(1));
    }

    #[test]
    fn reduced_coordinates_show_the_same() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black] {
            for i in -40..40 {
                let u = (i as f32 + 0.5) / 8.0;
                let texel = |u: f32| wrap.apply((u * 4.0).floor() as i32, 4);
                assert_eq!(texel(wrap.reduce(u)), texel(u), "{wrap:?} {u}");
            }
        }
    }
}
