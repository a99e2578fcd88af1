//! Materials: textures and constants that become a [`Bsdf`] at a hit.
//!
//! [`scattering`] evaluates the textures of a material once and makes a `Bsdf`: a small `Copy` value that knows no
//! texture and no scene. A mixture picks one of its parts at random for each event; Lambertian parts are mixed exactly
//! instead. A two-sided material picks by the side.
//!
//! [`Needs`] says at compile time which data of a surface point a material asks for. Where nothing looks up a texture
//! or needs a tangent, surface points have no parameters and derivatives (`Scene::interaction_of_light`).
//!
//! A `mask` becomes the `alpha` of the shape. Rays pass it by a hash of point and direction. Filtered masks are
//! averaged over the footprint that the camera would have at the point.

mod fluorescent;
mod grating;
mod hair;
mod layered;
mod pbr;
mod principled;
mod subsurface;

pub use fluorescent::FluorescentMaterial;
pub use grating::GratingMaterial;
pub use hair::{Absorption, HairMaterial};
pub use layered::{LayeredBase, LayeredMaterial};
pub use pbr::{Convention, PbrMaterial};
pub use principled::PrincipledMaterial;
pub use subsurface::{Below, Content, SubsurfaceBase, SubsurfaceMaterial, SubsurfaceMedium, SubsurfaceMethod};
pub mod detail;
mod fold;
pub mod normal_code;
pub mod normal_filter;
pub mod normal_map;
mod parametric;

pub use detail::{CoatNormals, Cover, Facing, SurfaceDetail};
pub use facets::{FacetReflectance, Facets, Film, Metal};
pub use fold::Fold;
pub use normal_filter::{FilteredNormals, NormalFilter};
pub use normal_map::{NormalMap, NormalSpace};
pub use parametric::{InputTextures, OwnMaterial, Parametric};
use std::sync::Arc;
use steradian_bsdf::{
    Bsdf, BsdfEval, BsdfSample, CoatTable, Coated, CompensatedConductor, Compensation, Conductor, Dielectric, Diffuse,
    DiffuseTransmission, EnergyTable, Measured, MeasuredData, Microfacet, NormalDistribution, Shadowing,
    ThinDielectric, TransportMode,
};
use steradian_math::{
    Spectrum, Vec2, Vec3,
    spectra::{ColorMode, Wavelengths, role::Color},
};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

mod facets;

/// Microfacet roughness as a scene gives it.
#[derive(Clone, Copy, Debug)]
pub struct Roughness {
    /// Along the tangent.
    pub u: FloatTexture,
    /// Along the bitangent.
    pub v: FloatTexture,
    /// True if values are roughnesses `r` with α = √r, rather than α.
    pub remap: bool,
    /// Distribution of normals.
    pub distribution: NormalDistribution,
    /// Masking and shadowing.
    pub shadowing: Shadowing,
}

impl Roughness {
    /// Both α at a point.
    #[inline]
    pub(crate) fn alpha(&self, textures: &Textures, at: &TextureContext) -> (f32, f32) {
        let remap = |v: f32| {
            let v = if v.is_finite() { v.max(0.0) } else { 0.0 };
            if self.remap { v.sqrt() } else { v }
        };
        at.roughened(remap(self.u.eval(textures, at)), remap(self.v.eval(textures, at)))
    }

    #[inline]
    pub(crate) fn microfacet(&self, textures: &Textures, at: &TextureContext) -> Microfacet {
        let (u, v) = self.alpha(textures, at);
        Microfacet::new(self.distribution, self.shadowing, u, v)
    }

    /// True if both values are the same everywhere.
    fn is_constant(&self) -> bool {
        self.u.is_constant() && self.v.is_constant()
    }

