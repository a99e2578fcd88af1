use steradian::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let loaded = load(&a[1], &Default::default());
    for d in loaded.diagnostics.iter() { eprintln!("{d}"); }
    let size = a.get(4).filter(|s| !s.is_empty()).map(|s| { let (w,h)=s.split_once('x').unwrap(); (w.parse().unwrap(),h.parse().unwrap()) });
    let mode = a.get(5).map(|m| if m=="rgb" {ColorMode::Rgb} else {ColorMode::Spectral});
    let c = compile(&loaded.desc, &CompileOptions{size, mode, ..Default::default()});
    for d in c.diagnostics.iter() { eprintln!("{d}"); }
    let scene = c.scene.unwrap();
    let q = Quality{ spp: Some(a[3].parse().unwrap()), integrator: a.get(6).cloned(), seed: a.get(7).map(|s| s.parse().unwrap()), threads: std::env::var("T").map_or(0, |t| t.parse().unwrap()), ..Default::default() };
    let mut s = Session::new(&scene, q.plan(&scene).unwrap());
    s.step(u32::MAX, &Control::default());
    let k = s.counters();
    eprintln!("load {:?} build {:?} wall {:?} cpu {:?} {:?} {:.3} Msamples/cpu-s {:.2} Mrays/cpu-s", loaded.time, c.build_time, s.wall(), s.cpu(), k, k.samples as f64/s.cpu().as_secs_f64()/1e6, k.rays as f64/s.cpu().as_secs_f64()/1e6);
    let img = develop(&scene, &s.film(), &[Layer::Variance]);
    image::write(std::path::Path::new(&a[2]), &img, &Default::default()).unwrap();
    image::write(&std::path::Path::new(&a[2]).with_extension("png"), &img, &Default::default()).unwrap();
}
