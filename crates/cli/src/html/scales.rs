//! Colours of maps, and their legends.

use steradian::image::{Encoding, metrics};

/// Difference in standard errors that has the full colour.
pub const FULL: f64 = 4.0;
/// Colours of signed maps in sRGB: darker than the reference, the same, brighter, and unknown.
const DARKER: [f64; 3] = [33.0, 102.0, 172.0];
const EVEN: [f64; 3] = [255.0; 3];
const BRIGHTER: [f64; 3] = [178.0, 24.0, 43.0];
const UNKNOWN: [f64; 3] = [128.0; 3];

/// Linear colour of a difference in standard errors: from blue by white to red, grey where it is not known.
pub fn signed(z: Option<f64>) -> [f32; 3] {
    let srgb = match z.filter(|z| !z.is_nan()) {
        None => UNKNOWN,
        Some(z) => {
            let (end, t) = (if z < 0.0 { DARKER } else { BRIGHTER }, (z.abs() / FULL).min(1.0));
            std::array::from_fn(|c| EVEN[c] + t * (end[c] - EVEN[c]))
        }
    };
    srgb.map(|v| Encoding::Srgb.decode((v / 255.0) as f32))
}

/// A scale of colours under a map.
#[derive(Clone, Copy, Debug)]
pub enum Scale {
    /// Colours of [`signed`].
    Signed,
    /// Magma, from black to light yellow.
    Magma,
}

impl Scale {
    /// A bar of the colours, and labels of its ends and its middle.
    pub fn legend(self, labels: [&str; 3]) -> String {
        let stops = match self {
            Self::Signed => [DARKER, EVEN, BRIGHTER].to_vec(),
            Self::Magma => (0..=8).map(|k| srgb(metrics::magma(k as f32 / 8.0))).collect(),
        };
        let css = |[r, g, b]: [f64; 3]| format!("rgb({r} {g} {b})");
        let gradient = stops.into_iter().map(css).collect::<Vec<_>>().join(",");
        let [low, middle, high] = labels;
        format!(
            "<div class=\"legend\">\n\
             <div class=\"scale\" style=\"background:linear-gradient(90deg,{gradient})\"></div>\n\
             <div class=\"ends\"><span>{low}</span><span>{middle}</span><span>{high}</span></div>\n</div>\n"
        )
    }
}

/// Code values of a linear colour.
fn srgb(linear: [f32; 3]) -> [f64; 3] {
    linear.map(|v| f64::from(255.0 * Encoding::Srgb.encode(v)).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_sign_of_the_difference() {
        let [darker, brighter] = [-1e9, f64::INFINITY].map(|z| signed(Some(z)));
        assert!(darker[2] > 3.0 * darker[0] && brighter[0] > 3.0 * brighter[2], "{darker:?} {brighter:?}");
        assert!(signed(Some(0.0)).iter().all(|v| (v - 1.0).abs() < 1e-6));
        assert_eq!(signed(None), signed(Some(f64::NAN)));
        let legend = Scale::Magma.legend(["0", "", "1"]);
        assert!(legend.contains("rgb(0 0 4)") && legend.contains("rgb(252 253 191)"), "{legend}");
    }
}
