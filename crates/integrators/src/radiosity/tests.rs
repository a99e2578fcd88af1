//! The solvers on systems made by hand.

use super::{
    form_factor,
    patches::NONE,
    polygon::Polygon,
    shooting::Shooting,
    system::{Solved, System},
};
use glam::{DVec3, DVec4};

const GO_ON: &dyn Fn(usize) -> bool = &|_| true;

/// The six sides of a cube, cut into squares, with albedos that differ; one side emits. It has no visibility to find.
fn cube(pieces: u32) -> System {
    let sides = [
        (DVec3::ZERO, DVec3::X, DVec3::Y),
        (DVec3::Z, DVec3::Y, DVec3::X),
        (DVec3::ZERO, DVec3::Y, DVec3::Z),
        (DVec3::X, DVec3::Z, DVec3::Y),
        (DVec3::ZERO, DVec3::Z, DVec3::X),
        (DVec3::Y, DVec3::X, DVec3::Z),
    ];
    let (mut polygons, mut reflectance, mut sources) = (Vec::new(), Vec::new(), Vec::new());
    for (k, (corner, x, y)) in sides.into_iter().enumerate() {
        let (x, y) = (x / f64::from(pieces), y / f64::from(pieces));
        for i in 0..pieces {
            for j in 0..pieces {
                let a = corner + x * f64::from(i) + y * f64::from(j);
                polygons.push(Polygon::new(&[a, a + x, a + x + y, a + y]));
                let grey = 0.2 + 0.1 * k as f64;
                reflectance.push(DVec4::new(grey, 0.5, 0.8, 0.0));
                sources.push(if k == 1 { DVec4::new(1.0, 2.0, 0.5, 0.0) } else { DVec4::ZERO });
            }
        }
    }
    let row = |a: &Polygon| {
        let of = |(j, b): (usize, &Polygon)| (j as u32, form_factor::exchange(a, b) / a.area());
        polygons.iter().enumerate().map(of).filter(|e| e.1 > 0.0).collect()
    };
    System {
        rows: polygons.iter().map(row).collect(),
        transmittance: vec![DVec4::ZERO; reflectance.len()],
        reflectance,
        sources,
        twins: vec![NONE; polygons.len()],
        areas: polygons.iter().map(|p| p.area()).collect(),
        bands: 1,
    }
}

/// Radiosities of a solution.
fn of(system: &System, solved: &Solved) -> Vec<DVec4> {
    system.radiosity(&solved.irradiance)
}

fn far(a: &[DVec4], b: &[DVec4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f64::max)
}

/// M177, M178, M179: all ways to the solution come to the same, which solves the equation.
#[test]
fn all_solvers_agree() {
    let system = cube(3);
    let direct = system.direct(GO_ON).unwrap();
    assert!(system.residual(&of(&system, &direct)) < 1e-13, "{}", system.residual(&of(&system, &direct)));
    let jacobi = system.jacobi(1e-12, 1000, GO_ON);
    let seidel = system.gauss_seidel(1e-12, 1000, GO_ON);
    assert!(far(&of(&system, &jacobi), &of(&system, &direct)) < 1e-10);
    assert!(far(&of(&system, &seidel), &of(&system, &direct)) < 1e-10);
    assert!(seidel.steps < jacobi.steps, "{} {}", seidel.steps, jacobi.steps);
    let shot = shoot(&system, 1e-9);
    assert!(
        far(&of(&system, &shot), &of(&system, &direct)) < 1e-6,
        "{}",
        far(&of(&system, &shot), &of(&system, &direct))
    );
    // Emission is reflected: more than the sources alone.
    assert!(of(&system, &direct).iter().zip(&system.sources).all(|(b, s)| b.x > s.x && b.y > s.y));
}

fn shoot(system: &System, left: f64) -> Solved {
    let mut shooting = Shooting::new(system);
    let mut before = f64::INFINITY;
    while shooting.left(system) > left {
        shooting.shoot(system, |i| system.rows[i].clone());
        // Unshot light only falls: no patch reflects more than it receives.
        let now = shooting.left(system);
        assert!(now < before, "{now} {before}");
        before = now;
    }
    shooting.solved(system, false)
}

/// M177: `A_i F_ij = A_j F_ji`.
#[test]
fn exchange_is_reciprocal() {
    let system = cube(2);
    let factor = |i: usize, j: u32| system.rows[i].iter().find(|e| e.0 == j).map_or(0.0, |e| e.1);
    for i in 0..system.len() {
        for j in 0..system.len() {
            let (a, b) = (system.areas[i] * factor(i, j as u32), system.areas[j] * factor(j, i as u32));
            assert!((a - b).abs() < 1e-9, "{i} {j}: {a} {b}");
        }
    }
}

