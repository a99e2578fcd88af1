//! Settings of the filter.

use super::features::SMOOTHED;
use crate::error::{Error, Result};

/// Settings of the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels up to so many columns and rows away are averaged: 1 to 32. 8.
    pub radius: u32,
    /// Patches reach so many pixels from their middle, up to 8; in the second pass 2 at most. 3.
    pub patch: u32,
    /// k, above 0: by how many standard deviations of their difference patches may differ. More filters more. 0.45.
    pub damping: f32,
    /// The part of a pixel's variance that is taken to be left after the first pass beyond that of its mean, from 0 to
    /// 1. 0.01.
    pub pilot: f32,
    /// By how much albedo may differ, above 0. 0.05.
    pub sigma_albedo: f32,
    /// By how much unit normals may differ, above 0. 0.15.
    pub sigma_normal: f32,
    /// By which part of itself depth may differ beyond what its slope explains, above 0. 0.01.
    pub sigma_depth: f32,
    /// Give back the light that the weights lost, so that the mean of the picture stays. true.
    pub keeps_mean: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            radius: 8,
            patch: 3,
            damping: 0.45,
            pilot: 0.01,
            sigma_albedo: 0.05,
            sigma_normal: 0.15,
            sigma_depth: 0.01,
            keeps_mean: true,
        }
    }
}

impl Settings {
    /// Largest distance at which other pixels are read.
    pub(super) fn margin(&self) -> usize {
        ((self.radius + self.patch) as usize).max(SMOOTHED)
    }

    /// Checks that all are in their ranges.
    pub(super) fn check(&self) -> Result<()> {
        let rules = [
            ("radius", (1..=32).contains(&self.radius), "from 1 to 32"),
            ("patch", self.patch <= 8, "at most 8"),
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
