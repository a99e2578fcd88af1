//! Pictures as people with a colour vision deficiency see them.
//!
//! A dichromat lacks a kind of cones, and colours that differ in that cone's response alone look equal. Which of them
//! is seen is known from people with one such eye: greys stay, and for protanopes and deuteranopes so do 475 and 575
//! nm, for tritanopes 485 and 660 nm. Brettel, Viénot and Mollon 1997 project along the missing cone's axis on two
//! half-planes through white and these; Viénot, Brettel and Mollon 1999 on one plane through white, blue and yellow of
//! the display. Machado, Oliveira and Fernandes 2009 shift the spectral sensitivity of anomalous cones, so that
//! severities between are theirs; for the other two they are mixed linearly.

use super::{cones::lms_from_rgb, machado};
use crate::laboratory::{Error, Experiment, Parameter, Picture, Report, Run, Values};
use glam::DVec3;
use steradian_math::{color::space::REC709, spectra::cie};

pub const EXPERIMENT: Experiment = Experiment {
    name: "deficiency",
    doc: "a picture as it looks with protanopia, deuteranopia, tritanopia or an anomalous form of them",
    source: "Brettel, Viénot, Mollon 1997; Viénot, Brettel, Mollon 1999; Machado, Oliveira, Fernandes 2009",
    parameters: &[
        Parameter::choice("kind", &["deuteranopia", "protanopia", "tritanopia"], "which cones are missing: M, L or S"),
        Parameter::choice("model", &["brettel", "vienot", "machado"], "whose; vienot has no tritanopia"),
        Parameter::number("severity", 1.0, (0.0, 1.0), "", "1: the cones are missing; less: they are anomalous"),
    ],
    run: Run::OnPicture(run),
};

/// The plane through the origin and two colours that replaces the response of a missing cone.
fn on_plane(lms: DVec3, cone: usize, a: DVec3, b: DVec3) -> DVec3 {
    let normal = a.cross(b);
    let mut seen = lms;
    seen[cone] = 0.0;
    seen[cone] = -normal.dot(seen) / normal[cone];
    seen
}

/// Cone responses of light of one wavelength.
fn anchor(nm: f64) -> DVec3 {
    lms_from_rgb() * (REC709.rgb_from_xyz() * DVec3::from(cie::matching_linear(nm)))
}

/// Cone responses of a dichromat: Brettel's two half-planes, or Viénot's one.
fn dichromat(lms: DVec3, cone: usize, model: &str) -> DVec3 {
    let white = DVec3::ONE;
    if model == "vienot" {
        return on_plane(lms, cone, white, lms_from_rgb() * DVec3::Z);
    }
    let (short, long) = if cone == 2 { (485.0, 660.0) } else { (475.0, 575.0) };
    // The half-plane is chosen by the side of white, seen along the missing cone's axis, on which the colour lies.
    let (u, v) = ((cone + 1) % 3, (cone + 2) % 3);
    let side = |c: DVec3| c[u] * white[v] - c[v] * white[u];
    let (short, long) = (anchor(short), anchor(long));
    let near = if side(lms) * side(short) > 0.0 { short } else { long };
    on_plane(lms, cone, white, near)
}

fn run(values: &Values, picture: &Picture) -> Result<Report, Error> {
    let cone = match values.choice("kind") {
        "protanopia" => 0,
        "deuteranopia" => 1,
        _ => 2,
    };
    let (model, severity) = (values.choice("model"), values.number("severity"));
    if model == "vienot" && cone == 2 {
        return Err(Error::Impossible("model 'vienot' has no tritanopia: take 'brettel' or 'machado'".into()));
    }
    let to_lms = lms_from_rgb();
    let to_rgb = to_lms.inverse();
    let mut out_of_gamut = 0;
    let seen = picture.map(|c| {
        let rgb = DVec3::from(c.map(f64::from));
        let seen = if model == "machado" {
            machado::simulate(cone, severity, rgb)
        } else {
            rgb.lerp(to_rgb * dichromat(to_lms * rgb, cone, model), severity)
        };
        out_of_gamut += usize::from(seen.min_element() < -1e-3);
        seen.max(DVec3::ZERO).as_vec3().to_array()
    });
    let mut report = Report::default();
    report.quantity("pixels outside the display's gamut", out_of_gamut as f64, "");
    report.picture = Some(seen.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M120: colours on a confusion line look equal to a dichromat; greys stay; what is seen once stays when seen
    /// again.
    #[test]
    fn confusion_lines_collapse() {
        for (cone, model) in [(0, "brettel"), (1, "brettel"), (2, "brettel"), (0, "vienot"), (1, "vienot")] {
            for k in 1..200 {
                let lms = DVec3::new(f64::from(k % 7) + 0.5, f64::from(k % 11) + 0.3, f64::from(k % 13) + 0.2) / 10.0;
                let mut other = lms;
                other[cone] *= 1.7;
                let seen = dichromat(lms, cone, model);
                assert!((seen - dichromat(other, cone, model)).length() < 1e-12);
                assert!((seen - dichromat(seen, cone, model)).length() < 1e-12);
            }
            let grey = DVec3::splat(0.4);
            assert!((dichromat(grey, cone, model) - grey).length() < 1e-12, "{cone} {model}");
        }
        // The anchors are seen as they are.
        for (cone, nm) in [(0, 475.0), (0, 575.0), (1, 475.0), (1, 575.0), (2, 485.0), (2, 660.0)] {
            let a = anchor(nm);
            assert!((dichromat(a, cone, "brettel") - a).length() < 1e-9 * a.length(), "{cone} {nm}");
        }
    }

    /// Red and green, told apart easily, come together for protanopes and deuteranopes, not for tritanopes; severity 0
    /// changes nothing.
    #[test]
    fn red_and_green_come_together() {
        let picture = Picture { width: 2, height: 1, rgb: vec![[0.6, 0.25, 0.1], [0.25, 0.35, 0.1]] };
        let apart = |kind: &str, model: &str, severity: &str| {
            let given = [("kind", kind), ("model", model), ("severity", severity)];
            let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
            let image = EXPERIMENT.run(&given, Some(&picture)).unwrap().picture.unwrap();
            let plane = |c: &str| f64::from(image.channel(c).unwrap()[0] / image.channel(c).unwrap()[1]).ln();
            (plane("R") - plane("G")).abs()
        };
        for model in ["brettel", "machado"] {
            assert!((apart("deuteranopia", model, "0") - 1.2119).abs() < 1e-3);
            for kind in ["deuteranopia", "protanopia"] {
                assert!(apart(kind, model, "1") < 0.35, "{kind} {model} {}", apart(kind, model, "1"));
                assert!(apart(kind, model, "0.5") > apart(kind, model, "1"));
            }
            assert!(apart("tritanopia", model, "1") > 0.8);
        }
        let given = [("kind".to_owned(), "tritanopia".to_owned()), ("model".to_owned(), "vienot".to_owned())];
        assert!(EXPERIMENT.run(&given, Some(&picture)).is_err());
    }
}
