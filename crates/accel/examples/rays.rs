//! Prints build time and rays per second on a displaced sphere of about a million triangles, and on instances of a small one.
//!
//! `cargo run --release -p steradian-accel --example rays [subdivisions] [level]`
#![allow(clippy::print_stdout)]

use std::time::Instant;
use steradian_accel::{Bvh, Geometry, Instance, Isa, TopLevel};
use steradian_math::{DVec3, Ray, Transform, Vec3, hash::HashRng};

fn main() {
    let mut args = std::env::args().skip(1);
    let n: u32 = args.next().and_then(|a| a.parse().ok()).unwrap_or(708);
    let level = args.next();
    let isas: Vec<Isa> = Isa::ALL
        .into_iter()
        .filter(|isa| isa.is_supported() && level.as_ref().is_none_or(|l| format!("{isa:?}").eq_ignore_ascii_case(l)))
        .collect();

    let (positions, indices) = sphere(n);
    let geometry = [Geometry::triangles(&positions, &indices)];
    let start = Instant::now();
    let Ok(bvh) = Bvh::build(&geometry) else { return };
    println!(
        "{} triangles: built in {:.3} s with {} threads, {:.1} MB",
        indices.len(),
        start.elapsed().as_secs_f64(),
        rayon::current_num_threads(),
        bvh.bytes() as f64 / 1e6
    );
    let sets = ray_sets(&bvh);
    for &isa in &isas {
        let bvh = bvh.clone().with_isa(isa);
        for (name, rays) in &sets {
            measure(isa, name, rays, |r| bvh.intersect(r, &()).map(|h| h.t), |r| bvh.occluded(r, &()));
        }
    }

    let (positions, indices) = sphere(71);
    let Ok(object) = Bvh::build(&[Geometry::triangles(&positions, &indices)]) else { return };
    let places: Vec<Instance> = (0..1000)
        .filter_map(|i| {
            let at = DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)) - 4.5;
            let rotation = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), f64::from(i));
            let m = Transform::translate(at / 4.5) * rotation * Transform::scale(DVec3::splat(0.1));
            Some(Instance { object: 0, world_from_object: m.affine()? })
        })
        .collect();
    let Ok(scene) = TopLevel::build(&[], vec![object], &places) else { return };
    for &isa in &isas {
        let scene = scene.clone().with_isa(isa);
        let rays = primary(Vec3::new(0.3, 0.5, -4.0), 0.7);
        measure(isa, "instances primary", &rays, |r| scene.intersect(r, &()).map(|h| h.t), |r| scene.occluded(r, &()));
        let rays = bounces(&rays, |r| scene.intersect(r, &()).map(|h| h.t));
        measure(isa, "instances bounce", &rays, |r| scene.intersect(r, &()).map(|h| h.t), |r| scene.occluded(r, &()));
    }
}

/// A sphere of `2 n (n − 1)` triangles with bumps.
fn sphere(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    use std::f32::consts::{PI, TAU};
    let positions = (0..=n).flat_map(|i| {
        (0..n).map(move |j| {
            let (theta, phi) = (PI * i as f32 / n as f32, TAU * j as f32 / n as f32);
            let bump =
                (9.0 * theta).sin() * (7.0 * phi).sin() * 0.05 + (61.0 * theta).sin() * (53.0 * phi).sin() * 0.01;
            Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()) * (1.0 + bump)
        })
    });
    let indices = (0..n).flat_map(|i| {
        (0..n).flat_map(move |j| {
            let (a, b) = (i * n + j, i * n + (j + 1) % n);
            let upper = (i > 0).then_some([a, b, b + n]);
            let lower = (i < n - 1).then_some([a, b + n, a + n]);
            upper.into_iter().chain(lower)
        })
    });
    (positions.collect(), indices.collect())
}

fn ray_sets(bvh: &Bvh) -> Vec<(&'static str, Vec<Ray>)> {
    let nearest = |r: &Ray| bvh.intersect(r, &()).map(|h| h.t);
    let outside = primary(Vec3::new(0.3, 0.5, -2.6), 0.8);
    let inside = primary(Vec3::new(0.1, 0.05, -0.2), 1.5);
    let bounce_outside = bounces(&outside, nearest);
    let bounce_inside = bounces(&inside, nearest);
    let mut shuffled = bounce_inside.clone();
    let mut rng = HashRng::new(7);
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, (rng.next_f32() * (i + 1) as f32) as usize);
    }
    vec![
        ("primary outside", outside),
        ("bounce outside", bounce_outside),
        ("primary inside", inside),
        ("bounce inside", bounce_inside),
        ("shuffled inside", shuffled),
    ]
}

/// A picture's rays from a point towards +z, row by row.
fn primary(origin: Vec3, half_width: f32) -> Vec<Ray> {
    let n = 1024;
    let pixel = |i: i32| (2.0 * i as f32 + 1.0) / n as f32 - 1.0;
    let direction = |x, y| Vec3::new(pixel(x) * half_width, pixel(y) * half_width, 1.0).normalize();
    (0..n).flat_map(|y| (0..n).map(move |x| Ray::new(origin, direction(x, y)))).collect()
}

/// Rays from where others hit (or from where they would pass the origin) in random directions.
fn bounces(rays: &[Ray], nearest: impl Fn(&Ray) -> Option<f32>) -> Vec<Ray> {
    let mut rng = HashRng::new(1);
    let mut from = |r: &Ray| {
        let t = nearest(r)?;
        let d = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0;
        let d = if d.dot(r.direction) > 0.0 { -d } else { d };
        Some(Ray::new(r.at(t * 0.9999), d.normalize_or(Vec3::X)))
    };
    rays.iter().filter_map(&mut from).collect()
}

fn measure(isa: Isa, name: &str, rays: &[Ray], nearest: impl Fn(&Ray) -> Option<f32>, any: impl Fn(&Ray) -> bool) {
    let rate = |f: &dyn Fn() -> usize| {
        let best = (0..3).map(|_| {
            let start = Instant::now();
            let hits = f();
            (start.elapsed().as_secs_f64(), hits)
        });
        let (seconds, hits) = best.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NAN, 0));
        (rays.len() as f64 / seconds / 1e6, 100.0 * hits as f64 / rays.len() as f64)
    };
    let (closest, hits) = rate(&|| rays.iter().filter(|r| nearest(r).is_some()).count());
    let (occluded, _) = rate(&|| rays.iter().filter(|r| any(r)).count());
    println!("{isa:9?} {name:18} closest {closest:6.2} Mrays/s   occluded {occluded:6.2} Mrays/s   hits {hits:5.1} %");
}
