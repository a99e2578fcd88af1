//! Backgrounds of models, apart from what lights them: `-D background=`.

use super::studio;
use std::path::PathBuf;
use steradian_math::{DVec3, color::transfer::srgb_decode};
use steradian_scene::{ColorSpace, Family, Node, SceneDesc, SpectrumValue};

/// Grey of the gradient at its lower and at its upper end, and the heights of these as sines of elevations.
const GREYS: [f64; 2] = [0.8, 0.5];
const ENDS: [f64; 2] = [-0.5, 0.05];
/// Height of the ground in the view of the camera that is added, for the colour that meets the gradient there.
const GROUND_HEIGHT: f64 = -0.33;
/// Greatest reflectance of a ground that is as bright as what is behind it.
const BRIGHTEST: f64 = 0.9;

/// Background of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Background {
    /// Nothing: the picture ends where the model does.
    None,
    /// A colour, linear.
    Color([f64; 3]),
    /// A grey that is lighter below.
    Gradient,
}

fn gradient(d: DVec3) -> [f64; 3] {
    let ([below, above], [low, high]) = (GREYS, ENDS);
    [below + (above - below) * studio::smoothstep((d.y - low) / (high - low)); 3]
}

impl Background {
    /// The background of a name or colour; `Ok(None)` for the sky itself.
    pub fn of(word: &str) -> Result<Option<Self>, String> {
        let hex = |digits: &str| {
            let value =
                u32::from_str_radix(digits, 16).ok().filter(|_| digits.len() == 6 && !digits.starts_with('+'))?;
            Some([16, 8, 0].map(|shift| f64::from(srgb_decode((value >> shift & 0xff) as f32 / 255.0))))
        };
        let numbers = || {
            let list: Vec<f64> = word.split(',').map(|v| v.trim().parse().ok()).collect::<Option<_>>()?;
            <[f64; 3]>::try_from(list).ok().filter(|rgb| rgb.iter().all(|v| (0.0..=1e6).contains(v)))
        };
        match word {
            "sky" => Ok(None),
            "none" => Ok(Some(Self::None)),
            "gradient" => Ok(Some(Self::Gradient)),
            _ => match word.strip_prefix('#').map_or_else(numbers, hex) {
                Some(color) => Ok(Some(Self::Color(color))),
                None => Err(format!(
                    "'background' is sky, none, gradient, #rrggbb, or red,green,blue of linear light, not '{word}'"
                )),
            },
        }
    }

    /// Colour of the background where the ground is seen before it.
    fn around_ground(self) -> [f64; 3] {
        match self {
            Self::None => [0.0; 3],
            Self::Color(color) => color,
            Self::Gradient => gradient(DVec3::new(0.0, GROUND_HEIGHT, 0.0)),
        }
    }

    /// Reflectance of a ground that is as bright as the background under a sky of an irradiance, as far as one can be.
    pub fn ground(self, irradiance: [f64; 3]) -> [f64; 3] {
        let color = self.around_ground();
        std::array::from_fn(|c| (color[c] * std::f64::consts::PI / irradiance[c].max(1e-9)).min(BRIGHTEST))
    }

    /// Adds it to a scene.
    pub fn add(self, desc: &mut SceneDesc) {
        let mut node = Node::new(Family::Light, "backdrop", None);
        node.name = Some("backdrop".into());
        match self {
            Self::None => node.set("radiance", SpectrumValue::Rgb([0.0; 3], ColorSpace::Srgb), None),
            Self::Color(color) => node.set("radiance", SpectrumValue::Rgb(color, ColorSpace::Srgb), None),
            Self::Gradient => {
                let file = PathBuf::from("gradient");
                desc.embedded.insert(file.clone(), studio::pfm(gradient).into());
                node.set("file", file, None).set("parametrization", "latlong", None)
            }
        };
        let node = desc.add(node);
        desc.lights.push(node);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backgrounds_are_read_or_refused() {
        let red = Background::of("#ff0000").expect("it is a colour");
        assert_eq!(red, Some(Background::Color([1.0, 0.0, 0.0])));
        let Ok(Some(Background::Color([grey, ..]))) = Background::of("#808080") else { panic!("it is a colour") };
        assert!((grey - 0.215_861).abs() < 1e-5, "{grey}");
        assert_eq!(Background::of("0.5, 0,2"), Ok(Some(Background::Color([0.5, 0.0, 2.0]))));
        assert_eq!((Background::of("sky"), Background::of("none")), (Ok(None), Ok(Some(Background::None))));
        for word in ["", "#fff", "#gggggg", "#+fffff", "1,2", "1,2,3,4", "-1,0,0", "1,nan,0", "white"] {
            assert!(Background::of(word).is_err_and(|e| e.contains(&format!("not '{word}'"))), "{word}");
        }
    }

    /// A diffuse ground under its irradiance has the radiance of the background, unless it would have to shine.
    #[test]
    fn the_ground_is_as_bright_as_what_is_behind_it() {
        let irradiance = [3.0, 4.0, 5.0];
        let color = [0.2, 0.5, 1.9];
        let ground = Background::Color(color).ground(irradiance);
        for c in 0..2 {
            assert!((ground[c] * irradiance[c] / std::f64::consts::PI - color[c]).abs() < 1e-12);
        }
        assert_eq!(ground[2], BRIGHTEST);
        let [below, at, above] = [-0.9, GROUND_HEIGHT, 0.9].map(|y| gradient(DVec3::new(0.0, y, 0.0))[0]);
        assert!(below == GREYS[0] && below > at && at > above && above == GREYS[1], "{below} {at} {above}");
    }
}