    /// True if the two α may differ, so that the orientation of the tangent matters.
    pub fn is_anisotropic(&self) -> bool {
        match (self.u, self.v) {
            (FloatTexture::Constant(a), FloatTexture::Constant(b)) => a != b,
            (FloatTexture::Texture(a), FloatTexture::Texture(b)) => a != b,
            _ => true,
        }
    }
}

/// An index of refraction.
#[derive(Clone, Debug)]
pub enum Eta {
    /// One index for all wavelengths.
    Constant(f32),
    /// Dispersion: paths keep their hero wavelength alone.
    Dispersive(Color),
    /// Varying over the surface.
    Varying(FloatTexture),
}

impl Eta {
    /// True if the value is the same everywhere.
    fn is_constant(&self) -> bool {
        !matches!(self, Self::Varying(_))
    }

    #[inline]
    fn eval(&self, textures: &Textures, at: &TextureContext, lambda: &mut Wavelengths) -> f32 {
        match self {
            Self::Constant(v) => *v,
            Self::Varying(t) => index_of_refraction(t.eval(textures, at)),
            Self::Dispersive(c) => {
                lambda.terminate_secondary();
                c.eval(lambda)[0]
            }
        }
    }
}

/// Scattering model of a surface.
#[derive(Clone, Debug)]
pub enum Model {
    /// Lambert.
    Diffuse(SpectrumTexture),
    /// Lambert on both sides: reflectance, transmittance.
    DiffuseTransmission(SpectrumTexture, SpectrumTexture),
    /// Metal by its complex index.
    Conductor {
        /// Real part.
        eta: SpectrumTexture,
        /// Imaginary part.
        k: SpectrumTexture,
        /// Factor.
        tint: SpectrumTexture,
        /// Roughness.
        roughness: Roughness,
    },
    /// A rough metal with light between its facets.
    Compensated {
        /// The metal.
        metal: Metal,
        /// Method of the compensation.
        kind: Compensation,
        /// Energy that single scattering loses at its facets.
        table: Arc<EnergyTable>,
    },
    /// Facets with a choice of reflectance, over a diffuse part.
    Facets(Facets),
    /// A model that takes nothing but its parameters.
    Parametric(Box<Parametric>),
    /// A model of a program's own.
    Own(Box<OwnMaterial>),
    /// Metal by its reflectance at normal incidence.
    ConductorReflectance(SpectrumTexture, Roughness),
    /// A mirror of constant reflectance, smooth or rough.
    Mirror(SpectrumTexture, Roughness),
    /// Glass.
    Dielectric {
        /// Interior over exterior.
        eta: Eta,
        /// Factor on reflection.
        reflectance: SpectrumTexture,
        /// Factor on transmission.
        transmittance: SpectrumTexture,
        /// Roughness.
        roughness: Roughness,
    },
    /// A pane.
    ThinDielectric {
        /// Interior over exterior.
        eta: Eta,
        /// Factor on reflection.
        reflectance: SpectrumTexture,
        /// Factor on transmission.
        transmittance: SpectrumTexture,
    },
    /// A coat over a diffuse base.
    Coated {
        /// Albedo of the base.
        reflectance: SpectrumTexture,
        /// Factor on the specular part.
        tint: SpectrumTexture,
        /// Roughness of the coat.
        roughness: Roughness,
        /// Light that passes the coat.
        table: Arc<CoatTable>,
    },
    /// Tabulated reflection, turned about the normal with the surface's parametrisation.
    Measured(Arc<MeasuredData>),
    /// A fibre.
    Hair(Box<HairMaterial>),
    /// A coat, by random walks.
    Layered(Box<LayeredMaterial>),
    /// The surface of glTF and OpenPBR.
    Pbr(Box<PbrMaterial>),
    /// Disney's surface.
    Principled(Box<PrincipledMaterial>),
    /// Part of the light leaves at other wavelengths.
    Fluorescent(Box<FluorescentMaterial>),
    /// Grooves that diffract, in spectral mode.
    Grating(Box<GratingMaterial>),
    /// Light enters, to leave elsewhere.
    Subsurface(Box<SubsurfaceMaterial>),
    /// One of two materials (indices), chosen at each point with the probability of the second.
    Mix(u32, u32, FloatTexture),
    /// Different materials (indices) on the side the normal points to and the other.
    TwoSided(u32, u32),
    /// No scattering.
    Interface,
}

