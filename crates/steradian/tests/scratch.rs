use std::time::Instant;
fn rss() -> u64 {
    let s = std::fs::read_to_string("/proc/self/status").unwrap();
    let g = |k: &str| {
        s.lines().find_map(|l| l.strip_prefix(k)).unwrap().split_whitespace().next().unwrap().parse::<u64>().unwrap()
    };
    println!("   rss {} MiB peak {} MiB", g("VmRSS:") >> 10, g("VmHWM:") >> 10);
    0
}
#[test]
fn scratch() {
    let path = std::env::var("SCRATCH").unwrap();
    println!(
        "Node {} Shape {} Geometry {} Material {} Light {} Quadric {} ShapeE {} Param {}",
        size_of::<steradian::scene::Node>(),
        size_of::<steradian::scene::Shape>(),
        size_of::<steradian_core::scene::Geometry>(),
        size_of::<steradian_core::material::Material>(),
        size_of::<steradian_core::light::Light>(),
        size_of::<steradian_core::shape::Quadric>(),
        size_of::<steradian_core::scene::Shape>(),
        size_of::<steradian::scene::Param>()
    );
    let t = Instant::now();
    let l = steradian::load(&path, &Default::default());
    println!(
        "load {:?} {} nodes {} shapes {} messages",
        t.elapsed(),
        l.desc.nodes.len(),
        l.desc.shapes.len(),
        l.diagnostics.iter().count()
    );
    rss();
    let t = Instant::now();
    let c = steradian::compile(&l.desc, &Default::default());
    println!("compile {:?} build {:?}", t.elapsed(), c.build_time);
    for d in c.diagnostics.iter().take(3) {
        println!("{d}");
    }
    rss();
    let Some(s) = c.scene else { return };
    let t = Instant::now();
    let _ = steradian::render(&s, &steradian::Quality { spp: Some(1), threads: 1, ..Default::default() });
    println!("render {:?}", t.elapsed());
    rss();
}
