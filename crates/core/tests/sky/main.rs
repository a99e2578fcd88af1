//! The sky and the sun against the values of Mitsuba 3.9.1 (`reference.py` writes them), their samples against their
//! densities, and their light by samples against that by quadrature.

use std::f32::consts::{PI, TAU};
use steradian_core::light::{
    Environment,
    sky::{Air, AirDome, AirSun, Atmosphere, Celestial, Contents, SkyDome, SunDisc, SunLook},
};
use steradian_math::{
    Frame, Spectrum, Vec2, Vec3,
    hash::HashRng,
    spectra::{ColorMode, Wavelengths, role::Color},
};
use steradian_testkit::{SphereGrid, chi2_test_within};

fn toward(height: f32, azimuth: f32) -> Vec3 {
    let (h, a) = (height.to_radians(), azimuth.to_radians());
    Vec3::new(h.cos() * a.cos(), h.cos() * a.sin(), h.sin())
}

fn air(mode: ColorMode, turbidity: f32, albedo: f32, height: f32) -> Atmosphere {
    Atmosphere { turbidity, albedo: Color::constant(albedo), up: Vec3::Z, sun: toward(height, 0.0), mode }
}

fn look(limb_darkening: bool) -> SunLook {
    SunLook { aperture: 0.5358, limb_darkening, coarse_rgb: false }
}

fn environment(celestial: Celestial, mode: ColorMode) -> Environment {
    let (image, portal) = (None, None);
    Environment { radiance: Color::BLACK, scale: 1.0, image, celestial: Some(celestial), portal, mode }
}

const LAMBDA: [f32; 8] = [330.0, 400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0];

/// All agree but for what is said in the arms: Mitsuba interpolates a table of the even sun's irradiance.
#[test]
fn radiances_are_those_of_mitsuba() {
    let mut seen = [0; 3];
    for line in include_str!("mitsuba.txt").lines() {
        let (words, numbers): (Vec<&str>, Vec<&str>) =
            line.split_whitespace().partition(|w| w.starts_with(char::is_alphabetic));
        let n: Vec<f32> = numbers.iter().map(|v| v.parse().unwrap()).collect();
        let mode = if words[1] == "rgb" { ColorMode::Rgb } else { ColorMode::Spectral };
        let air = air(mode, n[0], n[1], n[2]);
        let sun = |limb_darkening| SunLook { coarse_rgb: true, ..look(limb_darkening) };
        let (light, tolerance, kind) = match words[0] {
            "sky" => (Celestial::Sky(Box::new(SkyDome::new(&air))), 0.003, 0),
            "even" => (Celestial::Sun(Box::new(SunDisc::new(&air, &sun(false)))), 0.02, 1),
            _ => (Celestial::Sun(Box::new(SunDisc::new(&air, &sun(true)))), 0.003, 2),
        };
        seen[kind] += 1;
        let (environment, w) = (environment(light, mode), toward(n[3], n[4]));
        let at = |lambda: &Wavelengths| environment.radiance(Vec3::ZERO, w, lambda).to_array();
        let found: Vec<f32> = match mode {
            ColorMode::Rgb => at(&Wavelengths::RGB)[..3].to_vec(),
            ColorMode::Spectral => {
                LAMBDA.chunks(4).flat_map(|l| at(&Wavelengths::at([l[0], l[1], l[2], l[3]]))).collect()
            }
        };
        let greatest = n[5..].iter().fold(0.0_f32, |m, v| m.max(*v));
        for (found, given) in found.iter().zip(&n[5..]) {
            let error = (found - given.max(0.0)).abs();
            assert!(error <= tolerance * given.abs().max(0.1 * greatest), "{line}: {found} for {given}");
        }
    }
    assert_eq!(seen, [480, 40, 120]);
}

