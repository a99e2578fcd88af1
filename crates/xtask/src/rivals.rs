//! Other programs on the same scenes, where they are there.

use crate::{
    Bench, generate,
    report::{Report, Table},
    structures::{compile, load},
};
use serde_json::json;
use std::{error::Error, process::Command};
use steradian::{CompileOptions, Control, Quality, Session};

/// Renders a scene with Mitsuba, and prints the CPU and wall seconds of the second of two renders.
const MITSUBA: &str = "\
import sys, time
import drjit as dr, mitsuba as mi
mi.set_variant(sys.argv[2])
scene = mi.load_file(sys.argv[1])
for i in range(2):
    cpu, wall = time.process_time(), time.perf_counter()
    image = mi.render(scene, spp=int(sys.argv[3]), seed=i)
    dr.eval(image); dr.sync_thread()
    spent = time.process_time() - cpu, time.perf_counter() - wall
print(*spent)
";

/// Samples for each pixel.
const SPP: u32 = 32;

/// Measures those that were named.
pub fn measure(bench: &Bench, report: &mut Report) -> Result<(), Box<dyn Error>> {
    if let Some(python) = &bench.mitsuba_python {
        let path = bench.out.join("rivals.xml");
        generate::scene(&path, &generate::bumpy_sphere(100_000), 256)?;
        let mut table = Table::new("The same scene with Mitsuba", &["renderer", "CPU s", "wall s"]);
        let (scene, _) = compile(&load(&path)?, &CompileOptions::default())?;
        let quality = Quality { spp: Some(SPP), sampler: Some("independent".into()), ..Quality::default() };
        let mut session = Session::new(&scene, quality.plan(&scene)?);
        session.step(SPP, &Control::default());
        table.row(vec![json!("Steradian"), json!(session.cpu().as_secs_f64()), json!(session.wall().as_secs_f64())]);
        for variant in ["llvm_ad_rgb", "scalar_rgb"] {
            let run =
                Command::new(python).args(["-c", MITSUBA]).arg(&path).args([variant, &SPP.to_string()]).output()?;
            let printed = String::from_utf8_lossy(&run.stdout).into_owned();
            let seconds: Vec<f64> = printed.split_whitespace().filter_map(|x| x.parse().ok()).collect();
            match seconds[..] {
                [cpu, wall] => table.row(vec![json!(variant), json!(cpu), json!(wall)]),
                _ => eprintln!("{variant} could not be measured: {}", String::from_utf8_lossy(&run.stderr)),
            }
        }
        table.note("Time alone: noise differs between renderers, and decides with it.");
        report.add(table);
    }
    Ok(())
}
