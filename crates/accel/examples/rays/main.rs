//! Prints build times and millions of rays per second, one thread, on a mesh of a million triangles, a small one, and a thousand
//! instances of the small one.
//!
//! `cargo run --release -p steradian-accel --example rays [baseline|avx2|avx512] [BUILDER] [SCENE…] [VIEW…] [RAYS…] [steps]`, where the names are
//! those that are printed; without them everything is measured, on the best level. `steps` counts instead of measuring.
#![allow(clippy::print_stdout)]

mod scene;

use scene::{bounce, displaced_sphere, instances, primary, shadow, shuffled, spots};
use std::time::{Instant, SystemTime, UNIX_EPOCH};
use steradian_accel::{Accel, Builder, Bvh, Error, Geometry, Instance, Isa, Steps, TopLevel};
use steradian_math::{DVec3, Ray};

/// Rays that are handed over at once.
const BATCH: usize = 256;

const SCENES: [&str; 3] = ["mesh_1M", "mesh_10k", "inst_1000x10k"];
const VIEWS: [&str; 2] = ["outside", "inside"];
const SETS: [&str; 5] = ["primary", "bounce1", "bounce1shuf", "bounce2", "shadow"];

/// Whether a name is among the arguments, or none of its kind is.
fn is_wanted(args: &[String], names: &[&str], name: &str) -> bool {
    args.iter().any(|a| a == name) || !args.iter().any(|a| names.contains(&a.as_str()))
}

fn main() -> Result<(), Error> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let chosen = Isa::ALL.into_iter().find(|isa| args.iter().any(|a| format!("{isa:?}").eq_ignore_ascii_case(a)));
    let isa = chosen.unwrap_or(Isa::best());
    for (name, (n, instanced)) in SCENES.into_iter().zip([(289, false), (29, false), (29, true)]) {
        if is_wanted(&args, &SCENES, name) {
            run(name, n, instanced, isa, &args)?;
        }
    }
    Ok(())
}

fn run(name: &str, n: i32, instanced: bool, isa: Isa, args: &[String]) -> Result<(), Error> {
    let builder = Builder::ALL.into_iter().find(|b| args.iter().any(|a| format!("{b:?}").eq_ignore_ascii_case(a)));
    let builder = builder.unwrap_or_default();
    let mesh = displaced_sphere(n);
    let geometry = [Geometry::triangles(&mesh.0, &mesh.1)];
    let (start, cpu) = (Instant::now(), process_seconds());
    let places = if instanced { instances() } else { Vec::new() };
    let top = if instanced {
        let instance = |&world_from_object| Instance { object: 0, world_from_object };
        let instances: Vec<_> = places.iter().map(instance).collect();
        TopLevel::build_by(builder, &[], vec![Bvh::build_by(builder, &geometry)?], &instances)?
    } else {
        TopLevel::build_by(builder, &geometry, Vec::new(), &[])?
    };
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{name}: {} triangles built by {builder:?} in {seconds:.3} s with {} threads, {:.3} s of processor time, {:.1} MB",
        mesh.1.len(),
        rayon::current_num_threads(),
        process_seconds() - cpu,
        top.bytes() as f64 / 1e6
    );
    let top = top.with_isa(isa);
    // The normal stays in object space, as in the measurement of other programs that this one repeats.
    let nearest = |ray: &Ray| {
        let hit = top.intersect(ray, &())?;
        let [a, b, c] = mesh.1[hit.id.prim as usize].map(|i| mesh.0[i as usize]);
        let normal = (b - a).cross(c - a);
        Some((hit.t, normal))
    };
    let views: &[(&str, DVec3, DVec3, f64)] = if instanced {
        &[("outside", DVec3::new(24.0, 15.0, 26.0), DVec3::ZERO, 0.45)]
    } else {
        &[
            ("outside", DVec3::new(1.1, 0.8, 2.2), DVec3::ZERO, 0.42),
            ("inside", DVec3::new(0.1, 0.05, -0.08), DVec3::new(0.5, 0.3, 1.0), 1.0),
        ]
    };
    for &(view, eye, at, tan_half) in views.iter().filter(|(view, ..)| is_wanted(args, &VIEWS, view)) {
        let (light, half) = match (view, instanced) {
            ("inside", _) => (DVec3::new(0.0, 0.3, 0.0), 0.1),
            (_, true) => (DVec3::new(0.0, 40.0, 20.0), 10.0),
            _ => (DVec3::new(0.0, 3.0, 1.0), 0.7),
        };
        let rays = primary(eye, at, tan_half, 1024);
        let first = spots(&rays, nearest);
        let bounced = bounce(&first, 11);
        let second = spots(&bounced, nearest);
        let sets = [rays, bounced.clone(), shuffled(bounced, 12), bounce(&second, 13), shadow(&first, light, half, 14)];
        for (set, rays) in SETS.into_iter().zip(sets).filter(|(set, _)| is_wanted(args, &SETS, set)) {
            let name = format!("{name:13} {set}-{view}");
            if args.iter().any(|a| a == "steps") {
                count(&name, &top, &rays);
            } else {
                measure(&name, isa, &top, &rays);
            }
        }
    }
    Ok(())
}