/// In the two modes the sky has the same colour within what the published fits differ by, and the sun exactly.
#[test]
fn modes_agree() {
    for (turbidity, height) in [(2.0, 10.0), (3.0, 40.0), (8.0, 70.0)] {
        let rgb_of = |light: Celestial, w: Vec3| {
            let mut sum = Vec3::ZERO;
            let e = environment(light, ColorMode::Spectral);
            for k in 0..400 {
                let lambda = Wavelengths::sample_visible((k as f32 + 0.5) / 400.0);
                sum += lambda.to_xyz(e.radiance(Vec3::ZERO, w, &lambda)) / 400.0;
            }
            (steradian_math::color::space::REC709.rgb_from_xyz() * sum.as_dvec3()).as_vec3()
        };
        let check = |tolerance: f32, w: Vec3, make: &dyn Fn(&Atmosphere) -> Celestial| {
            let spectral = rgb_of(make(&air(ColorMode::Spectral, turbidity, 0.3, height)), w);
            let rgb = environment(make(&air(ColorMode::Rgb, turbidity, 0.3, height)), ColorMode::Rgb);
            let rgb = Vec3::from(rgb.radiance(Vec3::ZERO, w, &Wavelengths::RGB).to_rgb());
            let error = (spectral - rgb).abs().max_element() / rgb.max_element();
            assert!(error < tolerance, "{turbidity} {height}: {spectral} {rgb}");
        };
        check(0.06, toward(50.0, 100.0), &|air| Celestial::Sky(Box::new(SkyDome::new(air))));
        check(0.003, toward(height + 0.1, 0.0), &|air| Celestial::Sun(Box::new(SunDisc::new(air, &look(true)))));
    }
}

/// The χ² test of a light's samples: as directions in the frame of `z`, drawn apart to all of the sphere where the
/// light is within a cone of the given `1 − cos`.
fn assert_samples_follow(name: &str, light: &Environment, z: Vec3, one_minus_cos: f32) {
    const SAMPLES: u64 = 200_000;
    let (grid, frame, k) = (SphereGrid { bands: 16, sectors: 16 }, Frame::from_z(z), one_minus_cos / 2.0);
    let (mut rng, mut counts) = (HashRng::new(17), vec![0; grid.cells()]);
    let with_z = |d: Vec3, z: f32| (d.truncate().normalize_or_zero() * (1.0 - z * z).max(0.0).sqrt()).extend(z);
    for _ in 0..SAMPLES {
        let (w, pdf) = light.sample(Vec3::ZERO, Vec2::new(rng.next_f32(), rng.next_f32())).unwrap();
        assert!(pdf > 0.0 && w.is_normalized(), "{name}: {w} {pdf}");
        let d = frame.to_local(w);
        counts[grid.cell(with_z(d, 1.0 - 0.5 * (w - z).length_squared() / k))] += 1;
    }
    let density = |d: Vec3| {
        let w = with_z(d, 1.0 - (1.0 - d.z) * k);
        f64::from(light.pdf(Vec3::ZERO, frame.to_world(w)) * k)
    };
    let expected = grid.expected_counts(density, &counts, SAMPLES);
    let total = expected.iter().sum::<f64>() / SAMPLES as f64;
    assert!((total - 1.0).abs() < 2e-3, "{name}: the density integrates to {total}");
    let chi2 = chi2_test_within(&counts, &expected, SAMPLES, 1e-3);
    assert!(chi2.p_value > 1e-4 && chi2.degrees > 20, "{name}: {chi2:?}");
}

/// Samples of the sky and of the sun follow their densities.
#[test]
fn samples_follow_their_densities() {
    let turn = Frame::from_z(Vec3::new(0.48, -0.6, 0.64));
    for (turbidity, height) in [(1.0, 3.0), (3.0, 40.0), (9.0, 88.0), (3.0, 90.0)] {
        let straight = air(ColorMode::Spectral, turbidity, 0.3, height);
        let air = Atmosphere { up: turn.z, sun: turn.to_world(straight.sun), ..straight };
        let sky = environment(Celestial::Sky(Box::new(SkyDome::new(&air))), ColorMode::Spectral);
        assert_samples_follow(&format!("sky {turbidity} {height}"), &sky, air.up, 2.0);
        for aperture in [0.5358_f32, 20.0] {
            let disc = SunDisc::new(&air, &SunLook { aperture, ..look(true) });
            let sun = environment(Celestial::Sun(Box::new(disc)), ColorMode::Spectral);
            // A little more than the disc, so that its edge is seen.
            let cone = 1.2 * (1.0 - f64::from(0.5 * aperture).to_radians().cos()) as f32;
            assert_samples_follow(&format!("sun {aperture}"), &sun, air.sun, cone);
        }
    }
}

