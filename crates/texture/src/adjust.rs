//! Changes of a colour that a texture gives: one channel of it, another colour space, hue and saturation.

use super::ramp::Ramp;
use std::sync::Arc;
use steradian_math::{Mat3, Vec3, color::luminance};

/// Adjustment of a colour.
#[derive(Clone, Debug)]
pub enum Adjust {
    /// One of its components everywhere.
    Channel(Channel),
    /// Another space: a matrix on linear components.
    Matrix(Box<Mat3>),
    /// Hue, saturation and value.
    Hsv {
        /// Turned by this many full circles.
        hue: f32,
        /// Factor on the saturation.
        saturation: f32,
        /// Factor on the value.
        value: f32,
    },
    /// Each component by a curve of its own.
    Curve(Arc<Ramp>),
    /// A colour for the mean of the components.
    Ramp(Arc<Ramp>),
}

/// A component of a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The first.
    R,
    /// The second.
    G,
    /// The third.
    B,
    /// Luminance.
    Luminance,
    /// The mean of the three.
    Mean,
    /// The largest.
    Max,
}

impl Channel {
    /// The component of a colour.
    pub fn of(self, c: Vec3) -> f32 {
        match self {
            Self::R => c.x,
            Self::G => c.y,
            Self::B => c.z,
            Self::Luminance => luminance(c),
            Self::Mean => mean(c),
            Self::Max => c.max_element(),
        }
    }
}

/// The mean of three components, exact where they are equal.
pub fn mean(c: Vec3) -> f32 {
    if c.x == c.y && c.y == c.z { c.x } else { (c.x + c.y + c.z) / 3.0 }
}

/// Hue in [0, 1), saturation and value of a colour (Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978).
pub fn hsv(c: Vec3) -> Vec3 {
    let (max, min) = (c.max_element(), c.min_element());
    let d = max - min;
    if !(d > 0.0 && max > 0.0) {
        return Vec3::new(0.0, 0.0, max);
    }
    let sextant = if max == c.x {
        (c.y - c.z) / d
    } else if max == c.y {
        2.0 + (c.z - c.x) / d
    } else {
        4.0 + (c.x - c.y) / d
    };
    let hue = sextant / 6.0;
    Vec3::new(hue - hue.floor(), d / max, max)
}

/// The colour of a hue (modulo one), saturation and value.
pub fn from_hsv(v: Vec3) -> Vec3 {
    let h = (v.x - v.x.floor()) * 6.0;
    let channel = |n: f32| {
        let k = (n + h) % 6.0;
        v.z - v.z * v.y * k.min(4.0 - k).clamp(0.0, 1.0)
    };
    Vec3::new(channel(5.0), channel(3.0), channel(1.0))
}

impl Adjust {
    /// The changed colour.
    pub fn apply(&self, c: Vec3) -> Vec3 {
        match self {
            Self::Channel(channel) => Vec3::splat(channel.of(c)),
            Self::Matrix(m) => **m * c,
            Self::Hsv { hue, saturation, value } => {
                let v = hsv(c);
                from_hsv(Vec3::new(v.x + hue, (v.y * saturation).clamp(0.0, 1.0), v.z * value))
            }
            Self::Curve(curve) => Vec3::new(curve.at(c.x).x, curve.at(c.y).y, curve.at(c.z).z),
            Self::Ramp(ramp) => ramp.at(mean(c)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hue_and_back() {
        for c in
            [Vec3::new(0.2, 0.7, 0.1), Vec3::new(0.9, 0.1, 0.6), Vec3::new(0.3, 0.3, 0.3), Vec3::new(0.0, 0.2, 2.0)]
        {
            assert!((from_hsv(hsv(c)) - c).length() < 1e-6, "{c}");
        }
        assert_eq!(hsv(Vec3::new(0.0, 1.0, 0.0)), Vec3::new(1.0 / 3.0, 1.0, 1.0));
        assert_eq!(hsv(Vec3::ZERO), Vec3::ZERO);
        // A third of the circle exchanges the primaries, no saturation is grey.
        let turn = Adjust::Hsv { hue: 1.0 / 3.0, saturation: 1.0, value: 0.5 };
        assert!((turn.apply(Vec3::X) - Vec3::new(0.0, 0.5, 0.0)).length() < 1e-6);
        assert_eq!(
            Adjust::Hsv { hue: 0.4, saturation: 0.0, value: 1.0 }.apply(Vec3::new(0.2, 0.5, 0.1)),
            Vec3::splat(0.5)
        );
    }

    #[test]
    fn channels() {
        let c = Vec3::new(1.0, 2.0, 6.0);
        let of = |x: Channel| Adjust::Channel(x).apply(c);
        assert_eq!(
            (of(Channel::G), of(Channel::Mean), of(Channel::Max)),
            (Vec3::splat(2.0), Vec3::splat(3.0), Vec3::splat(6.0))
        );
        assert!((of(Channel::Luminance).x - (0.2126 + 1.4304 + 0.4332)).abs() < 1e-3);
        assert_eq!(mean(Vec3::splat(0.1)), 0.1);
    }
}
