//! `cargo xtask bench`: the measurements that are asked for, one after the other, and their report.

use crate::{arguments::Bench, loading, raster, rays, report::Report, rivals, scaling, structures};
use std::error::Error;

/// Measures, and writes the report.
pub fn run(arguments: &Bench) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(&arguments.out)?;
    let is_wanted = |part: &str| arguments.only.is_empty() || arguments.only.iter().any(|p| p == part);
    let mut report = Report::default();
    if is_wanted("structures") {
        structures::measure(&arguments.out, arguments.triangles, &mut report)?;
    }
    if is_wanted("scaling") {
        scaling::triangles(&arguments.out, arguments.triangles, &mut report)?;
    }
    if is_wanted("threads") {
        scaling::threads(&arguments.out, arguments.triangles, &mut report)?;
    }
    if is_wanted("loading") {
        loading::measure(&arguments.out, &mut report)?;
    }
    if is_wanted("rays") {
        rays::measure(arguments, &mut report)?;
    }
    if is_wanted("building") {
        rays::builds(arguments, &mut report)?;
    }
    if is_wanted("builders") {
        rays::builders(&mut report)?;
    }
    // Builds another program, with wgpu: only where it is named.
    if arguments.only.iter().any(|part| part == "raster") {
        raster::measure(arguments, &mut report)?;
    }
    if is_wanted("rivals") {
        rivals::measure(arguments, &mut report)?;
    }
    report.write(&arguments.out)
}
