//! `steradian material --geometry` and `--microsurface`: geometry that is measured as if it were a material.

use crate::{
    args::{Color, MaterialArgs},
    diagnostics,
    failure::Failure,
    open,
    terminal::Terminal,
};
use serde::Serialize;
use std::path::{Path, PathBuf};
use steradian::{
    ColorMode, CompileOptions, Inputs, Scene,
    formats::Options,
    instruments::{
        direction,
        goniometer::{self, Bins},
        microsurface::Microsurface,
    },
    specimen,
};

/// Correlation lengths along a side of the random surface.
const LENGTHS: usize = 64;

/// Most times that light is followed from one place of the geometry to the next.
const MAX_EVENTS: u32 = 16;

/// Incident azimuths of the table of a mesh, which may look different from each; degrees.
const AZIMUTHS: [f64; 8] = [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0];

/// A piece of geometry of one material.
pub struct Relief {
    scene: Scene,
    is_isotropic: bool,
    /// The files that it was made of.
    pub inputs: Inputs,
}

/// Reflected light for one direction of incidence.
#[derive(Debug, Serialize)]
pub struct Reading {
    /// Angle from the normal, degrees.
    pub theta: f64,
    /// Part of the light that leaves upwards.
    pub albedo: f64,
    /// Part that does so after it met the geometry once.
    pub single: f64,
}

impl Relief {
    /// The geometry that the command line asks for, if any.
    pub fn asked_for(args: &MaterialArgs, terminal: Terminal) -> Result<Option<Self>, Failure> {
        let bare = match (&args.geometry, args.microsurface) {
            (Some(file), _) => {
                let defines = open::bare(Path::new(file)).into_iter().collect();
                let loaded = steradian::load(file, &Options { defines, ..Options::default() });
                diagnostics::tell(&loaded.diagnostics, terminal);
                if loaded.diagnostics.has_errors() || loaded.desc.shapes.is_empty() {
                    return Err(Failure::bad_input(format!("'{file}' has no geometry to measure")));
                }
                loaded.desc
            }
            (None, Some(alpha)) => specimen::bare(Microsurface::new(alpha, LENGTHS, 1).mesh()),
            (None, None) => return Ok(None),
        };
        let desc = specimen::cover(bare, &args.material, &args.params).map_err(Failure::bad_input)?;
        let mode = if args.scene.color == Color::Spectral { ColorMode::Spectral } else { ColorMode::Rgb };
        let compiled = steradian::compile(&desc, &CompileOptions { mode: Some(mode), ..CompileOptions::default() });
        diagnostics::tell(&compiled.diagnostics, terminal);
        let fault = || Failure::bad_input(format!("the geometry of '{}' has errors", args.material));
        let inputs = Inputs::of(desc.files().chain(compiled.files.iter().map(PathBuf::as_path)));
        Ok(Some(Self { scene: compiled.scene.ok_or_else(fault)?, is_isotropic: args.geometry.is_none(), inputs }))
    }

    /// The share of light from an angle that comes back.
    pub fn read(&self, theta: f64, rays: u32) -> Reading {
        let bins = Bins { rings: 1, sectors: 1 };
        let seen = goniometer::geometry(&self.scene, direction(theta, 0.0), bins, rays, MAX_EVENTS);
        Reading { theta, albedo: seen.albedo, single: seen.single[0] * std::f64::consts::PI }
    }

    /// A table of angles that the material 'measured' reads.
    pub fn table(&self, rays: u32) -> String {
        let azimuths = if self.is_isotropic { &AZIMUTHS[..1] } else { &AZIMUTHS };
        goniometer::geometry_table(&self.scene, azimuths, rays, MAX_EVENTS)
    }
}
