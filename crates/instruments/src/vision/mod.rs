//! Experiments of vision, each with its equation and source in its file.

mod blind_spot;
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
mod matching;
mod night;
mod receptive_field;
mod receptors;
mod sensitivity;
mod ycbcr;

use crate::laboratory::Experiment;

/// The experiments.
pub const EXPERIMENTS: &[Experiment] = &[
    chromaticity::EXPERIMENT,
    matching::EXPERIMENT,
    macadam::EXPERIMENT,
    color::EXPERIMENT,
    ycbcr::EXPERIMENT,
    receptors::EXPERIMENT,
    sensitivity::EXPERIMENT,
    blind_spot::EXPERIMENT,
    cones::EXPERIMENT,
    deficiency::EXPERIMENT,
    receptive_field::EXPERIMENT,
    illusion::EXPERIMENT,
    contrast::EXPERIMENT,
    flicker::EXPERIMENT,
    night::EXPERIMENT,
    glare::EXPERIMENT,
];
