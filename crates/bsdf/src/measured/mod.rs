//! Measured reflection: tables of values for pairs of directions.
//!
//! [`MeasuredData`] is what a file holds, in whichever of its formats; [`Measured`] is the scattering of one point. All
//! reflect only. The adaptive parameterisation ([`rgl`]) brings its own sampling, the other tables are sampled through
//! half vectors ([`half_vector`]).

pub mod angles;
pub mod btf;
pub mod half_vector;
pub mod harmonics;
pub mod interpolant;
pub mod merl;
pub mod polarimetric;
pub mod rgl;
mod rusinkiewicz;
pub mod synthetic;
pub mod tensor;

use crate::{
    Bsdf, TransportMode,
    registry::{Case, Model, Visitor},
    scatter::Scatter,
};
pub use angles::AngleTable;
pub use btf::Btf;
pub use merl::Merl;
pub use polarimetric::Polarimetric;
pub use rgl::{Rgl, Wanted};

use self::{half_vector::HalfVectors, harmonics::Harmonics, tensor::TensorFile};
use super::{BsdfEval, BsdfSample, Lobe};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    color::luminance,
    spectra::{ColorMode, Wavelengths, role, role::Role},
};

/// Error in a file of measurements.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasuredError {
    /// It ends too early.
    #[error("it ends in the middle of its data")]
    Truncated,
    /// It is of another kind.
    #[error("it is not {0}")]
    NotThis(&'static str),
    /// Something in it.
    #[error("{0}")]
    Fault(String),
}

#[derive(Clone, Debug)]
enum Table {
    Rgl(Box<Rgl>),
    Polarimetric(Polarimetric),
    Merl(Merl),
    Angles(AngleTable),
    Btf(Btf),
    Harmonics(Harmonics),
}

/// A material's measurements, ready to be looked up.
#[derive(Clone, Debug)]
pub struct MeasuredData {
    table: Table,
    /// Sampling distribution of directions, for tables that have none of their own.
    directions: Option<Box<HalfVectors>>,
}

impl MeasuredData {
    /// Reads a file of any format but a BTF's, whose index needs its pictures.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(bytes: &[u8], wanted: Wanted) -> Result<Self, MeasuredError> {
        // Tensor files tell their kind by their fields: Mueller matrices, or the adaptive parameterisation.
        if TensorFile::is(bytes) {
            let file = TensorFile::read(bytes)?;
            return Ok(if file.get("M").is_some() {
                Self::new(Table::Polarimetric(Polarimetric::read(&file, wanted)?))
            } else {
                Self { table: Table::Rgl(Box::new(Rgl::read(&file, wanted)?)), directions: None }
            });
        }
        // What looks like text is a table of angles; binary of the wrong size deserves the message of MERL's reader.
        let is_text =
            !bytes.is_empty() && bytes.iter().take(512).all(|b| (32..127).contains(b) || b.is_ascii_whitespace());
        match std::str::from_utf8(bytes) {
            Ok(text) if is_text && !Merl::is(bytes) => Ok(Self::new(Table::Angles(AngleTable::read(text)?))),
            _ => Ok(Self::new(Table::Merl(Merl::read(bytes)?))),
        }
    }

    /// A stack of pictures.
    pub fn from_btf(btf: Btf) -> Self {
        Self::new(Table::Btf(btf))
    }

    /// Projection of the material onto spherical harmonics up to a degree.
    #[must_use]
    pub fn projected(&self, degree: usize) -> Self {
        // Undo the cosine, which the projection applies again.
        let f = |wo: Vec3, wi: Vec3| self.rgb(wo, wi) / wi.z.max(1e-6);
        Self::new(Table::Harmonics(Harmonics::project(degree, f)))
    }

    fn new(table: Table) -> Self {
        let mut data = Self { table, directions: None };
        // Fit the density of half vectors to the luminance of the table.
        data.directions = Some(Box::new(HalfVectors::fit(|wo, wi| luminance(data.rgb(wo, wi)))));
        data
    }

    /// True if values are by wavelength rather than by channel.
    fn spectral(&self) -> bool {
        match &self.table {
            Table::Rgl(t) => t.spectral,
            Table::Polarimetric(t) => t.spectral(),
            _ => false,
        }
    }

    /// True if it varies over the surface.
    fn varies(&self) -> bool {
        matches!(self.table, Table::Btf(_))
    }

    /// `f·cosθ_i` in three channels (or at three wavelengths), averaged over the texture.
    fn rgb(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        match &self.table {
            Table::Btf(t) => t.mean(wo, wi) * wi.z,
            _ => {
                // Three wavelengths stand for the channels of spectral tables.
                let lambda = if self.spectral() { [610.0, 550.0, 460.0, 550.0] } else { [0.0, 1.0, 2.0, 2.0] };
                Vec3::from(self.lanes(wo, wi, Vec2::ZERO, lambda).0.to_rgb())
            }
        }
    }

    /// `f·cosθ_i` at wavelengths or of channels 0, 1, 2; and the density where the table knows it.
    #[inline]
    fn lanes(&self, wo: Vec3, wi: Vec3, uv: Vec2, lambda: [f32; 4]) -> (Spectrum, f32) {
        let rgb = |v: Vec3| Spectrum::rgb(v.x, v.y, v.z);
        // Every table but the adaptive one and the projection gives f: multiply by the cosine.
        match &self.table {
            Table::Rgl(t) => t.eval(wo, wi, lambda),
            Table::Polarimetric(t) => (t.eval(wo, wi, lambda) * wi.z, 0.0),
            Table::Merl(t) => (rgb(t.eval(wo, wi) * wi.z), 0.0),
            Table::Angles(t) => (rgb(t.eval(wo, wi) * wi.z), 0.0),
            Table::Btf(t) => (rgb(t.eval(wo, wi, uv) * wi.z), 0.0),
            Table::Harmonics(t) => (rgb(t.eval(wo, wi)), 0.0),
        }
    }
}

