//! Experiments: computations of optics, vision, Monte Carlo integration and analytic geometry that end in numbers, a
//! chart and a picture.
//!
//! An [`Experiment`] has a name, parameters with ranges and units, and a function that computes a [`Report`]. The four
//! families are [`crate::optics`], [`crate::vision`], [`crate::estimate`] and [`crate::geometry`]; [`find`] looks one
//! up.

pub use crate::laboratory::{
    Axis, Chart, Error, Experiment, Fact, Kind, Marker, Parameter, Picture, Quantity, Report, Run, Series, Values,
    monochromatic, rgb_from_xyz_in_gamut, spectrum_rgb,
};

/// The families: name, what it is about, experiments.
pub const FAMILIES: [(&str, &str, &[Experiment]); 4] = [
    (
        "optics",
        "experiments of optics: interference, diffraction, dispersion, thermal light",
        crate::optics::EXPERIMENTS,
    ),
    ("vision", "experiments of vision: chromaticity, cones, colour deficiencies, contrast", crate::vision::EXPERIMENTS),
    ("estimate", "experiments of Monte Carlo integration: error against samples", crate::estimate::EXPERIMENTS),
    (
        "geometry",
        "computations of analytic geometry: lines, planes, conics, surfaces, rotations and other maps",
        crate::geometry::EXPERIMENTS,
    ),
];

/// The experiment called `name` of a family.
pub fn find(family: &str, name: &str) -> Option<&'static Experiment> {
    FAMILIES.iter().find(|f| f.0 == family)?.2.iter().find(|e| e.name == name)
}

#[cfg(test)]
mod tests;
