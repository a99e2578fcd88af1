//! Weak gravitational lensing by a point mass: light that passes at the distance `b` is deflected by `4GM/(c² b)`
//! (Einstein 1915), so that a source behind the mass is a ring of the angular radius
//! `θ_E = √(4GM/c² · D_LS/(D_L D_S))`. A source at the angle β has two images, `θ = (β ± √(β² + 4θ_E²))/2` (Schneider,
//! Ehlers, Falco, *Gravitational Lenses*, §2.1).

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values};
use steradian_math::spectra::blackbody::SPEED_OF_LIGHT;

pub const EXPERIMENT: Experiment = Experiment {
    name: "lensing",
    doc: "deflection of light by a mass: Einstein's ring, two images, magnification",
    source: "Schneider, Ehlers, Falco, Gravitational Lenses, §2.1",
    parameters: &[
        Parameter::number("mass", 1.0, (1e-12, 1e16), "M☉", "of the lens, in masses of the sun"),
        Parameter::number("lens", 4000.0, (1e-12, 1e11), "pc", "distance of the lens"),
        Parameter::number("source", 8000.0, (1e-12, 1e11), "pc", "distance of the source"),
        Parameter::number("offset", 0.3, (0.0, 100.0), "θ_E", "angle of the source from the lens, in Einstein radii"),
        Parameter::number("size", 0.3, (0.01, 10.0), "θ_E", "radius of the source, in Einstein radii"),
    ],
    run: Run::Alone(run),
};

/// GM of the sun, m³/s² (IAU 2015), its nominal radius and a parsec, m.
const SUN: f64 = 1.327_124_4e20;
const SUN_RADIUS: f64 = 6.957e8;
const PARSEC: f64 = 3.085_677_581_491_367e16;

/// Magnification of a point source at an angle in Einstein radii: Paczyński 1986, eq. 5.
fn magnification(u: f64) -> f64 {
    (u * u + 2.0) / (u * (u * u + 4.0).sqrt())
}

fn run(values: &Values) -> Result<Report, Error> {
    let (lens, source) = (values.number("lens") * PARSEC, values.number("source") * PARSEC);
    if source <= lens {
        return Err(Error::Impossible("the source is not behind the lens: 'source' must exceed 'lens'".into()));
    }
    let schwarzschild = 2.0 * SUN * values.number("mass") / (SPEED_OF_LIGHT * SPEED_OF_LIGHT);
    let ring = (2.0 * schwarzschild * (source - lens) / (lens * source)).sqrt();
    if ring > 0.1 {
        return Err(Error::Impossible(format!(
            "deflection by {ring:.2} rad is not weak: make 'mass' smaller or 'lens' larger"
        )));
    }
    let arcseconds = 180.0 / std::f64::consts::PI * 3600.0;
    let (offset, size) = (values.number("offset"), values.number("size"));
    let mut report = Report::default();
    report.quantity("Einstein radius", ring * arcseconds, "″");
    report.quantity("Einstein radius at the lens", ring * lens, "m");
    report.quantity(
        "deflection at the limb of the sun",
        4.0 * SUN / (SPEED_OF_LIGHT.powi(2) * SUN_RADIUS) * arcseconds,
        "″",
    );
    let root = (offset * offset + 4.0).sqrt();
    report.quantity("outer image", 0.5 * (offset + root), "θ_E");
    report.quantity("inner image", 0.5 * (offset - root), "θ_E");
    if offset > 0.0 {
        report.quantity("magnification of a point", magnification(offset), "");
    }
    // Surface brightness is kept: the picture is the source seen at β = θ − θ/θ².
    const EDGE: usize = 512;
    const FIELD: f64 = 6.0;
    let brightness = |theta: (f64, f64)| -> f64 {
        let r2 = (theta.0 * theta.0 + theta.1 * theta.1).max(1e-12);
        let beta = (theta.0 * (1.0 - 1.0 / r2) - offset, theta.1 * (1.0 - 1.0 / r2));
        f64::from(u8::from(beta.0.hypot(beta.1) < size))
    };
    let mut area = 0.0;
    let pixels: Vec<f64> = (0..EDGE * EDGE)
        .map(|i| {
            let at = |v: usize, k: u32| ((v as f64 + (f64::from(k) + 0.5) / 4.0) / EDGE as f64 - 0.5) * FIELD;
            let sum: f64 = (0..16).map(|k| brightness((at(i % EDGE, k % 4), -at(i / EDGE, k / 4)))).sum();
            area += sum / 16.0 * (FIELD / EDGE as f64).powi(2);
            sum / 16.0
        })
        .collect();
    if offset + size < FIELD / 2.0 - 1.0 {
        report.quantity("magnification of the source, by area", area / (std::f64::consts::PI * size * size), "");
    }
    report.picture = Some(
        Picture::from_fn(EDGE, EDGE, |x, y| {
            let v = pixels[y * EDGE + x] as f32;
            [v, 0.85 * v, 0.6 * v]
        })
        .to_image()?,
    );
    let points = (1..=600).map(|k| f64::from(k) / 200.0).map(|u| (u, magnification(u))).collect();
    report.chart = Some(
        Chart::new(
            "brightness of a star behind a point mass",
            Axis::linear("angle from the lens (Einstein radii)"),
            Axis::log("magnification"),
        )
        .with(Series::line("magnification", points)),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M144: 1.75″ at the sun's limb; for a star of the sun's mass half way to the bulge's 8 kpc a ring of
    /// 0.902 mas √(10 kpc/4 kpc) √(1 − ½) (Paczyński 1996, equation 16); an extended source behind the lens is
    /// magnified by √(1 + 4/ρ²) (Witt, Mao 1994).
    #[test]
    fn rings_and_magnifications() {
        let r = EXPERIMENT
            .run(&[("offset".to_owned(), "0".to_owned()), ("size".to_owned(), "0.5".to_owned())], None)
            .unwrap();
        assert!((r.value("deflection at the limb of the sun") - 1.7512).abs() < 1e-3);
        assert!(
            (r.value("Einstein radius") * 1e3 - 0.902 * 2.5f64.sqrt() * 0.5f64.sqrt()).abs() < 2e-3,
            "{}",
            r.value("Einstein radius")
        );
        assert_eq!((r.value("outer image"), r.value("inner image")), (1.0, -1.0));
        let exact = (1.0f64 + 4.0 / 0.25).sqrt();
        assert!((r.value("magnification of the source, by area") / exact - 1.0).abs() < 2e-3);
        assert!((magnification(1.0) - 3.0 / 5f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_weak_or_not_behind_is_refused() {
        for (name, value) in [("mass", "1e16"), ("source", "100")] {
            let given = [(name.to_owned(), value.to_owned()), ("lens".to_owned(), "1000".to_owned())];
            let given =
                if name == "mass" { [given[0].clone(), ("lens".to_owned(), "0.001".to_owned())] } else { given };
            assert!(EXPERIMENT.run(&given, None).is_err(), "{name}");
        }
    }
}
