//! Cartesian, polar and spherical coordinates, and the conventions of axes.
//!
//! `(x, y, z) = r (cos φ sin θ, sin φ sin θ, cos θ)` with θ from +z and φ in [0, 2π). A change of the upward axis is a
//! rotation, a change of handedness a mirror: to swap two coordinates would be both.

use super::{RANGE, drawing, tell2, tell3, vector3};
use crate::laboratory::{Error, Experiment, Marker, Parameter, Report, Run, Values};
use glam::{DMat3, DVec3};
use steradian_math::geometry::{
    Point3, axes,
    coordinates::{Polar, Spherical},
    solid_angle::spherical_jacobian,
    vector::angle_between,
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "coordinates",
    doc: "a point in Cartesian, polar and spherical coordinates, with y up, and in left-handed axes",
    source: "ISO 80000-2:2019, §16",
    parameters: &[
        Parameter::choice("from", &["cartesian", "spherical"], "which coordinates are given"),
        Parameter::number("x", 1.0, RANGE, "", "Cartesian coordinate"),
        Parameter::number("y", 2.0, RANGE, "", "Cartesian coordinate"),
        Parameter::number("z", 2.0, RANGE, "", "Cartesian coordinate"),
        Parameter::number("r", 3.0, (0.0, 1e6), "", "distance from the origin, for from=spherical"),
        Parameter::number("theta", 45.0, (0.0, 180.0), "°", "angle from +z, for from=spherical"),
        Parameter::number("phi", 30.0, (-360.0, 360.0), "°", "azimuth from +x towards +y, for from=spherical"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let p = if values.choice("from") == "spherical" {
        let [theta, phi] = ["theta", "phi"].map(|n| values.number(n).to_radians());
        Spherical { r: values.number("r"), theta, phi }.to_cartesian()
    } else {
        vector3(values, ["x", "y", "z"])
    };
    let mut report = Report::default();
    tell3(&mut report, "Cartesian", p);
    let s = Spherical::from_cartesian(p);
    report.quantity("spherical, r", s.r, "");
    report.quantity("spherical, θ", s.theta.to_degrees(), "°");
    report.quantity("spherical, φ", s.phi.to_degrees(), "°");
    report.quantity("volume per dr dθ dφ, r² sin θ", spherical_jacobian(s.r, s.theta), "");
    let polar = Polar::from_cartesian(p.truncate());
    report.quantity("polar of (x, y), r", polar.r, "");
    tell2(&mut report, "back from polar", polar.to_cartesian());
    for (name, axis) in [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)] {
        report.quantity(format!("angle from the {name} axis"), angle_between(p, axis).to_degrees(), "°");
    }
    let maps: [(&str, DMat3); 4] = [
        ("with y up (x, z, −y)", axes::Y_UP_FROM_Z_UP),
        ("with y up (y, z, x)", axes::CYCLE),
        ("with z up, if y was (x, −z, y)", axes::Z_UP_FROM_Y_UP),
        ("left-handed (x, y, −z)", axes::MIRROR_Z),
    ];
    for (name, map) in maps {
        tell3(&mut report, name, map * p);
    }
    let ground = DVec3::new(p.x, p.y, 0.0);
    let arc = |k: u32| Point3::ORIGIN.lerp(Point3::from_vector(p), f64::from(k)).to_vector();
    let chart = drawing::view("a point and its coordinates", s.r.max(1e-3))
        .with(drawing::curve("radius", (0..=1).map(arc)))
        .with(drawing::curve("over the ground", [DVec3::ZERO, ground, p]).drawn(Marker::Dashed))
        .with(drawing::curve("the point", [p]).drawn(Marker::Dots));
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M3–M5: (1, 2, 2) has r = 3, θ = arccos 2/3 = 48.1897°, φ = arctan 2 = 63.4349°, by hand; every quadrant of φ;
    /// the poles; y-up and left-handed forms.
    #[test]
    fn points_have_their_coordinates() {
        let r = run_with(&EXPERIMENT, &[]).unwrap();
        assert!((r.value("spherical, r") - 3.0).abs() < 1e-12);
        assert!((r.value("spherical, θ") - 48.189_685).abs() < 1e-5);
        assert!((r.value("spherical, φ") - 63.434_949).abs() < 1e-5);
        assert!((r.value("volume per dr dθ dφ, r² sin θ") - 9.0 * 5f64.sqrt() / 3.0).abs() < 1e-12);
        let up: Vec<f64> = ["x", "y", "z"].map(|a| r.value(&format!("with y up (x, z, −y), {a}"))).to_vec();
        assert_eq!(up, [1.0, 2.0, -2.0]);
        for (x, y, phi) in
            [("-1", "1", 135.0), ("-1", "-1", 225.0), ("1", "-1", 315.0), ("0", "-2", 270.0), ("0", "0", 0.0)]
        {
            let r = run_with(&EXPERIMENT, &[("x", x), ("y", y), ("z", "0")]).unwrap();
            assert!((r.value("spherical, φ") - phi).abs() < 1e-12, "{x} {y}");
        }
        let pole = run_with(&EXPERIMENT, &[("from", "spherical"), ("theta", "180"), ("r", "2")]).unwrap();
        assert!((pole.value("Cartesian, z") + 2.0).abs() < 1e-12);
        assert!((pole.value("angle from the z axis") - 180.0).abs() < 1e-6);
    }
}