/// The irradiance of the ground by samples is that by quadrature, of sky and sun.
#[test]
fn light_by_samples_and_by_quadrature() {
    let up = |s: Spectrum| s.to_rgb()[1];
    for (turbidity, height) in [(1.0, 5.0), (3.0, 30.0), (7.0, 85.0)] {
        let air = air(ColorMode::Rgb, turbidity, 0.3, height);
        let by_samples = |e: &Environment| {
            let (mut rng, mut sum, n) = (HashRng::new(3), 0.0_f64, 200_000);
            for _ in 0..n {
                let (w, pdf) = e.sample(Vec3::ZERO, Vec2::new(rng.next_f32(), rng.next_f32())).unwrap();
                assert!((e.pdf(Vec3::ZERO, w) / pdf - 1.0).abs() < 0.6, "{w}");
                sum += f64::from(up(e.radiance(Vec3::ZERO, w, &Wavelengths::RGB)) * w.z.max(0.0) / pdf);
            }
            sum / f64::from(n)
        };
        let sky = environment(Celestial::Sky(Box::new(SkyDome::new(&air))), ColorMode::Rgb);
        let mut sum = 0.0_f64;
        let (nx, ny) = (1024, 1024);
        for k in 0..nx * ny {
            let (phi, cos2) = ((k % nx) as f32 + 0.5, ((k / nx) as f32 + 0.5) / ny as f32);
            let (phi, z) = (phi / nx as f32 * TAU, cos2.sqrt());
            let w = Vec3::new((1.0 - cos2).sqrt() * phi.cos(), (1.0 - cos2).sqrt() * phi.sin(), z);
            sum += f64::from(up(sky.radiance(Vec3::ZERO, w, &Wavelengths::RGB)) * PI) / f64::from(nx * ny);
        }
        let sampled = by_samples(&sky);
        assert!((sampled / sum - 1.0).abs() < 0.003, "sky {turbidity} {height}: {sampled} {sum}");

        // Rings of the disc by Gauss's midpoints over the angle from its middle, whose cosine with the ground is the
        // same as of the middle in the mean over a ring.
        let sun = environment(Celestial::Sun(Box::new(SunDisc::new(&air, &look(true)))), ColorMode::Rgb);
        let (frame, half) = (Frame::from_z(air.sun), 0.2679_f32.to_radians());
        let mut sum = 0.0_f64;
        for k in 0..256 * 64 {
            let (gamma, phi) = (((k / 64) as f32 + 0.5) / 256.0 * half, ((k % 64) as f32 + 0.5) / 64.0 * TAU);
            let w = frame.to_world(Vec3::new(gamma.sin() * phi.cos(), gamma.sin() * phi.sin(), gamma.cos()));
            let solid_angle = gamma.sin() * half / 256.0 * TAU / 64.0;
            sum += f64::from(up(sun.radiance(Vec3::ZERO, w, &Wavelengths::RGB)) * w.z * solid_angle);
        }
        let sampled = by_samples(&sun);
        assert!((sampled / sum - 1.0).abs() < 0.003, "sun {turbidity} {height}: {sampled} {sum}");
        // The even disc and discs of other sizes give as much.
        for other in [look(false), SunLook { aperture: 2.0, ..look(false) }] {
            let other = by_samples(&environment(Celestial::Sun(Box::new(SunDisc::new(&air, &other))), ColorMode::Rgb));
            assert!((other / sum - 1.0).abs() < 0.01, "{turbidity} {height}: {other} {sum}");
        }
    }
}

/// Nothing shines from below the horizon, nor anything where the sun is below it.
#[test]
fn nights_and_the_ground_are_black() {
    for height in [-30.0, -0.3, 0.1] {
        let air = air(ColorMode::Rgb, 3.0, 0.3, height);
        for light in
            [Celestial::Sky(Box::new(SkyDome::new(&air))), Celestial::Sun(Box::new(SunDisc::new(&air, &look(true))))]
        {
            let e = environment(light, ColorMode::Rgb);
            let is_lit = |h: f32| !e.radiance(Vec3::ZERO, toward(h, 0.0), &Wavelengths::RGB).is_black();
            assert!(!is_lit(-0.01) && !is_lit(-45.0));
            assert_eq!(is_lit(0.15), height > 0.0);
            assert_eq!(e.sampled_irradiance() > 0.0, height > 0.0);
        }
    }
}

