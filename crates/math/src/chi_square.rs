//! Pearson's χ² test of samplers against their densities, for the tests of this crate.

use crate::hash::HashRng;
use crate::{Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// A point of the unit square, uniform and independent: stratified ones would make the test too lenient.
pub fn random_2d(rng: &mut HashRng) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// Fails when counts and expectations differ by more than chance: the Wilson–Hilferty score of χ² must stay below 4
/// (one false alarm in 30 000, and seeds are fixed). Cells that expect fewer than five are pooled.
pub fn assert_fits(name: &str, observed: &[f64], expected: &[f64]) {
    let (mut chi2, mut cells) = (0.0, 0.0);
    let mut pool = (0.0, 0.0);
    let mut add = |o: f64, e: f64| {
        chi2 += (o - e) * (o - e) / e;
        cells += 1.0;
    };
    for (&o, &e) in observed.iter().zip(expected) {
        if e >= 5.0 {
            add(o, e);
        } else {
            pool = (pool.0 + o, pool.1 + e);
        }
    }
    if pool.1 >= 1.0 {
        add(pool.0, pool.1);
    } else {
        assert!(pool.0 <= 10.0, "{name}: {} samples where none are expected", pool.0);
    }
    let dof = cells - 1.0;
    assert!(dof >= 8.0, "{name}: only {dof} degrees of freedom");
    let k = 2.0 / (9.0 * dof);
    let score = ((chi2 / dof).cbrt() - (1.0 - k)) / k.sqrt();
    assert!(score < 4.0, "{name}: chi² = {chi2:.1} for {dof} degrees of freedom (score {score:.1})");
}

/// Integral over a rectangle by the midpoint rule with 12² points.
fn cell_integral(f: &impl Fn(f64, f64) -> f64, x: [f64; 2], y: [f64; 2]) -> f64 {
    const N: usize = 12;
    let h = [(x[1] - x[0]) / N as f64, (y[1] - y[0]) / N as f64];
    let mut sum = 0.0;
    for i in 0..N {
        for j in 0..N {
            sum += f(x[0] + (i as f64 + 0.5) * h[0], y[0] + (j as f64 + 0.5) * h[1]);
        }
    }
    sum * h[0] * h[1]
}

/// Tests points of the rectangle `[0, size.0] × [0, size.1]` on a grid; also that the density integrates to one.
pub fn test_rectangle(
    name: &str,
    size: (f64, f64),
    grid: (usize, usize),
    samples: usize,
    mut sample: impl FnMut(Vec2) -> (f64, f64),
    density: impl Fn(f64, f64) -> f64,
) {
    let (nx, ny) = grid;
    let (hx, hy) = (size.0 / nx as f64, size.1 / ny as f64);
    let mut expected = vec![0.0; nx * ny];
    for (i, e) in expected.iter_mut().enumerate() {
        let (x, y) = ((i % nx) as f64 * hx, (i / nx) as f64 * hy);
        *e = samples as f64 * cell_integral(&density, [x, x + hx], [y, y + hy]);
    }
    let total: f64 = expected.iter().sum::<f64>() / samples as f64;
    assert!((total - 1.0).abs() < 3e-3, "{name}: the density integrates to {total}");

    let mut rng = HashRng::new(0x5eed);
    let mut observed = vec![0.0; nx * ny];
    for _ in 0..samples {
        let (x, y) = sample(random_2d(&mut rng));
        assert!(x >= 0.0 && x <= size.0 && y >= 0.0 && y <= size.1, "{name}: ({x}, {y}) is outside");
        let (i, j) = (((x / hx) as usize).min(nx - 1), ((y / hy) as usize).min(ny - 1));
        observed[j * nx + i] += 1.0;
    }
    assert_fits(name, &observed, &expected);
}

/// Tests unit directions against a density per solid angle, on a grid of the two spherical angles.
pub fn test_sphere(name: &str, samples: usize, mut sample: impl FnMut(Vec2) -> Vec3, pdf: impl Fn(Vec3) -> f64) {
    test_rectangle(
        name,
        (PI, TAU),
        (24, 24),
        samples,
        |u| {
            let d = sample(u).as_dvec3();
            assert!((d.length() - 1.0).abs() < 1e-5, "{name}: {d} is not of unit length");
            (d.z.clamp(-1.0, 1.0).acos(), d.y.atan2(d.x).rem_euclid(TAU))
        },
        |theta, phi| {
            let (s, c) = theta.sin_cos();
            pdf(glam::DVec3::new(s * phi.cos(), s * phi.sin(), c).as_vec3()) * s
        },
    );
}