/// A material.
#[derive(Clone, Debug)]
pub struct Material {
    /// Scattering model.
    pub model: Model,
    /// True if a model that only reflects does so on both sides.
    pub two_sided: bool,
    /// Perturbation of the shading normal.
    pub detail: Option<SurfaceDetail>,
    /// Reflectance of ambient light, k_a; its albedo where there is none.
    pub ambient: Option<SpectrumTexture>,
}

/// The surface below bump and normal maps, by its effect on the directions of a [`Scattering`].
#[derive(Clone, Copy, Debug)]
pub enum Ground {
    /// Hiding and shading of directions.
    Covers(Cover),
    /// Directions on its wrong side are folded back.
    Folds(Fold),
}

/// A material that scatters, chosen for the side and point that were hit.
#[derive(Clone, Copy, Debug)]
pub struct Scattering<'a> {
    /// The value.
    pub bsdf: Bsdf<'a>,
    /// True if the model is defined with the normal turned over.
    pub flipped: bool,
    /// Perturbation of the shading normal.
    pub detail: Option<&'a SurfaceDetail>,
    /// Effect of the surface without its detail on directions.
    pub ground: Option<Ground>,
    /// Mean time for which matter holds back the light that it scatters, s.
    pub lifetime: f32,
    /// The medium that light goes into which enters.
    pub below: Option<&'a SubsurfaceMedium>,
}

impl<'a> Scattering<'a> {
    /// Black, to be written over.
    pub const NONE: Self = Self {
        bsdf: Bsdf::Diffuse(Diffuse { reflectance: Spectrum::ZERO }),
        flipped: false,
        detail: None,
        ground: None,
        lifetime: 0.0,
        below: None,
    };

    /// A value on a surface as it is.
    pub fn plain(bsdf: Bsdf<'a>) -> Self {
        Self { bsdf, flipped: false, detail: None, ground: None, lifetime: 0.0, below: None }
    }

    /// [`Bsdf::eval`] with the effect of the ground, for a viewer in `wo`.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> BsdfEval {
        match &self.ground {
            None => self.bsdf.eval(wo, wi, mode),
            Some(Ground::Covers(cover)) => match cover.passes(wi) {
                Some(share) => {
                    let e = self.bsdf.eval(wo, wi, mode);
                    BsdfEval { value: e.value * share, ..e }
                }
                None => BsdfEval::ZERO,
            },
            Some(Ground::Folds(fold)) => fold.eval(&self.bsdf, wo, wi, mode),
        }
    }

    /// The density of [`Scattering::sample`].
    #[inline]
    pub fn pdf(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        match &self.ground {
            Some(Ground::Folds(fold)) => fold.pdf(&self.bsdf, wo, wi, mode),
            _ => self.bsdf.pdf(wo, wi, mode),
        }
    }

    /// [`Bsdf::sample`] with the effect of the ground.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        // Nothing is between the model and who asks for the sample: it is large, and not copied on the way.
        let Some(ground) = &self.ground else { return self.bsdf.sample(wo, u, u2, mode) };
        let drawn = self.bsdf.sample(wo, u, u2, mode)?;
        Some(match ground {
            Ground::Covers(cover) => BsdfSample { weight: drawn.weight * cover.passes(drawn.wi)?, ..drawn },
            Ground::Folds(fold) => fold.drawn(&self.bsdf, wo, drawn, mode),
        })
    }
}