/// Simulated air with the sun at a height, turned so that `up` is up.
fn simulated(mode: ColorMode, altitude: f32, height: f32, up: Vec3) -> Air {
    let sun = Frame::from_z(up).to_world(toward(height, 30.0));
    Air { contents: Contents::CLEAR, albedo: Color::constant(0.3), altitude, multiple: true, up, sun, mode }
}

/// Samples of simulated air follow their densities, by day, in twilight and from above; so do those of its sun.
#[test]
fn samples_of_air_follow_their_densities() {
    let up = Vec3::new(0.48, -0.6, 0.64);
    for (altitude, height) in [(0.0, 40.0), (0.0, -4.0), (20_000.0, 10.0), (0.0, 90.0)] {
        let air = simulated(ColorMode::Spectral, altitude, height, up);
        let sky = environment(Celestial::Air(Box::new(AirDome::new(&air))), air.mode);
        assert_samples_follow(&format!("air {altitude} {height}"), &sky, air.up, 2.0);
        if let Some(disc) = AirSun::new(&air, 0.5358, true) {
            let sun = environment(Celestial::AirSun(Box::new(disc)), air.mode);
            assert_samples_follow("sun", &sun, air.sun, 1.2 * (1.0 - 0.2679_f64.to_radians().cos()) as f32);
        }
    }
}

/// In the two modes air has the same colours but for what is negative in RGB, and of its light as much is found by
/// samples as there is.
#[test]
fn modes_of_air_agree() {
    for height in [50.0, 2.0, -5.0] {
        let of = |mode| {
            let air = simulated(mode, 0.0, height, Vec3::Z);
            let dome = environment(Celestial::Air(Box::new(AirDome::new(&air))), mode);
            (dome, AirSun::new(&air, 0.5358, true).map(|s| environment(Celestial::AirSun(Box::new(s)), mode)))
        };
        let ((sky, sun), (sky_rgb, sun_rgb)) = (of(ColorMode::Spectral), of(ColorMode::Rgb));
        let check = |spectral: &Environment, rgb: &Environment, w: Vec3| {
            let mut sum = Vec3::ZERO;
            for k in 0..400 {
                let lambda = Wavelengths::sample_visible((k as f32 + 0.5) / 400.0);
                sum += lambda.to_xyz(spectral.radiance(Vec3::ZERO, w, &lambda)) / 400.0;
            }
            let found =
                (steradian_math::color::space::REC709.rgb_from_xyz() * sum.as_dvec3()).as_vec3().max(Vec3::ZERO);
            let rgb = Vec3::from(rgb.radiance(Vec3::ZERO, w, &Wavelengths::RGB).to_rgb());
            let error = (found - rgb).abs().max_element() / rgb.max_element();
            assert!(error < 0.01, "{height} {w}: {found} {rgb}");
        };
        for w in [toward(80.0, 10.0), toward(20.0, 100.0), toward(2.0, 31.0)] {
            check(&sky, &sky_rgb, w);
        }
        if let (Some(sun), Some(sun_rgb)) = (&sun, &sun_rgb) {
            check(sun, sun_rgb, toward(height + 0.1, 30.0));
        }
        let fluence = |e: &Environment| e.celestial.as_ref().unwrap().fluence();
        assert!((fluence(&sky) / fluence(&sky_rgb) - 1.0).abs() < 1e-5);
        let (mut rng, mut sum) = (HashRng::new(5), 0.0_f64);
        for _ in 0..20_000 {
            let (w, pdf) = sky_rgb.sample(Vec3::ZERO, Vec2::new(rng.next_f32(), rng.next_f32())).unwrap();
            let rgb = Vec3::from(sky_rgb.radiance(Vec3::ZERO, w, &Wavelengths::RGB).to_rgb());
            sum += f64::from(steradian_math::color::luminance(rgb) / pdf) / 20_000.0;
        }
        let all = f64::from(fluence(&sky_rgb));
        assert!((sum / all - 1.0).abs() < 0.02, "{height}: {sum} {all}");
    }
}