/// Scattering by measured values.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    data: &'a MeasuredData,
    /// Wavelengths, nm, in spectral mode.
    lambda: [f32; 4],
    mode: ColorMode,
    uv: Vec2,
}

impl<'a> Measured<'a> {
    /// At a place of the texture, which matters to BTFs only.
    pub fn new(data: &'a MeasuredData, lambda: &Wavelengths, mode: ColorMode, uv: Vec2) -> Self {
        Self { data, lambda: lambda.lambda, mode, uv: if data.varies() { uv } else { Vec2::ZERO } }
    }
}

impl Scatter for Measured<'_> {
    const MODELS: &'static [Model] = &[
        Model::new("measured", "tables of values", both_ways),
        Model::new("measured-one-way", "tables that are not the same backwards", one_way).not_reciprocal(),
    ];

    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> BsdfEval {
        // Opaque: light from below meets nothing.
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return BsdfEval::ZERO;
        }
        let spectral = self.data.spectral() && self.mode == ColorMode::Spectral;
        let lambda = if spectral { self.lambda } else { [0.0, 1.0, 2.0, 2.0] };
        let (mut value, pdf) = self.data.lanes(wo, wi, self.uv, lambda);
        if self.mode == ColorMode::Spectral && !spectral {
            // The colour becomes a spectrum; its lanes are read off at the path's wavelengths.
            let at = Wavelengths::at(self.lambda);
            value = role::texel(Vec3::from(value.to_rgb()), Role::Unbounded, &at, ColorMode::Spectral);
        }
        // Tables without their own sampling take the density of half vectors.
        let pdf = self.data.directions.as_ref().map_or(pdf, |d| d.pdf(wo, wi));
        if !value.is_finite() || !pdf.is_finite() {
            return BsdfEval::ZERO;
        }
        BsdfEval { value, pdf }
    }

    fn sample(&self, wo: Vec3, u: f32, u2: Vec2, _: TransportMode) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        // Half vectors by histogram, or the table's own warp.
        let wi = match (&self.data.table, &self.data.directions) {
            (_, Some(d)) => d.sample(wo, u, u2)?,
            (Table::Rgl(t), _) => t.sample(wo, u2)?,
            _ => return None,
        };
        let e = self.eval(wo, wi, TransportMode::Radiance);
        let lobe = Lobe::REFLECTION.with(Lobe::GLOSSY);
        e.drawn(wi, lobe, 1.0)
    }

    fn albedo_estimate(&self, wo: Vec3) -> Spectrum {
        const DRAWS: [[f32; 3]; 8] = [
            [0.05, 0.1, 0.3],
            [0.2, 0.6, 0.8],
            [0.35, 0.35, 0.05],
            [0.45, 0.85, 0.55],
            [0.55, 0.2, 0.7],
            [0.7, 0.5, 0.2],
            [0.8, 0.75, 0.95],
            [0.95, 0.95, 0.45],
        ];
        let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        // Eight fixed points estimate the albedo by importance sampling.
        let draw = |[u, x, y]: [f32; 3]| {
            self.sample(wo, u, Vec2::new(x, y), TransportMode::Radiance).map_or(Spectrum::ZERO, |s| s.weight)
        };
        let sum = DRAWS.into_iter().map(draw).fold(Spectrum::ZERO, |a, b| a + b);
        (sum / DRAWS.len() as f32).clamp(0.0, 1.0)
    }

    #[inline]
    fn is_reciprocal(&self) -> bool {
        false
    }
}

/// Tables whose lookup or projection treats the two directions differently.
const ONE_WAY: [&str; 3] = ["adaptive", "harmonics", "anisotropic table"];

fn both_ways(visit: &mut Visitor<'_>) {
    tabulated(visit, |name| !ONE_WAY.contains(&name));
}

fn one_way(visit: &mut Visitor<'_>) {
    tabulated(visit, |name| ONE_WAY.contains(&name));
}

fn tabulated(visit: &mut Visitor<'_>, wanted: impl Fn(&str) -> bool) {
    let metal = synthetic::Metal { alpha: 0.4, ..synthetic::METAL };
    for (label, data) in metal.all().iter().flatten().filter(|d| wanted(d.0)) {
        let lambda = Wavelengths::sample_visible(0.2);
        let mut case = |mode| {
            let bsdf = Bsdf::Measured(Measured::new(data, &lambda, mode, Vec2::splat(0.25)));
            visit(Case { label, bsdf, lossless: false });
        };
        case(ColorMode::Rgb);
        // Colours that become spectra do so in the same way for all.
        if *label == "MERL" {
            case(ColorMode::Spectral);
        }
    }
}
