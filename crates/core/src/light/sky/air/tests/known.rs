//! Published values of skies, and their dependence on the composition of the air.

use super::{
    super::{AirDome, AirSun},
    *,
};
use crate::light::sky::{Atmosphere, SkyDome, body::CelestialBody};
use steradian_math::{
    Vec2,
    color::luminance,
    spectra::{Wavelengths, photometry},
};

const RGB: Wavelengths = Wavelengths::RGB;

fn rgb(contents: Contents, sun: f64) -> Air {
    Air { mode: ColorMode::Rgb, ..air(contents, sun) }
}

fn colour(dome: &AirDome, w: Vec3) -> Vec3 {
    Vec3::from(dome.radiance(w, &RGB).to_rgb())
}

/// Illuminance of the level ground by the sky, lx.
fn illuminance(dome: &AirDome) -> f64 {
    let n = 64;
    let sum: f64 = (0..n * n)
        .map(|k| {
            let (w, pdf) = dome.sample(Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32);
            f64::from(luminance(colour(dome, w)) * w.z.max(0.0) / pdf)
        })
        .sum();
    photometry::photometric_from_y(sum / f64::from(n * n))
}

/// During a clear evening's civil twilight it falls from 585 to 410 lx to 3.5 to 2 lx, and by the end of astronomical
/// twilight from 0.008 lx at −12° to 6·10⁻⁴ lx (American Meteorological Society, Glossary of Meteorology). Here to a
/// factor of two; at −18° nearly all of it is starlight and airglow, which are not here.
#[test]
fn twilight() {
    let at = |sun: f64| illuminance(&AirDome::new(&rgb(Contents::CLEAR, sun)));
    let (sunset, civil, nautical) = (at(-0.833), at(-6.0), at(-12.0));
    assert!((205.0..1170.0).contains(&sunset), "{sunset}");
    assert!((1.0..7.0).contains(&civil), "{civil}");
    assert!((0.004..0.016).contains(&nautical), "{nautical}");
    assert!(at(-18.0) < 1e-3);
}

/// Ozone is what makes the blue hour blue (Hulburt, "Explanation of the brightness and color of the sky, particularly
/// the twilight sky", 1953): without it the zenith is pale or yellow.
#[test]
fn the_blue_hour() {
    let blueness = |ozone: f64, sun: f64| {
        let c = colour(&AirDome::new(&rgb(Contents { ozone, ..Contents::CLEAR }, sun)), Vec3::Z);
        c.z / c.x
    };
    let (with, without) = (blueness(300.0, -5.0), blueness(0.0, -5.0));
    assert!(with > 1.8 * without && with > 2.0 && without < 1.5, "{with} {without}");
    assert!(blueness(300.0, 50.0) / blueness(0.0, 50.0) < 1.2);
}

/// Direct sunlight of ASTM G173-03 (SMARTS 2.9.2): zenith angle 48.19°, 344 DU of ozone, aerosols of depth 0.084 at 500
/// nm, which has other gases too, little of them at these wavelengths.
#[test]
fn direct_sunlight() {
    let contents = Contents { ozone: 344.0, aerosol: 0.084 * 0.9f64.powf(1.3), ..Contents::CLEAR };
    let air = air(contents, 90.0 - 48.19);
    let sun = AirSun::new(&air, 0.5358, false).unwrap();
    let solid_angle = 2.0 * std::f64::consts::PI * (1.0 - (0.2679f64).to_radians().cos());
    for (nm, published) in [
        (405.0, 0.8811),
        (445.0, 1.1764),
        (505.0, 1.3406),
        (555.0, 1.3563),
        (605.0, 1.3284),
        (675.0, 1.2719),
        (745.0, 1.1286),
        (775.0, 1.0773),
    ] {
        let found = f64::from(sun.radiance(air.sun, &Wavelengths::at([nm; 4])).to_array()[0]) * solid_angle;
        assert!((found / published - 1.0).abs() < 0.015, "{nm}: {found} {published}");
    }
}

