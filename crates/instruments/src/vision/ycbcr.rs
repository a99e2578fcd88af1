//! Y′CbCr: luma and two differences of colour, `Cb = (B′ − Y′)/(2 − 2 K_B)` and `Cr = (R′ − Y′)/(2 − 2 K_R)`, as whole
//! numbers of some bits.
//!
//! Luma is a sum of *encoded* components, `Y′ = K_R R′ + K_G G′ + K_B B′`, and no luminance. Limited range keeps room
//! at both ends: of 8 bits Y′ has 16 to 235 and Cb, Cr 16 to 240; full range has all codes, Cb and Cr around 128. Not
//! every code is a colour: of the cube of codes RGB fills about a quarter, so that whole numbers do not all come back.

use crate::laboratory::{Error, Experiment, Parameter, Picture, Report, Run, Values};
use glam::DVec3;
use steradian_math::color::{luminance, transfer};

pub const EXPERIMENT: Experiment = Experiment {
    name: "ycbcr",
    doc: "a colour as Y′CbCr of BT.601, BT.709 or BT.2020, and what is left of it after the round trip",
    source: "ITU-R BT.601-7, BT.709-6, BT.2020-2 (non-constant luminance); JFIF 1.02 (BT.601, full range)",
    parameters: &[
        Parameter::choice("standard", &["709", "601", "2020"], "weights of the components"),
        Parameter::choice("range", &["limited", "full"], "codes that are used"),
        Parameter::count("bits", 8, (8, 16), "of a code"),
        Parameter::number("red", 200.0, (0.0, 255.0), "", "encoded component"),
        Parameter::number("green", 120.0, (0.0, 255.0), "", "encoded component"),
        Parameter::number("blue", 60.0, (0.0, 255.0), "", "encoded component"),
    ],
    run: Run::Alone(run),
};

/// A way to write colours as Y′CbCr.
#[derive(Clone, Copy)]
struct Code {
    /// Weights of red and blue in luma.
    weights: [f64; 2],
    is_full: bool,
    bits: u32,
}

impl Code {
    /// Luma from 0 to 1, differences from −½ to ½.
    fn differences(&self, rgb: DVec3) -> DVec3 {
        let [red, blue] = self.weights;
        let luma = DVec3::new(red, 1.0 - red - blue, blue).dot(rgb);
        DVec3::new(luma, 0.5 * (rgb.z - luma) / (1.0 - blue), 0.5 * (rgb.x - luma) / (1.0 - red))
    }

    fn rgb(&self, code: DVec3) -> DVec3 {
        let [kr, kb] = self.weights;
        let (red, blue) = (code.x + 2.0 * (1.0 - kr) * code.z, code.x + 2.0 * (1.0 - kb) * code.y);
        DVec3::new(red, (code.x - kr * red - kb * blue) / (1.0 - kr - kb), blue)
    }

    /// Scale and offset of luma, and of the differences.
    fn scales(&self) -> [(f64, f64); 2] {
        let unit = f64::from(1_u32 << (self.bits - 8));
        let top = 256.0 * unit - 1.0;
        let middle = 128.0 * unit;
        if self.is_full { [(top, 0.0), (top, middle)] } else { [(219.0 * unit, 16.0 * unit), (224.0 * unit, middle)] }
    }

    /// Whole numbers.
    fn quantized(&self, code: DVec3) -> DVec3 {
        let [(luma, black), (chroma, middle)] = self.scales();
        let top = f64::from(1_u32 << self.bits) - 1.0;
        let codes = DVec3::new(code.x * luma + black, code.y * chroma + middle, code.z * chroma + middle);
        codes.round().clamp(DVec3::ZERO, DVec3::splat(top))
    }

    fn of_quantized(&self, codes: DVec3) -> DVec3 {
        let [(luma, black), (chroma, middle)] = self.scales();
        DVec3::new((codes.x - black) / luma, (codes.y - middle) / chroma, (codes.z - middle) / chroma)
    }

