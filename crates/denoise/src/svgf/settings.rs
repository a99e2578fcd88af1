//! Filter settings of terms.

use crate::error::{Error, Result};

/// Filter settings of terms. The default is that of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The least weight of the newest frame in the sum of frames: above 0, at most 1. Frame n of a history has weight
    /// 1/n until then. 0.2.
    pub alpha: f32,
    /// The least weight of the newest frame in the sum of the moments, from which the variance is estimated. 0.2.
    pub moments_alpha: f32,
    /// Clamps colours of the history to the box of those that the 3×3 pixels around have in the newest frame (Karis,
    /// "High Quality Temporal Supersampling", SIGGRAPH 2014). Follows light that changes, at the price of noise: good
    /// for terms whose frames have little of it. False.
    pub clamp_history: bool,
    /// Number of passes of the filter over the picture, from 0 to 16; the last has gaps of 2^(iterations − 1) pixels.
    /// 5.
    pub iterations: u32,
    /// σ_z, above 0: by how many times what its gradient tells depth may differ. 1.
    pub sigma_depth: f32,
    /// σ_n: the power of the cosine of the angle between normals. 128.
    pub normal_power: u32,
    /// σ_l, above 0: by how many standard deviations luminance may differ. Infinite where luminance has no say. 4.
    pub sigma_luminance: f32,
    /// Gives back the light that filtering loses: weights by luminance leave rare bright samples out. The mean is then
    /// that of the samples; gains are bounded, and smooth across edges. False.
    pub keeps_mean: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            alpha: 0.2,
            moments_alpha: 0.2,
            clamp_history: false,
            iterations: 5,
            sigma_depth: 1.0,
            normal_power: 128,
            sigma_luminance: 4.0,
            keeps_mean: false,
        }
    }
}

impl Settings {
    /// Checks that all are in their ranges.
    pub(crate) fn check(&self) -> Result<()> {
        let is_weight = |w: f32| w > 0.0 && w <= 1.0;
        let rules = [
            ("alpha", is_weight(self.alpha), "above 0 and at most 1"),
            ("moments_alpha", is_weight(self.moments_alpha), "above 0 and at most 1"),
            ("iterations", self.iterations <= 16, "at most 16"),
            ("sigma_depth", self.sigma_depth > 0.0, "above 0"),
            ("sigma_luminance", self.sigma_luminance > 0.0, "above 0"),
        ];
        match rules.into_iter().find(|rule| !rule.1) {
            Some((what, _, range)) => Err(Error::Setting { what, range }),
            None => Ok(()),
        }
    }
}
