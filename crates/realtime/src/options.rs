//! The options of the integrator: `raster:shadows=map,size=1024`.

use crate::Error;

/// How it is told whether a light is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadows {
    /// It always is.
    None,
    /// By rays: exact.
    Ray,
    /// By shadow maps: pictures of depths as the light sees them (Williams 1978). Lights that are not points or parallel use rays.
    Map,
}

/// The ways to tell shadows by name, and what they are.
pub const SHADOWS: &[(&str, Shadows, &str)] = &[
    ("ray", Shadows::Ray, "by rays through the hierarchy: exact"),
    ("map", Shadows::Map, "by shadow maps for points and parallel light (size, bias, pcf); by rays for others"),
    ("none", Shadows::None, "nothing casts a shadow"),
];

/// What is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// The shaded picture.
    Picture,
    /// The depth along the camera's axis, near white and far black.
    Depth,
    /// A colour for each primitive.
    Primitives,
    /// The shading normal, each axis from −1…1 to 0…1.
    Normal,
}

/// The names of what can be shown.
const SHOWN: [(&str, Show); 4] =
    [("picture", Show::Picture), ("depth", Show::Depth), ("primitives", Show::Primitives), ("normal", Show::Normal)];

/// The options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How it is told whether a light is seen.
    pub shadows: Shadows,
    /// Side of a shadow map in texels.
    pub size: u32,
    /// Depth bias of shadow maps in texels: how far a surface is moved towards the light, times its slope.
    pub bias: f32,
    /// Texels that are compared around a point, along each axis; 1 for one.
    pub pcf: u32,
    /// Points on each light that has an extent, and directions of environments.
    pub points: u32,
    /// How many mirrors and panes of glass are looked through one after the other.
    pub bounces: u32,
    /// What is shown.
    pub show: Show,
}

impl Default for Options {
    fn default() -> Self {
        Self { shadows: Shadows::Ray, size: 1024, bias: 1.5, pcf: 1, points: 4, bounces: 8, show: Show::Picture }
    }
}

impl Options {
    /// The options in `key=value,…`.
    ///
    /// # Errors
    /// Keys and values that are not known, with those that are.
    pub fn parse(text: &str) -> Result<Self, Error> {
        let mut options = Self::default();
        for option in text.split(',').map(str::trim).filter(|o| !o.is_empty()) {
            let fault = |wanted: &str| Error::Option(format!("option '{option}' of raster: {wanted}"));
            let (key, value) = option.split_once('=').ok_or_else(|| fault("options are written key=value"))?;
            let number = |low: u32, high: u32| {
                let value = value.parse().ok().filter(|v| (low..=high).contains(v));
                value.ok_or_else(|| fault(&format!("a number from {low} to {high}")))
            };
            match key {
                "shadows" => {
                    let names: Vec<&str> = SHADOWS.iter().map(|s| s.0).collect();
                    let found = SHADOWS.iter().find(|s| s.0 == value);
                    options.shadows = found.ok_or_else(|| fault(&format!("one of {}", names.join(", "))))?.1;
                }
                "show" => {
                    let names = SHOWN.map(|s| s.0).join(", ");
                    options.show =
                        SHOWN.iter().find(|s| s.0 == value).ok_or_else(|| fault(&format!("one of {names}")))?.1;
                }
                "size" => options.size = number(16, 8192)?,
                "pcf" => options.pcf = number(1, 15)?,
                "points" => options.points = number(1, 1024)?,
                "bounces" => options.bounces = number(0, 64)?,
                "bias" => {
                    let bias = value.parse().ok().filter(|b: &f32| b.is_finite());
                    options.bias = bias.ok_or_else(|| fault("a number"))?;
                }
                _ => return Err(fault("keys are shadows, show, size, bias, pcf, points and bounces")),
            }
        }
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_refused_by_name() {
        let options = Options::parse("shadows=map, size=64,bias=-2.5,show=depth").unwrap();
        assert_eq!((options.shadows, options.size, options.bias, options.show), (Shadows::Map, 64, -2.5, Show::Depth));
        assert_eq!(Options::parse("").unwrap(), Options::default());
        for (text, part) in [
            ("shadows=magic", "one of ray, map, none"),
            ("size=1", "from 16 to 8192"),
            ("bias=NaN", "a number"),
            ("quality=high", "keys are shadows"),
            ("shadows", "key=value"),
        ] {
            assert!(Options::parse(text).unwrap_err().to_string().contains(part), "{text}");
        }
    }
}
