//! Lenses against the formulas of optics.

use super::{surface::follow, *};
use steradian_math::{DVec3, hash::HashRng};

fn system(rows: &[[f64; 5]], aperture: Option<f64>, focus: f64, diagonal: f64) -> Result<LensSystem, String> {
    let rows: Vec<LensElement> = rows.iter().map(|r| LensElement::from(*r)).collect();
    LensSystem::new(&rows, Stop::Circle, aperture, focus, diagonal)
}

/// A singlet of index 1.5 and Abbe number 50 with its stop behind it.
fn singlet(radii: [f64; 2], thickness: f64, stop: f64) -> [[f64; 5]; 3] {
    [[radii[0], thickness, 1.5, 20.0, 50.0], [radii[1], 0.0, 1.0, 20.0, 0.0], [0.0, 50.0, 0.0, stop, 0.0]]
}

/// The focal length by products of ray transfer matrices, of rays (height, index times angle).
fn focal_length(rows: &[[f64; 5]]) -> f64 {
    let (mut m, mut before) = ([[1.0, 0.0], [0.0, 1.0]], 1.0);
    let times = |a: [[f64; 2]; 2], m: [[f64; 2]; 2]| -> [[f64; 2]; 2] {
        [0, 1].map(|i| [0, 1].map(|j| a[i][0] * m[0][j] + a[i][1] * m[1][j]))
    };
    for [radius, thickness, eta, ..] in rows {
        let after = if *eta == 0.0 { 1.0 } else { *eta };
        let power = if *radius == 0.0 { 0.0 } else { (after - before) / radius };
        m = times([[1.0, thickness / after], [0.0, 1.0]], times([[1.0, 0.0], [-power, 1.0]], m));
        before = after;
    }
    -1.0 / m[1][0]
}

/// Singlets of all shapes against the lensmaker's equation, the double Gauss against matrices.
#[test]
fn focal_lengths_are_those_of_optics() {
    for (radii, d) in
        [([60.0, -60.0], 0.05), ([40.0, f64::INFINITY], 6.0), ([25.0, 80.0], 4.0), ([f64::INFINITY, -30.0], 5.0)]
    {
        let [a, b] = radii.map(f64::recip);
        let f = 1.0 / (0.5 * (a - b + 0.5 * d / 1.5 * a * b));
        let mut rows = singlet(radii, d, 10.0);
        // The stop clears a surface that bulges away from the film.
        rows[1][1] = 2.0;
        let lens = system(&rows, None, 100.0, 30.0).unwrap();
        let found = lens.cardinal().unwrap().focal_length;
        assert!((found / f - 1.0).abs() < 1e-6, "{radii:?}: {found} for {f}");
    }
    let f = focal_length(&DOUBLE_GAUSS);
    assert!((49.0..51.0).contains(&f), "a lens of 50 mm: {f}");
    let found = system(&DOUBLE_GAUSS, None, 10.0, 43.0).unwrap().cardinal().unwrap().focal_length;
    assert!((found / f - 1.0).abs() < 1e-6, "{found} for {f}");
}

/// A wavelength's focal length is that of its index: the foci of the lines C and F are f/V apart.
#[test]
fn colours_focus_as_the_abbe_number_says() {
    let lens = system(&singlet([60.0, -60.0], 0.01, 10.0), None, 100.0, 30.0).unwrap();
    assert!(lens.is_dispersive());
    let front = lens.surfaces[0].vertex;
    let focus = |nm: f64| {
        let beam = Beam { origin: DVec3::new(1e-3, 0.0, front + 1.0), direction: -DVec3::Z };
        let out = follow(lens.surfaces.iter(), beam, nm, &Stop::Circle).unwrap().0;
        out.origin.z - out.origin.x * out.direction.z / out.direction.x
    };
    // Powers differ by 1/(V f), exactly.
    let power = |nm| 1.0 / (front - focus(nm));
    let spread = power(486.132_7) - power(656.281_6);
    assert!((spread * 60.0 * 50.0 - 1.0).abs() < 1e-3, "{}", spread * 3000.0);
}

