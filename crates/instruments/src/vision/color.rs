//! A colour in every model, and how different two colours look.

use crate::laboratory::{Error, Experiment, Parameter, Picture, Report, Run, Values};
use glam::DVec3;
use steradian_math::color::{
    difference::{delta_e_94, delta_e_2000},
    lab::{delta_e, lab_from_xyz},
    models,
    space::REC709,
    transfer,
    xyz::{cie_rgb_from_xyz, xyy_from_xyz},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "color",
    doc: "a colour in XYZ, xyY, CIE RGB, CIELAB, HSV, HSL, YCoCg, Oklab and XYB, and its difference from another",
    source: "CIE 15:2004; CIE 116-1995; CIE 142-2001; Smith 1978; Malvar, Sullivan 2003; Ottosson 2020; ISO/IEC 18181-1",
    parameters: &[
        Parameter::number("red", 200.0, (0.0, 255.0), "", "sRGB component of the colour"),
        Parameter::number("green", 120.0, (0.0, 255.0), "", "sRGB component"),
        Parameter::number("blue", 60.0, (0.0, 255.0), "", "sRGB component"),
        Parameter::number("red2", 200.0, (0.0, 255.0), "", "sRGB component of another colour"),
        Parameter::number("green2", 130.0, (0.0, 255.0), "", "sRGB component of the other"),
        Parameter::number("blue2", 60.0, (0.0, 255.0), "", "sRGB component of the other"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let encoded = |names: [&str; 3]| DVec3::from(names.map(|n| values.number(n))) / 255.0;
    let srgb = encoded(["red", "green", "blue"]);
    let linear = srgb.map(|v| f64::from(transfer::srgb_decode(v as f32)));
    let xyz = REC709.xyz_from_rgb() * linear;
    let white = REC709.white();
    let mut report = Report::default();
    let mut group = |names: [&str; 3], v: DVec3| {
        for (name, v) in names.into_iter().zip(v.to_array()) {
            report.quantity(name, v, "");
        }
    };
    group(["linear red", "linear green", "linear blue"], linear);
    group(["X", "Y", "Z"], xyz);
    let [x, y, _] = xyy_from_xyz(xyz);
    group(["x", "y", "luminance"], DVec3::new(x, y, xyz.y));
    group(["CIE R", "CIE G", "CIE B"], cie_rgb_from_xyz() * xyz);
    group(["L*", "a*", "b*"], lab_from_xyz(xyz, white));
    group(["HSV hue (°)", "HSV saturation", "HSV value"], models::hsv_from_rgb(srgb));
    group(["HSL hue (°)", "HSL saturation", "HSL lightness"], models::hsl_from_rgb(srgb));
    group(["YCoCg Y", "YCoCg Co", "YCoCg Cg"], models::ycocg_from_rgb(srgb));
    let whole = models::ycocg_r_from_rgb((srgb * 255.0).round().to_array().map(|v| v as i32));
    group(["YCoCg-R Y", "YCoCg-R Co", "YCoCg-R Cg"], DVec3::from(whole.map(f64::from)));
    group(["Oklab L", "Oklab a", "Oklab b"], models::oklab_from_rgb(linear));
    group(["XYB X", "XYB Y", "XYB B"], models::xyb_from_rgb(linear));
    let other = encoded(["red2", "green2", "blue2"]).map(|v| f64::from(transfer::srgb_decode(v as f32)));
    let other_xyz = REC709.xyz_from_rgb() * other;
    let (a, b) = (lab_from_xyz(xyz, white), lab_from_xyz(other_xyz, white));
    report.quantity("ΔE*ab (1976)", delta_e(xyz, other_xyz, white), "");
    report.quantity("ΔE*94", delta_e_94(a, b), "");
    report.quantity("ΔE00", delta_e_2000(a, b), "");
    let picture = Picture::from_fn(256, 128, |x, _| (if x < 128 { linear } else { other }).as_vec3().to_array());
    report.picture = Some(picture.to_image()?);
    Ok(report)
}
