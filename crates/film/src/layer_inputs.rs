//! Measurements that layers are made of.

/// A set of measurements beside the radiance of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerInputs(u8);

impl LayerInputs {
    /// Nothing but radiance.
    pub const NONE: Self = Self(0);
    /// First hits of camera rays.
    pub const FIRST_HITS: Self = Self(1);
    /// First hits behind mirrors and smooth glass, too.
    pub const SEEN_THROUGH: Self = Self(2 | 1);
    /// Motion of first hits since the frame before.
    pub const MOTION: Self = Self(4 | 1);
    /// Counts of objects and materials by first hits.
    pub const MATTES: Self = Self(8);
    /// Radiance of each group of lights.
    pub const LIGHT_GROUPS: Self = Self(16);
    /// Halves of the samples.
    pub const HALVES: Self = Self(32);
    /// Radiance by the number of scattering events.
    pub const BOUNCES: Self = Self(64);
    /// Radiance by bands of wavelengths.
    pub const BANDS: Self = Self(128);

    /// The union of two sets.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True if all of `inputs` are in this set.
    pub const fn has(self, inputs: Self) -> bool {
        self.0 & inputs.0 == inputs.0
    }
}