/// Spot size of an axial point on the film: root mean square distance from the axis, mm.
fn spot(lens: &LensSystem, distance: f64) -> f64 {
    let front = lens.surfaces[0].vertex;
    let (mut sum, mut n) = (0.0, 0.0);
    for k in 0..400 {
        let height = lens.surfaces[0].rim * (f64::from(k) + 0.5) / 400.0;
        let beam = Beam::between(DVec3::Z * distance, DVec3::new(height, 0.0, front));
        let Some(out) = lens.towards_film(beam) else { continue };
        let x = out.origin.x - out.origin.z * out.direction.x / out.direction.z;
        (sum, n) = (sum + height * x * x, n + height);
    }
    (sum / n).sqrt()
}

#[test]
fn points_at_the_focus_distance_are_sharp() {
    for focus in [0.4, 2.0, 50.0] {
        let [open, stopped] = [17.1, 4.0].map(|d| system(&DOUBLE_GAUSS, Some(d), focus, 43.0).unwrap());
        let sharp = [spot(&open, 1e3 * focus), spot(&stopped, 1e3 * focus)];
        assert!(sharp[0] < 0.015 && sharp[1] < 0.0005, "{focus} m: {sharp:?} mm");
        // The film is where the spot is smallest.
        for by in [-0.05, 0.05] {
            let mut moved = open.clone();
            moved.shift(by);
            assert!(spot(&moved, 1e3 * focus) > sharp[0], "{focus} m, moved by {by}");
        }
    }
    let near = system(&DOUBLE_GAUSS, None, 0.15, 43.0).unwrap_err();
    assert!(near.contains("nearer than 0.19"), "{near}");
}

/// Rays from the middle of the film spread before and behind what is in focus as a thin lens has it: the pupil's radius
/// times |z − s|/s, so that blur is as wide as the aperture.
#[test]
fn blur_is_as_wide_as_the_aperture() {
    let mut rng = HashRng::new(3);
    for stop in [1.0, 2.0, 4.0] {
        // A lens of f = 100 mm that is thin.
        let lens = system(&singlet([100.0, -100.0], 0.2, stop), None, 2.0, 30.0).unwrap();
        let at = 1e-3 * lens.surfaces[0].vertex;
        for z in [1.0, 1.5, 3.0, 6.0] {
            let mut widest = 0.0_f64;
            for _ in 0..4000 {
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                let Some((o, d, _)) = lens.ray(Vec2::ZERO, u, D_LINE) else { continue };
                let p = o.as_dvec3() + d.as_dvec3() * ((z - f64::from(o.z)) / f64::from(d.z));
                widest = widest.max(p.x.hypot(p.y));
            }
            let (s, t) = (2.0 - at, z - at);
            let expected = 0.5e-3 * stop * (t - s).abs() / s;
            assert!((widest / expected - 1.0).abs() < 0.02, "stop {stop} mm, {z} m: {widest} for {expected}");
        }
    }
}

/// The mean of weights at a point of the picture: what a uniform environment of radiance 1 gives the film.
fn irradiance(lens: &LensSystem, window: Vec2) -> f64 {
    const N: u32 = 400;
    let at = |k: u32| (k as f32 + 0.5) / N as f32;
    let weight = |k: u32| lens.ray(window, Vec2::new(at(k % N), at(k / N)), D_LINE).map_or(0.0, |r| f64::from(r.2));
    (0..N * N).map(weight).sum::<f64>() / f64::from(N * N)
}

