//! Experiments of optics, each with its equation and source in its file.

mod air;
mod aperture;
mod atmosphere;
mod bessel;
mod blackbody;
mod distance;
mod doppler;
mod film;
mod fraunhofer;
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
mod radiosity;
mod rainbow;
mod refractive_index;
mod slits;
mod speed_of_light;

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
    air::EXPERIMENT,
    mirage::EXPERIMENT,
    blackbody::EXPERIMENT,
    lines::EXPERIMENT,
    fraunhofer::EXPERIMENT,
    limb::EXPERIMENT,
    photoelectric::EXPERIMENT,
    photons::EXPERIMENT,
    doppler::EXPERIMENT,
    lensing::EXPERIMENT,
    speed_of_light::EXPERIMENT,
    distance::EXPERIMENT,
    radiosity::EXPERIMENT,
];