/// Beside the model of Hosek and Wilkie at turbidity 3, whose aerosols are others: the zenith within a quarter.
#[test]
fn hosek_and_wilkie() {
    for sun in [30.0, 45.0, 60.0] {
        let air = rgb(Contents::CLEAR, sun);
        let (turbidity, albedo) = (3.0, Color::constant(0.3));
        let other = SkyDome::new(&Atmosphere { turbidity, albedo, up: Vec3::Z, sun: air.sun, mode: ColorMode::Rgb });
        let other = luminance(Vec3::from(other.radiance(Vec3::Z, &RGB).to_rgb()));
        let found = luminance(colour(&AirDome::new(&air), Vec3::Z));
        assert!((found / other - 1.0).abs() < 0.25, "{sun}: {found} {other}");
    }
}

/// The sun low down is red and dim, its lower edge most, and where part of it has set that part is black.
#[test]
fn sunsets() {
    let sun = |height: f64| AirSun::new(&rgb(Contents::CLEAR, height), 0.5358, false);
    let at = |s: &AirSun, height: f64| Vec3::from(s.radiance(toward(height, 0.0), &RGB).to_rgb());
    let (high, low) = (sun(50.0).unwrap(), sun(0.1).unwrap());
    let (top, bottom) = (at(&low, 0.3), at(&low, 0.02));
    let redness = |c: Vec3| c.x / c.y;
    assert!(redness(at(&high, 50.0)) < 1.3 && redness(top) > 2.0 && redness(bottom) > redness(top));
    assert!(luminance(bottom) < 0.8 * luminance(top) && luminance(top) < 0.05 * luminance(at(&high, 50.0)));
    assert!(at(&low, -0.05) == Vec3::ZERO && low.fluence() > 0.0);
    let set = sun(-0.2).unwrap();
    assert!(at(&set, 0.03).x > 0.0 && at(&set, -0.1) == Vec3::ZERO && set.fluence() < 0.1 * low.fluence());
    assert!(sun(-0.3).is_none());
    // From above, the horizon is lower.
    let high_up = Air { altitude: 10_000.0, ..rgb(Contents::CLEAR, -1.0) };
    assert!(AirSun::new(&high_up, 0.5358, true).unwrap().fluence() > 0.0);
}

/// From above there is less air: the zenith is darker, and the sky goes on below the level plane down to the horizon at
/// 3.2° below it.
#[test]
fn from_above() {
    let at = |altitude: f32| AirDome::new(&Air { altitude, ..rgb(Contents::CLEAR, 40.0) });
    let (low, high) = (at(0.0), at(10_000.0));
    assert!(luminance(colour(&high, Vec3::Z)) < 0.4 * luminance(colour(&low, Vec3::Z)));
    assert!(colour(&high, toward(-3.1, 30.0)).y > 0.0 && colour(&high, toward(-3.3, 30.0)) == Vec3::ZERO);
    assert!(colour(&low, toward(0.1, 30.0)).y > 0.0 && colour(&low, toward(-0.1, 30.0)) == Vec3::ZERO);
    assert!(high.pdf(toward(-3.1, 30.0)) > 0.0 && high.pdf(toward(-3.3, 30.0)) == 0.0);
}

/// The table of a dome is what is seen along lines of sight, within a fiftieth.
#[test]
fn directions_between_those_of_the_table() {
    for sun in [40.0f64, 2.0, -4.0] {
        let air = air(Contents::CLEAR, sun);
        let medium = Medium::new(&air.contents, [0.3; BANDS]);
        let (eye, dome) = (Eye::new(&medium, f64::from(air.sun.z), true), AirDome::new(&air));
        for (to, azimuth) in [(0.4, 20.0), (2.3, 77.0), (9.0, 11.0), (31.0, 133.0), (77.0, 40.0)] {
            let exact = seen(&eye, &medium, &way(0.0, sun, to, azimuth));
            for band in [4, 18, 30] {
                let lambda = Wavelengths::at([super::super::data::wavelength(band); 4]);
                let found = dome.radiance(toward(to, azimuth), &lambda).to_array()[0];
                let exact = exact[band] * super::super::data::SUN[band];
                assert!((found / exact - 1.0).abs() < 0.02, "{sun} {to} {azimuth} {band}: {found} {exact}");
            }
        }
    }
}