/// Behind a small stop that nothing else obstructs, a uniform environment falls off by the fourth power of the cosine;
/// a lens that obstructs it falls off more.
#[test]
fn corners_are_darker() {
    let lens = system(&singlet([60.0, -60.0], 0.01, 1.0), None, 100.0, 40.0).unwrap();
    let s = lens.surfaces[2].vertex;
    for x in [0.0, 0.1, 0.2, 0.3] {
        let film = x * lens.image_distance;
        let cos2 = s * s / (s * s + film * film);
        let expected = std::f64::consts::PI * 0.25 / (s * s) * cos2 * cos2;
        let found = irradiance(&lens, Vec2::new(0.6 * x as f32, -0.8 * x as f32));
        assert!((found / expected - 1.0).abs() < 5e-3, "{x}: {found} for {expected}");
    }
    let wide = system(&DOUBLE_GAUSS, None, 100.0, 43.0).unwrap();
    let [middle, half, corner] =
        [0.0, 0.2, 0.42].map(|x: f32| irradiance(&wide, Vec2::X * x) * f64::from(1.0 + x * x).powi(2));
    assert!(half < 0.95 * middle && corner < 0.6 * half && corner > 0.0, "{middle} {half} {corner}");
    // In the middle it is that of the aperture's cone: π sin²θ, with sin θ = 1/(2N) at f/2 of a well corrected lens.
    let number = 0.5 * (middle / std::f64::consts::PI).sqrt().recip();
    assert!((1.9..2.2).contains(&number), "f/{number}");
}

/// Rays that pass lie within the bounds of the pupil.
#[test]
fn pupils_hold_all_that_passes() {
    let mut rng = HashRng::new(9);
    for aperture in [17.1, 3.0] {
        let lens = system(&DOUBLE_GAUSS, Some(aperture), 1.0, 43.0).unwrap();
        let (rear, mut passed, mut outside) = (lens.surfaces.last().unwrap(), 0, 0);
        for _ in 0..200_000 {
            let mut number = || f64::from(rng.next_f32());
            let radius = number() * 21.5;
            let aim = DVec2::new(number() * 2.0 - 1.0, number() * 2.0 - 1.0) * (1.5 * rear.rim);
            let beam = Beam::between(DVec3::X * radius, aim.extend(rear.vertex));
            if lens.towards_scene(beam, D_LINE).is_none() {
                continue;
            }
            let k = (radius / lens.film_radius * INTERVALS as f64) as usize;
            let [x0, x1, y1] = lens.pupils[k].expect("something passes");
            passed += 1;
            outside += u32::from(aim.x < x0 || aim.x > x1 || aim.y.abs() > y1);
        }
        assert!(passed > 500 && outside == 0, "stop {aperture} mm: {outside} of {passed}");
    }
}

/// Refraction at a sphere against Snell's law in angles.
#[test]
fn refraction_is_snells() {
    let row = LensElement::from([30.0, 5.0, 1.6, 20.0, 0.0]);
    let surface = Surface::new(&row, 0.0, Glass::AIR);
    for height in [0.5_f64, 4.0, 9.0] {
        let beam = Beam { origin: DVec3::new(height, 0.0, 10.0), direction: -DVec3::Z };
        let (out, _) = follow([&surface].into_iter(), beam, D_LINE, &Stop::Circle).unwrap();
        // The normal leans by asin(h/R); the ray turns towards the axis by the difference of both angles.
        let incidence = (height / 30.0).asin();
        let turned = incidence - (incidence.sin() / 1.6).asin();
        assert!((-out.direction.x - turned.sin()).abs() < 1e-12, "{height}");
        assert!((out.origin.z - (900.0 - height * height).sqrt() + 30.0).abs() < 1e-12, "{height}");
    }
}

#[test]
fn faulty_lenses_are_refused() {
    let with = |change: fn(&mut [f64; 5])| {
        let mut rows = DOUBLE_GAUSS;
        change(&mut rows[2]);
        system(&rows, None, 10.0, 43.0).unwrap_err()
    };
    assert!(with(|r| r[0] = f64::NAN).contains("row 3"));
    assert!(with(|r| r[1] = -1.0).contains("thickness"));
    assert!(with(|r| r[2] = 0.5).contains("index"));
    assert!(with(|r| r[3] = 0.0).contains("diameter"));
    assert!(with(|r| r[4] = 2.0).contains("Abbe"));
    assert!(system(&[], None, 10.0, 43.0).unwrap_err().contains("rows"));
    let spreading = singlet([-60.0, 60.0], 1.0, 10.0);
    assert!(system(&spreading, None, 10.0, 43.0).unwrap_err().contains("gathers no light"));
    // A stop alone bends nothing.
    assert!(system(&[[0.0, 10.0, 0.0, 5.0, 0.0]], None, 10.0, 43.0).is_err());
}