impl Model {
    /// Name of its subsurface transport, if it has any.
    pub(crate) fn below(&self) -> Option<&'static str> {
        let is_followed = |base: &Option<SubsurfaceBase>| base.as_ref().is_some_and(|b| b.medium.is_some());
        match self {
            Self::Subsurface(_) => Some("light that goes below surfaces (material 'subsurface')"),
            Self::Pbr(m) if is_followed(&m.subsurface) => {
                Some("light that goes below surfaces ('subsurface_weight' of material 'openpbr')")
            }
            Self::Principled(m) if is_followed(&m.subsurface) => {
                Some("light that goes below surfaces ('subsurface' of material 'principled')")
            }
            _ => None,
        }
    }

    /// Replaces transport below surfaces and to other wavelengths by the local model that stands in for it.
    pub(crate) fn make_local(&mut self) {
        let diffuse = |base: &mut Option<SubsurfaceBase>| base.iter_mut().for_each(|b| b.medium = None);
        match self {
            Self::Subsurface(m) => *self = Self::TwoSided(m.local, m.local),
            Self::Fluorescent(m) => *self = Self::TwoSided(m.local, m.local),
            Self::Pbr(m) => diffuse(&mut m.subsurface),
            Self::Principled(m) => diffuse(&mut m.subsurface),
            _ => {}
        }
    }
}

impl Material {
    /// A material that scatters as a model does, on a surface as it is.
    pub fn new(model: Model, two_sided: bool) -> Self {
        Self { model, two_sided, detail: None, ambient: None }
    }

    /// Grey, for shapes without a material.
    pub fn default_diffuse() -> Self {
        Self::new(Model::Diffuse(SpectrumTexture::Constant(Color::constant(0.5))), true)
    }

    /// The BSDF at all points if it is the same everywhere, in RGB mode.
    fn constant(&self, textures: &Textures) -> Option<Bsdf<'static>> {
        if self.detail.is_some() || self.needs(&[]).parameters {
            return None;
        }
        let mut lambda = Wavelengths::RGB;
        owned(&self.model, textures, &TextureContext::NOWHERE, &mut lambda).filter(|_| lambda == Wavelengths::RGB)
    }

    /// Surface data that the material needs, given the needs of the materials with smaller indices.
    pub fn needs(&self, before: &[Needs]) -> Needs {
        let constant = |textures: &[&SpectrumTexture]| textures.iter().all(|t| t.is_constant());
        let of = |is_constant: bool, roughness: &Roughness| Needs {
            parameters: !(is_constant && roughness.is_constant()),
            tangent: roughness.is_anisotropic(),
        };
        let isotropic = |is_constant: bool| Needs { parameters: !is_constant, tangent: false };
        let own = match &self.model {
            Model::Diffuse(r) => isotropic(r.is_constant()),
            Model::DiffuseTransmission(r, t) => isotropic(constant(&[r, t])),
            Model::Conductor { eta, k, tint, roughness } => of(constant(&[eta, k, tint]), roughness),
            Model::ConductorReflectance(r, roughness) | Model::Mirror(r, roughness) => of(r.is_constant(), roughness),
            Model::Dielectric { eta, reflectance, transmittance, roughness } => {
                of(eta.is_constant() && constant(&[reflectance, transmittance]), roughness)
            }
            Model::ThinDielectric { eta, reflectance, transmittance } => {
                isotropic(eta.is_constant() && constant(&[reflectance, transmittance]))
            }
            Model::Coated { reflectance, tint, roughness, .. } => of(constant(&[reflectance, tint]), roughness),
            Model::Facets(Facets { roughness, .. }) | Model::Compensated { metal: Metal { roughness, .. }, .. } => {
                of(false, roughness)
            }
            Model::Parametric(p) => Needs { parameters: true, tangent: p.recipe.is_anisotropic },
            Model::Own(own) => Needs { parameters: true, tangent: own.model.is_anisotropic() },
            Model::Fluorescent(_)
            | Model::Grating(_)
            | Model::Hair(_)
            | Model::Layered(_)
            | Model::Measured(_)
            | Model::Pbr(_)
            | Model::Principled(_)
            | Model::Subsurface(_) => Needs::ALL,
            Model::Mix(a, b, amount) => isotropic(amount.is_constant()) | before[*a as usize] | before[*b as usize],
            Model::TwoSided(a, b) => before[*a as usize] | before[*b as usize],
            Model::Interface => Needs::default(),
        };
        let detail = self.detail.as_ref().map_or(Needs::default(), |d| Needs {
            parameters: true,
            tangent: d.normal_map.as_ref().is_some_and(|m| m.filtered.is_some()),
        });
        let ambient = isotropic(self.ambient.as_ref().is_none_or(SpectrumTexture::is_constant));
        let needs = own | detail | ambient;
        // A tangent is had from the parameters.
        Needs { parameters: needs.parameters || needs.tangent, ..needs }
    }
}

