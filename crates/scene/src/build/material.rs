//! Materials, each model with the parameters that it has.

use super::{
    color::{Color, Image, Metal, Texture},
    node::{Draft, Part},
};
use crate::{
    Family,
    node::{SpectrumValue, Value},
};

/// Material of a surface. Made by one of its functions, and by [`Conductor`], [`Dielectric`], [`Coated`] and [`Pbr`],
/// which turn into it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub(super) draft: Draft,
}

fn draft(kind: &'static str) -> Draft {
    Draft::new(Family::Material, kind)
}

impl Material {
    /// Lambert's: light leaves evenly whatever side it came from. 0 is black, 1 absorbs nothing.
    pub fn diffuse(reflectance: impl Into<Texture>) -> Self {
        Self { draft: draft("diffuse").with("reflectance", reflectance.into().0) }
    }

    /// A metal, smooth unless [`Conductor::roughness`] says otherwise.
    pub fn conductor(metal: Metal) -> Conductor {
        let named = |what: &str| SpectrumValue::Named(format!("metal-{}-{what}", metal.0));
        Conductor(draft("conductor").with("eta", named("eta")).with("k", named("k")))
    }

    /// A metal by its colour where light meets it straight on.
    pub fn metal_of(reflectance: impl Into<Texture>) -> Conductor {
        Conductor(draft("conductor").with("reflectance", reflectance.into().0))
    }

    /// Clear glass of an index of refraction (1.5), or of a [`super::glass`], which disperses light in spectral mode.
    pub fn dielectric(eta: impl Into<Color>) -> Dielectric {
        let eta = match eta.into().0 {
            SpectrumValue::Constant(v) => Value::Float(v),
            spectrum => Value::Spectrum(spectrum),
        };
        Dielectric(draft("dielectric").with("eta", eta))
    }

    /// A clear coat over a diffuse base: plastic, lacquer, glazed pottery.
    pub fn coated(reflectance: impl Into<Texture>) -> Coated {
        Coated(draft("coated_diffuse").with("reflectance", reflectance.into().0))
    }

    /// glTF's metallic-roughness model.
    pub fn pbr(base_color: impl Into<Texture>) -> Pbr {
        let base = draft("metallic_roughness").with("base_color", base_color.into().0);
        Pbr(base.with("metallic", 0.0).with("roughness", 0.5))
    }

    /// Two materials: `amount` of the second, from 0 to 1.
    pub fn mix(first: impl Into<Material>, second: impl Into<Material>, amount: impl Into<Texture>) -> Self {
        let parts = Part::Nodes(vec![first.into().draft, second.into().draft]);
        Self { draft: draft("mix").with("materials", parts).with("amount", amount.into().0) }
    }

    /// The name under which layers and messages speak of it.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.draft.name = Some(name.into());
        self
    }

    /// Bends the normals by a picture of them in tangent space.
    #[must_use]
    pub fn normal_map(mut self, map: Image) -> Self {
        self.draft.set("normal_map", Texture::from(map.raw()).0);
        self
    }

    /// Bends the normals as heights would, in scene units.
    #[must_use]
    pub fn bump(mut self, heights: impl Into<Texture>) -> Self {
        self.draft.set("bump", heights.into().0);
        self
    }

    /// Lets light pass: an opacity of 1 is the material, of 0 nothing.
    #[must_use]
    pub fn masked(self, opacity: impl Into<Texture>) -> Self {
        let inner = Part::Node(Box::new(self.draft));
        Self { draft: draft("mask").with("opacity", opacity.into().0).with("material", inner) }
    }
}

/// The methods that models of their own share with [`Material`].
macro_rules! model {
    ($name:ident) => {
        impl From<$name> for Material {
            fn from(m: $name) -> Self {
                Self { draft: m.0 }
            }
        }

        impl $name {
            /// The name under which layers and messages speak of it.
            #[must_use]
            pub fn named(self, name: impl Into<String>) -> Material {
                Material::from(self).named(name)
            }

            /// Bends the normals by a picture of them in tangent space.
            #[must_use]
            pub fn normal_map(self, map: Image) -> Material {
                Material::from(self).normal_map(map)
            }

            /// Bends the normals as heights would, in scene units.
            #[must_use]
            pub fn bump(self, heights: impl Into<Texture>) -> Material {
                Material::from(self).bump(heights)
            }

            /// Lets light pass: an opacity of 1 is the material, of 0 nothing.
            #[must_use]
            pub fn masked(self, opacity: impl Into<Texture>) -> Material {
                Material::from(self).masked(opacity)
            }
        }
    };
}

/// The roughness of facets.
macro_rules! facets {
    ($name:ident) => {
        impl $name {
            /// The roughness α of GGX: 0 is smooth, 1 very rough.
            #[must_use]
            pub fn roughness(self, alpha: impl Into<Texture>) -> Self {
                let alpha = alpha.into();
                self.brushed(alpha.clone(), alpha)
            }

            /// A roughness α along the texture's u and one along its v.
            #[must_use]
            pub fn brushed(mut self, alpha_u: impl Into<Texture>, alpha_v: impl Into<Texture>) -> Self {
                self.0.set("alpha_u", alpha_u.into().0);
                self.0.set("alpha_v", alpha_v.into().0);
                self
            }
        }
    };
}

/// A metal.
#[derive(Clone, Debug, PartialEq)]
pub struct Conductor(Draft);
model!(Conductor);
facets!(Conductor);

/// Glass.
#[derive(Clone, Debug, PartialEq)]
pub struct Dielectric(Draft);
model!(Dielectric);
facets!(Dielectric);

/// A coat over a diffuse base.
#[derive(Clone, Debug, PartialEq)]
pub struct Coated(Draft);
model!(Coated);
facets!(Coated);

impl Coated {
    /// The index of refraction of the coat (1.5).
    #[must_use]
    pub fn eta(mut self, eta: f64) -> Self {
        self.0.set("eta", eta);
        self
    }
}

/// glTF's metallic-roughness model; neither metal nor rough (0.5) at first.
#[derive(Clone, Debug, PartialEq)]
pub struct Pbr(Draft);
model!(Pbr);

impl Pbr {
    /// 0 is a dielectric, 1 a metal.
    #[must_use]
    pub fn metallic(mut self, share: impl Into<Texture>) -> Self {
        self.0.set("metallic", share.into().0);
        self
    }

    /// Perceived roughness, the root of α.
    #[must_use]
    pub fn roughness(mut self, roughness: impl Into<Texture>) -> Self {
        self.0.set("roughness", roughness.into().0);
        self
    }

    /// The share of light that passes, and does not meet the base.
    #[must_use]
    pub fn transmission(mut self, share: impl Into<Texture>) -> Self {
        self.0.set("transmission", share.into().0);
        self
    }

    /// The strength of a clear coat, and its roughness.
    #[must_use]
    pub fn clearcoat(mut self, strength: impl Into<Texture>, roughness: impl Into<Texture>) -> Self {
        self.0.set("clearcoat", strength.into().0);
        self.0.set("clearcoat_roughness", roughness.into().0);
        self
    }

    /// The colour and roughness of a layer of fibres.
    #[must_use]
    pub fn sheen(mut self, color: impl Into<Texture>, roughness: impl Into<Texture>) -> Self {
        self.0.set("sheen_color", color.into().0);
        self.0.set("sheen_roughness", roughness.into().0);
        self
    }

    /// The index of refraction (1.5).
    #[must_use]
    pub fn eta(mut self, eta: f64) -> Self {
        self.0.set("eta", eta);
        self
    }
}