/// Nodes and blocks that rays visit, and triangles that they test.
fn count(name: &str, top: &TopLevel, rays: &[Ray]) {
    let accel = Accel::Bvh(top.clone());
    let total = |cost: &dyn Fn(&Ray) -> Steps| {
        let (mut steps, mut tests, mut n) = (0, 0, 0);
        for ray in rays.iter().step_by(16) {
            let cost = cost(ray);
            (steps, tests, n) = (steps + cost.steps, tests + cost.tests, n + 1);
        }
        format!("{:.2} steps, {:.2} tests", steps as f64 / f64::from(n), tests as f64 / f64::from(n))
    };
    let closest = total(&|ray| accel.intersect_cost(ray, &()));
    let occluded = total(&|ray| accel.occluded_cost(ray, &()));
    println!("{name:36} closest {closest}   occluded {occluded}");
}

fn measure(name: &str, isa: Isa, top: &TopLevel, rays: &[Ray]) {
    // The clock ticks in milliseconds.
    let repeat = 1_000_000_usize.div_ceil(rays.len().max(1));
    let rate = |f: &mut dyn FnMut() -> (usize, f64)| {
        let mut seconds = f64::INFINITY;
        let mut found = (0, 0.0);
        for _ in 0..5 {
            let start = thread_seconds();
            for _ in 0..repeat {
                found = f();
            }
            seconds = seconds.min(thread_seconds() - start);
        }
        ((repeat * rays.len()) as f64 / seconds / 1e6, found)
    };
    let sum = |(n, sum): (usize, f64), t: f32| (n + 1, sum + f64::from(t));
    let (closest, (hits, t)) =
        rate(&mut || rays.iter().filter_map(|r| Some(top.intersect(r, &())?.t)).fold((0, 0.0), sum));
    let (occluded, _) = rate(&mut || (rays.iter().filter(|r| top.occluded(r, &())).count(), 0.0));
    let mut hits_of = vec![None; BATCH];
    let (batch_closest, _) = rate(&mut || {
        for rays in rays.chunks(BATCH) {
            top.intersect_batch(rays, &(), &mut hits_of[..rays.len()]);
        }
        (0, 0.0)
    });
    let mut flags = vec![false; BATCH];
    let (batch_occluded, _) = rate(&mut || {
        for rays in rays.chunks(BATCH) {
            top.occluded_batch(rays, &(), &mut flags[..rays.len()]);
        }
        (0, 0.0)
    });
    let percent = 100.0 * hits as f64 / rays.len() as f64;
    println!(
        "{name:36} {isa:8?} closest {closest:6.2} batch {batch_closest:6.2}  occluded {occluded:6.2} batch {batch_occluded:6.2}   hits {percent:5.1} %  sum of t {t:.9e}"
    );
}

/// Seconds that this process has run on all processors, where the system tells, in its ticks of a hundredth.
fn process_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(") ").next().unwrap_or_default().split(' ').collect();
    let ticks = |i: usize| fields.get(i).and_then(|x| x.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) * 0.01
}

/// Seconds that this thread has run, where the system tells; else seconds since the epoch.
fn thread_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    match stat.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()) {
        Some(nanoseconds) => nanoseconds * 1e-9,
        None => SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |d| d.as_secs_f64()),
    }
}