/// Data needed at points of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The parametrisation: parameters and derivatives, for textures and tangents.
    pub parameters: bool,
    /// A shading frame that follows the parametrisation.
    pub tangent: bool,
}

impl Needs {
    const ALL: Self = Self { parameters: true, tangent: true };
}

impl std::ops::BitOr for Needs {
    type Output = Self;

    fn bitor(self, o: Self) -> Self {
        Self { parameters: self.parameters | o.parameters, tangent: self.tangent | o.tangent }
    }
}

/// Lookup point of a material's parameters.
struct Point<'p> {
    textures: &'p Textures,
    at: &'p TextureContext<'p>,
    lambda: &'p Wavelengths,
}

impl Point<'_> {
    /// A number; 0 where a texture has none.
    #[inline]
    fn float(&self, t: &FloatTexture) -> f32 {
        let v = t.eval(self.textures, self.at);
        if v.is_finite() { v } else { 0.0 }
    }

    /// A reflectance in [0, 1].
    #[inline]
    fn albedo(&self, t: &SpectrumTexture) -> Spectrum {
        albedo(t.eval(self.textures, self.at, self.lambda))
    }

    /// A quantity that is not negative.
    #[inline]
    fn unbounded(&self, t: &SpectrumTexture) -> Spectrum {
        t.eval(self.textures, self.at, self.lambda).map(|v| if v > 0.0 { v.min(1e30) } else { 0.0 })
    }
}

/// Reflectances beyond [0, 1] and non-finite values from textures are brought back: energy is not made, NaN does not
/// enter.
#[inline]
pub(crate) fn albedo(s: Spectrum) -> Spectrum {
    if s.is_finite() { s.clamp(0.0, 1.0) } else { s.map(|v| if v.is_finite() { v.clamp(0.0, 1.0) } else { 0.0 }) }
}

/// Part of a metal's index of refraction, held where its fourth power is finite; real ones are below 30.
#[inline]
pub(crate) fn optical_constant(s: Spectrum) -> Spectrum {
    s.clamp(0.0, 1e6)
}

/// A relative index of refraction from a texture, held in `[0.05, 20]`; what is none counts as 1.
#[inline]
pub(crate) fn index_of_refraction(v: f32) -> f32 {
    if v.is_nan() || v <= 0.0 { 1.0 } else { v.clamp(0.05, 20.0) }
}

