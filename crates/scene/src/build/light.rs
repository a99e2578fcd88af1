//! Lights, each with the parameters that it has.

use super::{
    camera::frame,
    color::{Color, Texture},
    node::Draft,
};
use crate::Family;
use std::path::PathBuf;

/// A light that is no surface: what all of them turn into.
#[derive(Clone, Debug)]
pub struct Light {
    pub(super) draft: Draft,
}

/// The methods that lights share.
macro_rules! light {
    ($name:ident) => {
        impl From<$name> for Light {
            fn from(light: $name) -> Self {
                Self { draft: light.0 }
            }
        }

        impl $name {
            /// A factor of what it emits.
            #[must_use]
            pub fn scale(mut self, factor: f64) -> Self {
                self.0.set("scale", factor);
                self
            }

            /// The name of its group, by which layers show its light alone.
            #[must_use]
            pub fn named(mut self, name: impl Into<String>) -> Self {
                self.0.name = Some(name.into());
                self
            }
        }
    };
}

fn draft(kind: &'static str, quantity: &'static str, color: Color) -> Draft {
    Draft::new(Family::Light, kind).with(quantity, color.0)
}

/// A point that shines the same way in all directions.
#[derive(Clone, Debug)]
pub struct PointLight(Draft);
light!(PointLight);

impl PointLight {
    /// At a place, of that intensity in W/sr.
    pub fn at(position: [f64; 3], intensity: impl Into<Color>) -> Self {
        Self(draft("point", "intensity", intensity.into()).with("position", position))
    }
}

/// A point that shines in a cone.
#[derive(Clone, Debug)]
pub struct SpotLight(Draft);
light!(SpotLight);

impl SpotLight {
    /// From a place to another, of that intensity on the axis in W/sr. Its cone's half-angle is 30°, and its edge
    /// begins at 25°.
    pub fn new(from: [f64; 3], to: [f64; 3], intensity: impl Into<Color>) -> Self {
        Self(draft("spot", "intensity", intensity.into()).with("to_world", frame(from, to, [0.0, 1.0, 0.0])))
    }

    /// The half-angle of the cone, and that at which it begins to darken, in degrees.
    #[must_use]
    pub fn cone(mut self, half_angle: f64, falloff_start: f64) -> Self {
        self.0.set("cone_angle", half_angle);
        self.0.set("falloff_start", falloff_start);
        self
    }
}

/// Parallel light, as that of the sun.
#[derive(Clone, Debug)]
pub struct DistantLight(Draft);
light!(DistantLight);

impl DistantLight {
    /// The way that it travels, and the irradiance on a surface that faces it in W/m².
    pub fn new(direction: [f64; 3], irradiance: impl Into<Color>) -> Self {
        Self(draft("distant", "radiance", irradiance.into()).with("direction", direction))
    }
}

/// Light from all around.
#[derive(Clone, Debug)]
pub struct Sky(Draft);
light!(Sky);

impl Sky {
    /// One radiance from everywhere, in W/(m² sr).
    pub fn new(radiance: impl Into<Color>) -> Self {
        Self(draft("environment", "radiance", radiance.into()))
    }

    /// A picture by longitude and latitude with +y up, or a square one in pbrt's octahedral map.
    pub fn image(file: impl Into<PathBuf>) -> Self {
        Self(Draft::new(Family::Light, "environment").with("file", file.into()))
    }
}

/// The emission of a surface.
#[derive(Clone, Debug)]
pub struct AreaLight {
    pub(super) draft: Draft,
}

impl AreaLight {
    /// One radiance in all directions of the front, in W/(m² sr).
    pub fn new(radiance: impl Into<Texture>) -> Self {
        Self { draft: Draft::new(Family::Light, "area").with("radiance", radiance.into().0) }
    }

    /// Both sides emit.
    #[must_use]
    pub fn two_sided(mut self) -> Self {
        self.draft.set("two_sided", true);
        self
    }

    /// A factor of what it emits.
    #[must_use]
    pub fn scale(mut self, factor: f64) -> Self {
        self.draft.set("scale", factor);
        self
    }

    /// The name of its group, by which layers show its light alone.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.draft.name = Some(name.into());
        self
    }
}
