//! The dimensions of a camera sample and of each scattering event. Fixed, so that every number is a function of what it
//! is for.
//!
//! Samples are a pure function of (pixel, sample index, dimension, seed). A camera sample has four dimensions (place on
//! the film, place on the lens, wavelengths, moment of the exposure), each scattering event ten. Where paths share
//! vertices, the numbers from the first bounce on belong to the group rather than to the pixel: they are one point set,
//! of which each member has a block of consecutive points, so that they are stratified for the member and over the
//! pixels about it. The wavelengths and the moment of a sample are common to a layer of groups (`partition`).

/// Place on the film.
pub const FILM: u32 = 0;
/// Place on the lens.
pub const LENS: u32 = 1;
/// Wavelengths.
pub const WAVELENGTH: u32 = 2;
/// Moment of the exposure.
pub const TIME: u32 = 3;
const FIRST_EVENT: u32 = 4;
const PER_EVENT: u32 = 10;
/// Choice of a light.
pub const LIGHT: u32 = 0;
/// Place on the light.
pub const LIGHT_POINT: u32 = 1;
/// Choice of a lobe.
pub const LOBE: u32 = 2;
/// Direction.
pub const DIRECTION: u32 = 3;
/// Russian roulette.
pub const ROULETTE: u32 = 4;
/// Choice in a mixture of materials.
pub const MIXTURE: u32 = 5;
/// Free flight in a medium.
pub const FLIGHT: u32 = 6;
/// Lane by which the flight is drawn.
pub const LANE: u32 = 7;
/// Number of branches.
pub const BRANCHES: u32 = 8;
/// Time for which matter holds light back.
pub const DELAY: u32 = 9;

/// The dimension of a decision at a scattering event.
#[inline]
pub const fn at(event: u32, decision: u32) -> u32 {
    FIRST_EVENT + event.wrapping_mul(PER_EVENT) + decision
}
