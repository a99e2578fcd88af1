//! Cones and opponent channels of a picture.
//!
//! Cone responses are Hunt, Pointer and Estévez's, scaled so that white (D65) excites all three by one. From them: the
//! achromatic channel `A`, red against green `L − M`, blue against yellow `S − (L + M)/2`, all zero in colour for
//! greys.

use crate::laboratory::{Error, Experiment, Parameter, Picture, Report, Run, Values};
use glam::{DMat3, DVec3};
use steradian_math::color::space::REC709;

pub const EXPERIMENT: Experiment = Experiment {
    name: "cones",
    doc: "what the three cones of the eye receive of a picture, and the opponent channels",
    source: "Estévez 1979; Hunt, The Reproduction of Colour, §36.5",
    parameters: &[Parameter::choice(
        "channel",
        &["all", "l", "m", "s", "achromatic", "red-green", "blue-yellow"],
        "what is drawn: l, m and s side by side, or one; opponent channels in their colours around grey",
    )],
    run: Run::OnPicture(run),
};

/// Cone responses from XYZ, equal for equal energy.
pub(super) fn lms_from_xyz() -> DMat3 {
    DMat3::from_cols_array_2d(&[[0.389_71, 0.688_98, -0.078_68], [-0.229_81, 1.183_40, 0.046_41], [0.0, 0.0, 1.0]])
        .transpose()
}

/// Cone responses from linear Rec.709, white being (1, 1, 1).
pub(super) fn lms_from_rgb() -> DMat3 {
    let m = lms_from_xyz() * REC709.xyz_from_rgb();
    DMat3::from_diagonal((m * DVec3::ONE).recip()) * m
}

/// Achromatic, red–green and blue–yellow.
pub(super) fn opponent(lms: DVec3) -> DVec3 {
    DVec3::new((lms.x + lms.y) / 2.0, lms.x - lms.y, lms.z - (lms.x + lms.y) / 2.0)
}

fn run(values: &Values, picture: &Picture) -> Result<Report, Error> {
    let matrix = lms_from_rgb();
    let lms: Vec<DVec3> = picture.rgb.iter().map(|c| matrix * DVec3::from(c.map(f64::from))).collect();
    let mean = lms.iter().sum::<DVec3>() / lms.len().max(1) as f64;
    let mut report = Report::default();
    for (name, v) in ["mean of L", "mean of M", "mean of S"].into_iter().zip(mean.to_array()) {
        report.quantity(name, v, "");
    }
    for (name, v) in ["mean of A", "mean of R/G", "mean of B/Y"].into_iter().zip(opponent(mean).to_array()) {
        report.quantity(name, v, "");
    }
    let channel = values.choice("channel");
    let grey = |v: f64| [v as f32; 3];
    let signed = |v: f64, up: DVec3| (DVec3::splat(0.5) + (up - 0.5) * v.clamp(-1.0, 1.0)).as_vec3().to_array();
    let show = |lms: DVec3, channel: &str| match channel {
        "l" => grey(lms.x),
        "m" => grey(lms.y),
        "s" => grey(lms.z),
        "achromatic" => grey(opponent(lms).x),
        // Scaled so that the strongest colours of sRGB nearly fill the range.
        "red-green" => signed(opponent(lms).y * 2.5, DVec3::new(1.0, 0.1, 0.3)),
        _ => signed(opponent(lms).z, DVec3::new(0.15, 0.2, 1.0)),
    };
    let (w, h) = (picture.width, picture.height);
    let drawn = if channel == "all" {
        Picture::from_fn(3 * w, h, |x, y| show(lms[y * w + x % w], ["l", "m", "s"][x / w]))
    } else {
        Picture::from_fn(w, h, |x, y| show(lms[y * w + x], channel))
    };
    report.picture = Some(drawn.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M119: greys have no opponent colour; red is red, blue is blue, yellow is not blue.
    #[test]
    fn greys_are_achromatic() {
        let m = lms_from_rgb();
        for v in [0.0, 0.18, 1.0, 7.0] {
            let o = opponent(m * DVec3::splat(v));
            assert!((o - DVec3::new(v, 0.0, 0.0)).length() < 1e-12);
        }
        assert!(opponent(m * DVec3::X).y > 0.05 && opponent(m * DVec3::Y).y < -0.05);
        assert!(opponent(m * DVec3::Z).z > 0.5 && opponent(m * DVec3::new(1.0, 1.0, 0.0)).z < -0.5);
    }
}
