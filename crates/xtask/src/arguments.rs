//! Arguments of `cargo xtask bench`.

use std::path::PathBuf;

/// Arguments of `bench`.
#[derive(Debug, clap::Args)]
pub struct Bench {
    /// Folder for results
    #[arg(long, default_value = "target/bench")]
    pub out: PathBuf,
    /// Only these parts: structures, scaling, threads, loading, rays, building, builders, rivals, raster; raster, which
    /// builds a package with wgpu and needs lavapipe, is left out unless named
    #[arg(long, value_delimiter = ',')]
    pub only: Vec<String>,
    /// Largest mesh, in triangles
    #[arg(long, default_value_t = 10_000_000)]
    pub triangles: usize,
    /// A Python that has Mitsuba 3, to render the same scenes with it
    #[arg(long)]
    pub mitsuba_python: Option<PathBuf>,
    /// A scene to render with both, instead of a generated one; may be given several times
    #[arg(long, value_name = "FILE.xml")]
    pub scene: Vec<PathBuf>,
    /// The shared library of Embree 4, to trace the same rays with it
    #[arg(long, value_name = "LIBRARY")]
    pub embree: Option<PathBuf>,
    /// One more mesh to trace rays through, or to rasterize; may be given several times
    #[arg(long, value_name = "FILE.ply")]
    pub mesh: Vec<PathBuf>,
    /// Only rays whose scene, name or query has each of these words, such as mesh_10k,bounce1,closest
    #[arg(long, value_name = "WORD", value_delimiter = ',')]
    pub rays: Vec<String>,
}