    /// There and back, in encoded components from 0 to 1.
    fn round_trip(&self, rgb: DVec3) -> DVec3 {
        self.rgb(self.of_quantized(self.quantized(self.differences(rgb)))).clamp(DVec3::ZERO, DVec3::ONE)
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let code = Code {
        weights: match values.choice("standard") {
            "601" => [0.299, 0.114],
            "2020" => [0.2627, 0.0593],
            _ => [0.2126, 0.0722],
        },
        is_full: values.choice("range") == "full",
        bits: values.count("bits") as u32,
    };
    let rgb = DVec3::from(["red", "green", "blue"].map(|n| values.number(n))) / 255.0;
    let exact = code.differences(rgb);
    let mut report = Report::default();
    let mut group = |names: [&str; 3], v: DVec3| {
        for (name, v) in names.into_iter().zip(v.to_array()) {
            report.quantity(name, v + 0.0, "");
        }
    };
    group(["luma Y′", "difference Cb", "difference Cr"], exact);
    group(["code of Y′", "code of Cb", "code of Cr"], code.quantized(exact));
    group(["red that comes back", "green that comes back", "blue that comes back"], 255.0 * code.round_trip(rgb));
    let linear = |v: DVec3| v.map(|v| f64::from(transfer::srgb_decode(v as f32)));
    report.quantity("luminance, of the linear components of sRGB", f64::from(luminance(linear(rgb).as_vec3())), "");
    // A grid of whole numbers of 8 bits.
    let grid = (0..=17 * 17 * 17 + 1).map(|k| DVec3::new((k % 17) as f64, (k / 17 % 17) as f64, (k / 289 % 17) as f64));
    let error = |rgb: DVec3| ((255.0 * code.round_trip(rgb)).round() - 255.0 * rgb).abs().max_element().round();
    let errors: Vec<f64> = grid.map(|v| error((v * 15.94).round() / 255.0)).collect();
    let changed = errors.iter().filter(|e| **e > 0.0).count() as f64 / errors.len() as f64;
    report.quantity("share of colours of 8 bits that change", changed, "");
    report.quantity("greatest change of a component", errors.iter().copied().fold(0.0, f64::max), "of 255");
    // The plane of the colour's luma: Cb to the right, Cr up; grey where there is no RGB.
    const SIZE: usize = 256;
    let picture = Picture::from_fn(SIZE, SIZE, |x, y| {
        let place = |k: usize| (k as f64 + 0.5) / SIZE as f64 - 0.5;
        let there = code.rgb(DVec3::new(exact.x, place(x), -place(y)));
        let is_color = there.min_element() >= 0.0 && there.max_element() <= 1.0;
        linear(if is_color { there } else { DVec3::splat(0.3) }).as_vec3().to_array()
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(standard: &str, range: &str, bits: u32, rgb: [u32; 3]) -> Report {
        let numbers = rgb.map(|v| v.to_string());
        let bits = bits.to_string();
        let given = [
            ("standard", standard),
            ("range", range),
            ("bits", &bits),
            ("red", &numbers[0]),
            ("green", &numbers[1]),
            ("blue", &numbers[2]),
        ];
        EXPERIMENT.run(&given.map(|(a, b)| (a.to_owned(), b.to_owned())), None).unwrap()
    }

    /// M122: the codes of the bars of test pictures: BT.601 and BT.709 of 8 bits (SMPTE RP 219, EG 1), BT.2020 of 10
    /// bits, and JFIF's.
    #[test]
    fn bars_have_their_codes() {
        for (standard, range, bits, rgb, codes) in [
            ("601", "limited", 8, [255, 0, 0], [81.0, 90.0, 240.0]),
            ("601", "limited", 8, [0, 255, 0], [145.0, 54.0, 34.0]),
            ("601", "limited", 8, [0, 0, 255], [41.0, 240.0, 110.0]),
            ("709", "limited", 8, [255, 0, 0], [63.0, 102.0, 240.0]),
            ("709", "limited", 8, [0, 255, 0], [173.0, 42.0, 26.0]),
            ("709", "limited", 8, [0, 0, 255], [32.0, 240.0, 118.0]),
            ("709", "limited", 8, [255, 255, 255], [235.0, 128.0, 128.0]),
            ("709", "limited", 10, [0, 0, 0], [64.0, 512.0, 512.0]),
            ("2020", "limited", 10, [255, 0, 0], [294.0, 387.0, 960.0]),
            ("601", "full", 8, [255, 0, 0], [76.0, 85.0, 255.0]),
            ("601", "full", 8, [0, 0, 255], [29.0, 255.0, 107.0]),
        ] {
            let r = with(standard, range, bits, rgb);
            let found = ["code of Y′", "code of Cb", "code of Cr"].map(|n| r.value(n));
            assert_eq!(found, codes, "{standard} {range} {bits} {rgb:?}");
        }
    }

    /// Without rounding nothing is lost; with 8 bits some colours move by one or two, with 12 none; luma is no
    /// luminance.
    #[test]
    fn the_round_trip_loses_what_rounding_does() {
        let code = Code { weights: [0.2126, 0.0722], is_full: false, bits: 8 };
        for k in 0..729_u32 {
            let rgb = DVec3::new(f64::from(k % 9), f64::from(k / 9 % 9), f64::from(k / 81)) / 8.0;
            assert!((code.rgb(code.differences(rgb)) - rgb).length() < 1e-12);
            assert!((code.round_trip(rgb) - rgb).abs().max_element() < 2.5 / 255.0);
        }
        let change = |bits| with("709", "limited", bits, [0, 0, 255]).value("share of colours of 8 bits that change");
        assert!(change(8) > 0.5 && change(12) == 0.0, "{} {}", change(8), change(12));
        let blue = with("601", "full", 8, [0, 0, 255]);
        assert!((blue.value("luma Y′") - 0.114).abs() < 1e-12);
        assert!((blue.value("luminance, of the linear components of sRGB") - 0.0722).abs() < 1e-4);
    }
}
