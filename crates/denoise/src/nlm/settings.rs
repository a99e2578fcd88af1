//! Settings of the filter.

use super::window::REACH;
use crate::error::{Error, Result};

/// Settings of the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels so far away tell of each other: 1 to 11. 11.
    pub radius: u32,
    /// k, above 0: by how many standard deviations of their difference pixels may differ. More filters more. 0.95.
    pub damping: f32,
    /// The part of a pixel's variance that is taken to be left after the first pass beyond that of its mean, from 0 to
    /// 1. 0.03.
    pub pilot: f32,
    /// By how much albedo may differ, above 0. 0.1.
    pub sigma_albedo: f32,
    /// By how much unit normals may differ, above 0. 0.5.
    pub sigma_normal: f32,
    /// By which part of itself depth may differ beyond what its slope explains, above 0. 0.01.
    pub sigma_depth: f32,
    /// Give back light that was lost, so that the mean of the picture stays. true.
    pub keeps_mean: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            radius: 11,
            damping: 0.95,
            pilot: 0.03,
            sigma_albedo: 0.1,
            sigma_normal: 0.5,
            sigma_depth: 0.01,
            keeps_mean: true,
        }
    }
}

impl Settings {
    /// Checks that all are in their ranges.
    pub(super) fn check(&self) -> Result<()> {
        let rules = [
            ("radius", (1..=REACH as u32).contains(&self.radius), "from 1 to 11"),
            ("damping", self.damping > 0.0, "above 0"),
            ("pilot", (0.0..=1.0).contains(&self.pilot), "from 0 to 1"),
            ("sigma_albedo", self.sigma_albedo > 0.0, "above 0"),
            ("sigma_normal", self.sigma_normal > 0.0, "above 0"),
            ("sigma_depth", self.sigma_depth > 0.0, "above 0"),
        ];
        match rules.into_iter().find(|rule| !rule.1) {
            Some((what, _, range)) => Err(Error::Setting { what, range }),
            None => Ok(()),
        }
    }
}
