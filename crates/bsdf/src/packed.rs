//! Spectra in less room.

use steradian_math::Spectrum;

/// A spectrum of values in [0, 1] to 16 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unit4([u16; 4]);

impl Unit4 {
    /// One in all lanes.
    pub(crate) const ONE: Self = Self([u16::MAX; 4]);

    pub(crate) fn new(s: Spectrum) -> Self {
        Self(s.to_array().map(|v| if v > 0.0 { (v.min(1.0) * 65535.0 + 0.5) as u16 } else { 0 }))
    }

    #[inline]
    pub(crate) fn get(self) -> Spectrum {
        Spectrum::new(self.0.map(|v| f32::from(v) * (1.0 / 65535.0)))
    }

    #[inline]
    pub(crate) fn most(self) -> f32 {
        if self.is_black() {
            return 0.0;
        }
        f32::from(self.0.into_iter().max().unwrap_or(0)) * (1.0 / 65535.0)
    }

    #[inline]
    pub(crate) fn is_black(self) -> bool {
        self.0 == [0; 4]
    }
}