/// Evaluates the material with index `id` at a point: resolves mixtures (`choice` in [0, 1)) and sides (`front`:
/// whether the viewer is on the side of the normal). `None` where nothing scatters.
#[inline]
pub fn scattering<'a>(
    materials: &'a [Material],
    textures: &Textures,
    mut id: u32,
    at: &TextureContext,
    front: bool,
    mut choice: f32,
    lambda: &mut Wavelengths,
) -> Option<Scattering<'a>> {
    let (mut flipped, mut two_sided, mut detail) = (false, false, None);
    // Wrappers refer to materials with smaller indices, so this ends.
    let material = loop {
        let m = &materials[id as usize];
        detail = m.detail.as_ref().or(detail);
        match &m.model {
            Model::Mix(a, b, amount) => {
                let t = amount.eval(textures, at);
                id = if choice < t { *b } else { *a };
                choice = if choice < t { choice / t } else { (choice - t) / (1.0 - t) };
                two_sided |= m.two_sided;
            }
            Model::TwoSided(a, b) => {
                id = if front { *a } else { *b };
                flipped = !front;
                two_sided = true;
            }
            _ => break m,
        }
    };
    let bare = at;
    let rough;
    let at = match detail.and_then(|d| d.hidden_slopes(at)) {
        Some(slopes) => {
            rough = TextureContext { slopes, ..*at };
            &rough
        }
        None => at,
    };
    let spectrum = |t: &SpectrumTexture, lambda: &Wavelengths| albedo(t.eval(textures, at, lambda));
    let (mut lifetime, mut below) = (0.0, None);
    let bsdf = match &material.model {
        Model::Compensated { metal, kind, table } => {
            Bsdf::CompensatedConductor(CompensatedConductor::new(metal.eval(textures, at, lambda), *kind, table))
        }
        Model::Facets(facets) => Bsdf::CookTorrance(facets.eval(textures, at, lambda)),
        Model::Parametric(p) => p.bsdf(textures, at, lambda),
        Model::Own(own) => own.bsdf(textures, at, lambda),
        Model::Coated { reflectance, tint, roughness, table } => {
            let (u, v) = roughness.alpha(textures, at);
            Bsdf::Coated(Coated::new(table, spectrum(reflectance, lambda), spectrum(tint, lambda), u, v))
        }
        Model::Measured(data) => Bsdf::Measured(Measured::new(data, lambda, textures.mode(), at.uv)),
        Model::Hair(m) => m.bsdf(&Point { textures, at, lambda }),
        Model::Fluorescent(m) => m.bsdf(textures, at, choice, lambda, &mut lifetime),
        Model::Grating(m) => m.bsdf(textures, at, lambda),
        Model::Layered(m) => m.bsdf(textures, at, lambda),
        Model::Pbr(m) => {
            below = m.subsurface.as_ref().and_then(|s| s.medium.as_ref());
            // The spread of the base's map is no roughness of a coat that does not follow it.
            let coat_at = if detail.is_some_and(|d| d.coat.is_some()) { bare } else { at };
            m.bsdf(textures, at, coat_at, lambda)
        }
        Model::Principled(m) => {
            below = m.subsurface.as_ref().and_then(|s| s.medium.as_ref());
            m.bsdf(&Point { textures, at, lambda })
        }
        Model::Subsurface(m) => {
            below = Some(&m.medium);
            m.bsdf(&Point { textures, at, lambda })
        }
        model => owned(model, textures, at, lambda)?,
    };
    let turns = !front && !flipped && !bsdf.has_transmission() && (two_sided || material.two_sided);
    Some(Scattering { flipped: flipped || turns, detail, lifetime, below, ..Scattering::plain(bsdf) })
}

