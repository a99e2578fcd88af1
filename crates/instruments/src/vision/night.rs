//! A picture as it looks in dim light: rods take over from cones, colours fade, and everything turns bluish.
//!
//! Scotopic luminance from XYZ, `V = Y (1.33 (1 + (Y + Z)/X) − 1.68)` (Larson, Rushmeier, Piatko 1997, eq. 10), and a
//! bluish grey of `(x, y) = (0.25, 0.25)` in its place (Jensen et al. 2000), mixed by how far light has fallen from
//! 10^0.6 to 0.01 cd/m² (Ferwerda et al. 1996 give these ends of mesopic vision).

use crate::laboratory::{Error, Experiment, Parameter, Picture, Report, Run, Values};
use glam::DVec3;
use steradian_math::color::{space::REC709, xyz::xyz_from_xyy};

pub const EXPERIMENT: Experiment = Experiment {
    name: "night",
    doc: "a picture as it looks in dim light: without colour, bluish, reds dark",
    source: "Larson, Rushmeier, Piatko 1997, eq. 10; Jensen et al. 2000; Ferwerda et al. 1996",
    parameters: &[
        Parameter::number("luminance", 0.01, (1e-6, 1e6), "cd/m²", "to which the eye is adapted"),
        Parameter::number("blue", 1.0, (0.0, 1.0), "", "how bluish what the rods see looks"),
    ],
    run: Run::OnPicture(run),
};

/// Share of the rods: 0 above 10^0.6 cd/m², 1 below 0.01, smooth over the logarithm between.
fn rods(luminance: f64) -> f64 {
    let t = ((0.6 - luminance.log10()) / 2.6).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Scotopic luminance, scaled so that D65 white has its photopic one.
fn scotopic(xyz: DVec3) -> f64 {
    let raw = |c: DVec3| if c.x > 0.0 { c.y * (1.33 * (1.0 + (c.y + c.z) / c.x) - 1.68) } else { 0.0 };
    (raw(xyz) / raw(REC709.white())).max(0.0)
}

fn run(values: &Values, picture: &Picture) -> Result<Report, Error> {
    let share = rods(values.number("luminance"));
    let white = REC709.white();
    let blue = xyz_from_xyy(0.25, 0.25, 1.0).lerp(white, 1.0 - values.number("blue"));
    let seen = picture.map(|c| {
        let xyz = REC709.xyz_from_rgb() * DVec3::from(c.map(f64::from));
        let rgb = REC709.rgb_from_xyz() * xyz.lerp(blue * scotopic(xyz), share);
        rgb.max(DVec3::ZERO).as_vec3().to_array()
    });
    let mut report = Report::default();
    report.quantity("share of the rods", share, "");
    report.picture = Some(seen.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(rgb: [f32; 3], luminance: &str, blue: &str) -> [f32; 3] {
        let given = [("luminance".to_owned(), luminance.to_owned()), ("blue".to_owned(), blue.to_owned())];
        let picture = Picture { width: 1, height: 1, rgb: vec![rgb] };
        let image = EXPERIMENT.run(&given, Some(&picture)).unwrap().picture.unwrap();
        ["R", "G", "B"].map(|c| image.channel(c).unwrap()[0])
    }

    /// By day nothing changes; at night red is darker than a blue of equal luminance (Purkinje), and without the bluish
    /// tint all is grey.
    #[test]
    fn reds_darken_at_night() {
        let red = [0.5, 0.05, 0.05];
        let day = seen(red, "1000", "1");
        assert!(day.iter().zip(red).all(|(a, b)| (a - b).abs() < 1e-5));
        let luminance = |c: [f32; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        let blue = [0.05, 0.1, luminance(red) / 0.0722 - (0.2126 * 0.05 + 0.7152 * 0.1) / 0.0722];
        assert!((luminance(blue) - luminance(red)).abs() < 1e-6);
        assert!(luminance(seen(red, "0.001", "0")) < 0.5 * luminance(seen(blue, "0.001", "0")));
        let [r, g, b] = seen(red, "0.001", "0");
        assert!((r - g).abs() < 1e-5 && (g - b).abs() < 1e-5);
        assert_eq!(rods(1e-3), 1.0);
        assert_eq!(rods(10.0), 0.0);
    }
}
