//! Experiments of optics, each with its equation and source in its file.

mod aperture;
mod atmosphere;
mod bessel;
mod blackbody;
mod doppler;
mod film;
mod grating;
mod lens;
mod lensing;
mod limb;
mod lines;
mod michelson;
mod mie;
mod mirage;
mod near_field;
mod photoelectric;
mod photons;
mod polarization;
mod prism;
mod rainbow;
mod refractive_index;
mod slits;

use crate::laboratory::Experiment;

/// The experiments.
pub const EXPERIMENTS: &[Experiment] = &[
    slits::EXPERIMENT,
    grating::EXPERIMENT,
    aperture::EXPERIMENT,
    near_field::EXPERIMENT,
    michelson::EXPERIMENT,
    film::EXPERIMENT,
    polarization::EXPERIMENT,
    prism::EXPERIMENT,
    lens::EXPERIMENT,
    rainbow::EXPERIMENT,
    mie::EXPERIMENT,
    atmosphere::EXPERIMENT,
    mirage::EXPERIMENT,
    blackbody::EXPERIMENT,
    lines::EXPERIMENT,
    limb::EXPERIMENT,
    photoelectric::EXPERIMENT,
    photons::EXPERIMENT,
    doppler::EXPERIMENT,
    lensing::EXPERIMENT,
];
