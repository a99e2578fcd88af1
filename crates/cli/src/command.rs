//! The command line: one subcommand for each thing to do.

use crate::{
    args::{
        CompareArgs, ConvertArgs, DenoiseArgs, InfoArgs, ListArgs, MaterialArgs, RenderArgs, SignalArgs, VerifyArgs,
        ViewArgs,
    },
    bake::BakeArgs,
    bench::BenchArgs,
    chunks::{chunk::ChunkArgs, merge::MergeArgs, plan::PlanArgs},
    exercise::ExerciseArgs,
    experiment::ExperimentArgs,
    farm::FarmArgs,
    meter::MeterArgs,
    new::NewArgs,
    pack::PackArgs,
    terminal::Talk,
    unwrap::UnwrapArgs,
};
use clap::{Parser, Subcommand};

/// A physically based renderer for pbrt-v4, Mitsuba, glTF and USD scenes and for OBJ, PLY and STL models.
#[derive(Debug, Parser)]
#[command(
    name = "steradian",
    version = concat!(env!("CARGO_PKG_VERSION"), env!("STERADIAN_COMMIT")),
    about,
    propagate_version = true,
    subcommand_required = true,
    arg_required_else_help = true
)]
#[command(
    after_help = "Exit codes: 0 done, 1 failed, 2 bad command line or scene, 4 pictures, methods or answers differ \
                  (compare, verify, exercise), 5 undecided (verify), 75 try again (chunk, merge), 130/143 stopped."
)]
pub struct Cli {
    /// Command.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene into pictures; without SCENE, the built-in Cornell box
    Render(Box<RenderArgs>),
    /// Plan a render in chunks that several machines compute
    Plan(Box<PlanArgs>),
    /// Compute chunks of a planned render
    Chunk(ChunkArgs),
    /// Put the chunks of a planned render together: the very bits of one run
    Merge(MergeArgs),
    /// Render in chunks by worker processes of this machine, or write the jobs of an engine that deals them out
    Farm(Box<FarmArgs>),
    /// Pack a scene and all files that it names into one archive, which every command reads
    Pack(PackArgs),
    /// Look at a scene in the browser while it renders, or at finished pictures; by itself, at the built-in Cornell box
    View(ViewArgs),
    /// Render a scene by every integrator that can, and test whether they agree
    Verify(VerifyArgs),
    /// Show what is in a scene and what was approximated or dropped, or what is in a picture
    Info(InfoArgs),
    /// List names: integrators, materials, lights, layers, tone curves, …
    List(ListArgs),
    /// Measure a material: BSDF values, albedo, gloss, polar plot, a rendered ball
    Material(Box<MaterialArgs>),
    /// Measure light at a point: radiance, irradiance, illuminance in lx, luminance in cd/m²
    Meter(Box<MeterArgs>),
    /// Compare two pictures: error metrics, z-test, a picture of the difference
    Compare(CompareArgs),
    /// Convert a picture to another format, or a scene to Steradian's own
    Convert(ConvertArgs),
    /// Remove the noise of a rendered picture
    Denoise(DenoiseArgs),
    /// Bake the normals of a fine mesh into a normal map for a coarse one
    Bake(Box<BakeArgs>),
    /// Give a mesh a texture atlas: charts that do not overlap, with little stretch
    Unwrap(Box<UnwrapArgs>),
    /// Measure the speed of ray queries and acceleration structures
    Bench(BenchArgs),
    /// Compute the spectrum of a picture, and the aliases of a coarser sampling
    Signal(SignalArgs),
    /// Run an experiment of optics: diffraction, interference, prisms, rainbows, thermal light, …
    Optics(Box<ExperimentArgs>),
    /// Run an experiment of vision: chromaticity, cones, colour deficiencies, contrast, glare, …
    Vision(Box<ExperimentArgs>),
    /// Run an experiment of Monte Carlo integration: error against samples, importance, branching, …
    Estimate(Box<ExperimentArgs>),
    /// Compute analytic geometry: lines, planes, conics, surfaces and their curvature, rotations, …
    Geometry(Box<ExperimentArgs>),
    /// Do an exercise of the course in Python or Rust: write its folder, check the answer
    Exercise(ExerciseArgs),
    /// Write a package to begin with: models of one's own in Rust
    New(NewArgs),
    /// Print shell completions
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or that of a command: steradian man render | man -l -
    Man {
        /// The command.
        command: Option<String>,
    },
}

impl Command {
    /// Messages and progress that are asked for.
    pub fn talk(&self) -> Talk {
        match self {
            Self::Render(args) => args.talk,
            Self::Plan(args) => args.render.talk,
            Self::Chunk(args) => args.talk,
            Self::Merge(args) => args.talk,
            Self::Farm(args) => args.plan.render.talk,
            _ => Talk::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use std::path::PathBuf;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn spellings_of_pbrt_are_accepted() {
        let cli =
            Cli::parse_from(["steradian", "render", "a.pbrt", "--nthreads", "3", "--outfile", "x.exr", "--spp", "8"]);
        let Command::Render(args) = cli.command else { panic!("render was asked for") };
        assert_eq!((args.scene_options.threads, args.spp), (3, Some(8)));
        assert_eq!(args.output, [PathBuf::from("x.exr")]);
    }

    #[test]
    fn samples_are_written_alike() {
        let parse = |line: &[&str]| Cli::try_parse_from([&["steradian"], line].concat());
        for line in [&["render", "a.xml"][..], &["verify", "a.xml"], &["material", "diffuse"]] {
            let spp = match parse(&[line, &["--spp", "4k"]].concat()).unwrap().command {
                Command::Render(args) => args.spp,
                Command::Verify(args) => Some(args.spp),
                Command::Material(args) => Some(args.spp),
                _ => None,
            };
            assert_eq!(spp, Some(4000), "{line:?}");
            assert!(parse(&[line, &["--spp", "-1"]].concat()).is_err(), "{line:?}");
        }
        assert!(parse(&["verify", "a.xml", "--spp", "1"]).is_err());
    }

    #[test]
    fn numbers_are_checked() {
        for bad in [
            &["--spp", "0"][..],
            &["--spp", "99999999"],
            &["--threads", "5000"],
            &["--max-depth", "-2"],
            &["--sampler", "sobl"],
            &["--accelerator", "bhv"],
            &["--size", "0x0"],
            &["--color", "cmyk"],
        ] {
            let line = ["steradian", "render"].iter().chain(bad);
            assert!(Cli::try_parse_from(line).is_err(), "{bad:?}");
        }
        for good in [&["--max-depth", "-1"][..], &["--exposure", "-2.5"], &["--time", "1.5s"]] {
            let line = ["steradian", "render"].iter().chain(good);
            assert!(Cli::try_parse_from(line).is_ok(), "{good:?}");
        }
    }
}