/// M178: Jacobi's error falls at least by the largest albedo in each step.
#[test]
fn jacobi_converges_at_the_rate_of_the_largest_albedo() {
    let system = cube(2);
    let exact = of(&system, &system.direct(GO_ON).unwrap());
    let error = |steps: usize| far(&of(&system, &system.jacobi(0.0, steps, GO_ON)), &exact);
    for steps in 1..12 {
        // The bound is in the maximum norm, since rows add up to one.
        assert!(error(steps + 1) <= 0.8 * error(steps) + 1e-12, "{steps}");
    }
}

/// M178: inside a closed sphere of albedo 0.9 whose wall emits 1 everything is 10: `1 / (1 − ρ)`. All points of a
/// sphere see each other with the same form factor, `A_j / A`. After k steps of Jacobi the error is
/// `ρ^(k+1) / (1 − ρ)`.
#[test]
fn a_closed_sphere_is_ten_times_as_bright() {
    let n = 50;
    let system = System {
        rows: vec![(0..n).map(|j| (j, 1.0 / f64::from(n))).collect(); n as usize],
        reflectance: vec![DVec4::splat(0.9); n as usize],
        transmittance: vec![DVec4::ZERO; n as usize],
        sources: vec![DVec4::ONE; n as usize],
        twins: vec![NONE; n as usize],
        areas: vec![1.0; n as usize],
        bands: 1,
    };
    assert!(far(&of(&system, &system.direct(GO_ON).unwrap()), &vec![DVec4::splat(10.0); n as usize]) < 1e-9);
    let sixty = of(&system, &system.jacobi(0.0, 60, GO_ON))[0].x;
    assert!((sixty - (10.0 - 0.9_f64.powi(61) / 0.1)).abs() < 1e-9, "{sixty}");
    assert!(far(&of(&system, &system.gauss_seidel(1e-12, 1000, GO_ON)), &vec![DVec4::splat(10.0); n as usize]) < 1e-9);
    // The ambient term is exact here from the first moment on.
    let ambient = Shooting::new(&system).solved(&system, true);
    assert!((ambient.irradiance[0].x - 10.0).abs() < 1e-9, "{}", ambient.irradiance[0].x);
}

/// A pane that transmits evenly: what is behind it is lit through it.
#[test]
fn light_goes_through_a_pane() {
    // A lamp (0) sees one side of a pane (1) whose other side (2) sees a wall (3).
    let system = System {
        rows: vec![vec![(1, 0.5)], vec![(0, 0.5)], vec![(3, 0.5)], vec![(2, 0.5)]],
        reflectance: [0.0, 0.3, 0.3, 0.6].map(DVec4::splat).to_vec(),
        // Lanes differ by it alone.
        transmittance: [0.0, 1.0, 1.0, 0.0].map(|t| t * DVec4::new(0.4, 0.2, 0.6, 0.4)).to_vec(),
        sources: [1.0, 0.0, 0.0, 0.0].map(DVec4::splat).to_vec(),
        twins: vec![NONE, 2, 1, NONE],
        areas: vec![1.0; 4],
        bands: 1,
    };
    let direct = of(&system, &system.direct(GO_ON).unwrap());
    let seidel = of(&system, &system.gauss_seidel(1e-14, 1000, GO_ON));
    let jacobi = of(&system, &system.jacobi(1e-14, 1000, GO_ON));
    let shot = of(&system, &shoot(&system, 1e-12));
    // H1 = ½, H3 = ½ B2, B2 = 0.4 H1 + 0.3 H2, H2 = ½ B3, B3 = 0.6 H3.
    let wall = system.transmittance[1] * (0.6 * 0.5 * 0.5 / (1.0 - 0.3 * 0.5 * 0.6 * 0.5));
    for b in [&direct, &seidel, &jacobi, &shot] {
        assert!((b[3] - wall).abs().max_element() < 1e-9, "{} {wall}", b[3]);
    }
}

/// Within a white closed sphere light is never lost and there is no solution: a few sweeps tell. Where one part in a
/// thousand is lost there is one.
#[test]
fn sweeps_end_where_no_light_is_lost() {
    let n = 50;
    let system = |albedo: f64| System {
        rows: vec![(0..n).map(|j| (j, 1.0 / f64::from(n))).collect(); n as usize],
        reflectance: vec![DVec4::splat(albedo); n as usize],
        transmittance: vec![DVec4::ZERO; n as usize],
        sources: vec![DVec4::ONE; n as usize],
        twins: vec![NONE; n as usize],
        areas: vec![1.0; n as usize],
        bands: 1,
    };
    for solved in [system(1.0).jacobi(1e-4, 10_000, GO_ON), system(1.0).gauss_seidel(1e-4, 10_000, GO_ON)] {
        assert!(solved.steps < 3 * 8 && solved.residual > 1e-4, "{} {}", solved.steps, solved.residual);
    }
    for solved in [system(0.999).jacobi(1e-11, 100_000, GO_ON), system(0.999).gauss_seidel(1e-11, 100_000, GO_ON)] {
        assert!(far(&of(&system(0.999), &solved), &vec![DVec4::splat(1000.0); n as usize]) < 1e-3);
    }
}