/// The BSDF of one side of a material, the same at all points and wavelengths; true if the normal is turned over.
pub type Constant = (Bsdf<'static>, bool);

/// The constant BSDFs of the back and the front of each material; `None` if they vary.
pub(crate) fn constants(materials: &[Material], textures: &Textures) -> Vec<[Option<Constant>; 2]> {
    let constant = |material: &Material, front: bool| {
        if textures.mode() != ColorMode::Rgb || material.detail.is_some() {
            return None;
        }
        match &material.model {
            Model::Mix(..) => None,
            Model::TwoSided(a, b) => {
                let side = &materials[if front { *a } else { *b } as usize];
                let is_wrapper = matches!(side.model, Model::Mix(..) | Model::TwoSided(..));
                if is_wrapper { None } else { Some((side.constant(textures)?, !front)) }
            }
            _ => {
                let bsdf = material.constant(textures)?;
                Some((bsdf, !front && !bsdf.has_transmission() && material.two_sided))
            }
        }
    };
    materials.iter().map(|m| [constant(m, false), constant(m, true)]).collect()
}

/// A material whose sides reflect by Lambert's law, the same everywhere.
#[derive(Clone, Debug)]
pub struct Lambertian {
    /// Albedo of the back and the front, and true if the normal is turned over there.
    sides: [(Color, bool); 2],
}

impl Lambertian {
    /// The reflectance of a side, and whether the normal is turned over there.
    #[inline]
    pub fn side(&self, front: bool, lambda: &Wavelengths) -> (Spectrum, bool) {
        let (color, is_turned) = &self.sides[usize::from(front)];
        (albedo(color.eval(lambda)), *is_turned)
    }

    /// True if nothing is reflected.
    pub(crate) fn is_black(&self) -> bool {
        self.sides.iter().all(|(color, _)| color.is_black())
    }
}

/// Lambertian description of each material; `None` for all others.
pub(crate) fn lambertian(materials: &[Material]) -> Vec<Option<Lambertian>> {
    let side = |material: &Material, front: bool| {
        let (side, is_turned) = match &material.model {
            Model::TwoSided(a, b) => (&materials[if front { *a } else { *b } as usize], !front),
            _ => (material, !front && material.two_sided),
        };
        match &side.model {
            Model::Diffuse(SpectrumTexture::Constant(color)) if material.detail.is_none() && side.detail.is_none() => {
                Some((color.clone(), is_turned))
            }
            _ => None,
        }
    };
    materials.iter().map(|m| Some(Lambertian { sides: [side(m, false)?, side(m, true)?] })).collect()
}

/// The value of a model that refers to no table; `None` for others.
#[inline]
fn owned(model: &Model, textures: &Textures, at: &TextureContext, lambda: &mut Wavelengths) -> Option<Bsdf<'static>> {
    let spectrum = |t: &SpectrumTexture, lambda: &Wavelengths| albedo(t.eval(textures, at, lambda));
    Some(match model {
        Model::Diffuse(r) => Bsdf::Diffuse(Diffuse { reflectance: spectrum(r, lambda) }),
        Model::DiffuseTransmission(r, t) => {
            let (r, t) = (spectrum(r, lambda), spectrum(t, lambda));
            let over = (r + t).max_element().max(1.0);
            Bsdf::DiffuseTransmission(DiffuseTransmission { reflectance: r / over, transmittance: t / over })
        }
        Model::Conductor { eta, k, tint, roughness } => Bsdf::Conductor(Conductor {
            eta: optical_constant(eta.eval(textures, at, lambda)),
            k: optical_constant(k.eval(textures, at, lambda)),
            tint: spectrum(tint, lambda),
            microfacet: roughness.microfacet(textures, at),
        }),
        Model::ConductorReflectance(r, roughness) => {
            Bsdf::Conductor(Conductor::from_reflectance(spectrum(r, lambda), roughness.microfacet(textures, at)))
        }
        Model::Mirror(r, roughness) => {
            Bsdf::Conductor(Conductor::mirror(spectrum(r, lambda), roughness.microfacet(textures, at)))
        }
        Model::Dielectric { eta, reflectance, transmittance, roughness } => Bsdf::Dielectric(Dielectric {
            eta: eta.eval(textures, at, lambda),
            reflectance: spectrum(reflectance, lambda),
            transmittance: spectrum(transmittance, lambda),
            microfacet: roughness.microfacet(textures, at),
        }),
        Model::ThinDielectric { eta, reflectance, transmittance } => Bsdf::ThinDielectric(ThinDielectric {
            eta: eta.eval(textures, at, lambda),
            reflectance: spectrum(reflectance, lambda),
            transmittance: spectrum(transmittance, lambda),
        }),
        _ => return None,
    })
}
