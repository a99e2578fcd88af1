//! The engine under every method: what advances a picture, whoever computes it.
//!
//! Whoever renders sees a [`Session`]: it takes steps, tells how far it is and how much it errs, is cancelled, saved
//! and gone on with. Whoever computes light writes an [`Integrator`], which answers for one camera ray ([`PerPixel`]),
//! or a [`Pass`], which estimates the whole picture ([`Passes`]). Threads, tiles, adaptive sampling, errors, layers,
//! limits of time and saved states are here, once, for all of them.

pub mod adaptive;
mod camera_rays;
mod context;
mod counters;
mod depth;
pub mod dimension;
mod estimate;
mod feature;
mod first_hit;
mod integrator;
mod method;
pub mod partition;
mod passes;
mod pieces;
mod plan;
mod session;
pub mod shadow_catcher;
mod state;
mod state_checks;
mod tiles;

pub use context::PathContext;
pub use counters::{Counters, Stop};
pub use depth::Depth;
pub use estimate::Doubt;
pub use feature::{Feature, Support, specular_material};
pub use first_hit::{Sight, albedo, albedo_of, first_hit};
pub use integrator::{GroupIntegrator, Integrator, OneByOne, PixelSample};
pub use method::{Asked, CameraPaths, Limit, Method, MethodKind, Refusal, local_scene};
pub use passes::{CameraSample, Pass, Passes, Run};
pub use pieces::Indivisible;
pub use plan::{Control, Plan};
pub use session::{History, Session};
pub use tiles::{PerPixel, SCALES, Tiles};

use std::time::Duration;

/// Most paths of which a sample is the mean.
pub const MOST_PATHS: u32 = 4;

/// The error is looked at when there are this many samples per pixel, and then whenever they have grown by a quarter.
const FIRST_LOOK: u32 = 16;

/// CPU time of all threads of this process.
fn cpu_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}
