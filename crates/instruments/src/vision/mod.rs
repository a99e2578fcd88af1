//! Experiments of vision, each with its equation and source in its file.

mod chromaticity;
mod color;
mod cones;
mod contrast;
mod deficiency;
mod diagram;
mod flicker;
mod glare;
mod illusion;
mod macadam;
mod machado;
mod night;
mod receptive_field;

use crate::laboratory::Experiment;

/// The experiments.
pub const EXPERIMENTS: &[Experiment] = &[
    chromaticity::EXPERIMENT,
    macadam::EXPERIMENT,
    color::EXPERIMENT,
    cones::EXPERIMENT,
    deficiency::EXPERIMENT,
    receptive_field::EXPERIMENT,
    illusion::EXPERIMENT,
    contrast::EXPERIMENT,
    flicker::EXPERIMENT,
    night::EXPERIMENT,
    glare::EXPERIMENT,
];
