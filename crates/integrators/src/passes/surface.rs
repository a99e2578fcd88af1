//! Surfaces where subpaths scatter.
//!
//! The surface that a camera sees may depend on the viewpoint: normal and bump maps turn the shading normal by the
//! viewer (`SurfaceDetail`), and curves turn towards the ray. The light that a path carries is that of the camera's
//! side, whichever way the path was found:
//!
//! - With **detail** both sides have a shading frame of their own. Values are those of the camera's frame; a light
//!   subpath draws directions by its own frame, and some evenly about the surface as it is, since its frame may leave
//!   out what the camera's has.
//! - **Curves** that face the ray are met at other points from the other side: light subpaths end there, and what
//!   weighs the ways to find a path knows it.

use super::vertex::{Drawn, Scattered};
use crate::nee;
use std::f32::consts::FRAC_1_PI;
use steradian_bsdf::{BsdfEval, BsdfSample, Lobe, TransportMode};
use steradian_core::{
    Scene,
    light::LightContext,
    material::{Ground, Scattering},
    scene::Interaction,
};
use steradian_math::{Frame, Spectrum, Vec2, Vec3, spectra::Wavelengths, warp};

/// Dependence of a surface on the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum View {
    /// No dependence.
    Fixed,
    /// Its shading normal does.
    Detail,
    /// The points at which it is met do.
    Curve,
}

/// A surface where a subpath scatters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface<'s> {
    pub i: Interaction,
    pub scattering: Scattering<'s>,
    pub frame: Frame,
    pub view: View,
    /// The probability with which rays meet the surface.
    pub opacity: f32,
    /// Random number of the choice among the materials of a mixture.
    choice: f32,
}

/// The share of directions that light subpaths draw evenly where the shading normal depends on the viewer.
const EVEN: f32 = 0.125;

/// Scattering and its frame, as seen from one side.
type Side<'s> = (Scattering<'s>, Frame);

/// Scene and wavelengths of an evaluation.
type Shown<'a, 'l> = (&'a Scene, &'l Wavelengths);

impl<'s> Surface<'s> {
    /// Surface that a subpath met.
    pub fn new(scene: &'s Scene, i: Interaction, (scattering, frame): Side<'s>, choice: f32) -> Self {
        // Kinds of surfaces that look different from the camera's side and from the light's.
        let view = if scene.faces_rays(i.geometry) {
            View::Curve
        } else if scattering.detail.is_some_and(|d| d.depends_on_viewer()) {
            View::Detail
        } else {
            View::Fixed
        };
        let opacity = scene.opacity(&i);
        Self { i, scattering, frame, view, opacity, choice }
    }

    /// The part of the light that goes straight through, as if there were nothing.
    pub fn straight_transmission(&self) -> Option<Spectrum> {
        self.scattering.bsdf.straight_transmission(self.frame.to_local(self.i.wo))
    }

    /// The surface seen from another side.
    fn seen_from<'a>(&self, (scene, lambda): Shown<'a, '_>, w: Vec3) -> Option<Side<'a>> {
        scene.scattering(&Interaction { wo: w, ..self.i }, self.choice, &mut lambda.clone())
    }

    /// Scattering from where the subpath came towards `w`; `None` where it is nothing.
    #[inline]
    pub fn eval(&self, shown: Shown<'_, '_>, w: Vec3, mode: TransportMode) -> Option<Scattered> {
        let own = (self.scattering, self.frame);
        // One frame for both sides: value, density, and density of the reverse direction.
        if self.view != View::Detail {
            let (s, frame) = &own;
            let (wo, wi) = (frame.to_local(self.i.wo), frame.to_local(w));
            let e = self.value(&own, self.i.wo, w, mode);
            let reverse = || s.bsdf.pdf(wi, wo, mode.adjoint());
            return is_light(e.value).then(|| Scattered { value: e.value, pdf: e.pdf, reverse: reverse() });
        }
        // Two frames: values go by the camera's, densities by the frame of each subpath.
        let other = self.seen_from(shown, w)?;
        let (camera, light, to_camera, to_light) = match mode {
            TransportMode::Radiance => (&own, &other, self.i.wo, w),
            TransportMode::Importance => (&other, &own, w, self.i.wo),
        };
        let e = self.value(camera, self.i.wo, w, mode);
        if !is_light(e.value) {
            return None;
        }
        let from_camera = pdf(camera, to_camera, to_light, TransportMode::Radiance);
        let from_light = self.light_pdf(light, to_light, to_camera);
        let (pdf, reverse) = match mode {
            TransportMode::Radiance => (from_camera, from_light),
            TransportMode::Importance => (from_light, from_camera),
        };
        Some(Scattered { value: e.value, pdf, reverse })
    }

    /// `f |cos|` for what is carried, by the camera's side of the surface.
    #[inline]
    fn value(&self, (s, frame): &Side<'_>, from: Vec3, to: Vec3, mode: TransportMode) -> BsdfEval {
        let (wo, wi) = (frame.to_local(from), frame.to_local(to));
        if mode == TransportMode::Radiance {
            return s.eval(wo, wi, mode);
        }
        // The ground hides, or folds, the light's directions: `wi` for radiance, `wo` for importance.
        let lit = |wo: Vec3, share: f32| {
            let e = s.bsdf.eval(wo, wi, mode);
            BsdfEval { value: e.value * (share * self.adjoint(frame, wo.z, to)), ..e }
        };
        // Importance: the adjoint BSDF with its correction for shading normals, under the occlusion of bumps.
        match &s.ground {
            None => lit(wo, 1.0),
            Some(Ground::Covers(cover)) => cover.passes(wo).map_or(BsdfEval::ZERO, |share| lit(wo, share)),
            Some(Ground::Folds(fold)) => {
                let values = fold.sources(wi, wo).into_iter().flatten().map(|w| lit(w, 1.0));
                values.fold(BsdfEval::ZERO, |sum, e| BsdfEval { value: sum.value + e.value, pdf: sum.pdf + e.pdf })
            }
        }
    }

    /// Correction of importance for shading normals, `|wo·ns| |wi·ng| / (|wo·ng| |wi·ns|)` (Veach 1997, eq. 5.19), with
    /// `wo·ns` of the direction that the model is asked for.
    #[inline]
    fn adjoint(&self, frame: &Frame, cos_o: f32, wi: Vec3) -> f32 {
        let (n, ns, wo) = (self.i.surface.n, frame.z, self.i.wo);
        if n == ns || n == -ns {
            return 1.0;
        }
        let below = n.dot(wo) * ns.dot(wi);
        if below == 0.0 { 0.0 } else { (cos_o * n.dot(wi) / below).abs() }
    }

    /// The density with which a light subpath draws directions where the shading normal depends on the viewer.
    fn light_pdf(&self, side: &Side<'_>, wo: Vec3, wi: Vec3) -> f32 {
        // Mixture density of model and even draws.
        (1.0 - EVEN) * pdf(side, wo, wi, TransportMode::Importance) + EVEN * self.even_pdf(&side.0, wo, wi)
    }

    /// The density of even draws: by the cosine about the normal without detail, on the sides to which the model
    /// scatters.
    fn even_pdf(&self, s: &Scattering<'_>, wo: Vec3, wi: Vec3) -> f32 {
        let n = self.i.surface.ns;
        let cos = n.dot(wi).abs() * FRAC_1_PI;
        // cosθ/π on one side, or half of it on both.
        match (s.bsdf.has_transmission(), n.dot(wo) * n.dot(wi) > 0.0) {
            (true, _) => 0.5 * cos,
            (false, true) => cos,
            (false, false) => 0.0,
        }
    }

    /// An even draw.
    fn draw_even(&self, u: f32, u2: Vec2) -> Vec3 {
        let n = self.i.surface.ns;
        let up = if n.dot(self.i.wo) < 0.0 { -n } else { n };
        let crosses = self.scattering.bsdf.has_transmission() && u < 0.5;
        let z = if crosses { -up } else { up };
        Frame::from_z(z).to_world(warp::cosine_hemisphere(u2))
    }

    /// A direction to go on in.
    pub fn sample(&self, shown: Shown<'_, '_>, u: f32, u2: Vec2, mode: TransportMode) -> Option<Drawn> {
        // Camera and light subpaths differ only where the shading normal depends on the viewer.
        match (self.view, mode) {
            (View::Detail, TransportMode::Importance) => self.sample_by_light(shown, u, u2),
            (View::Detail, TransportMode::Radiance) => self.sample_by_camera(shown, u, u2),
            _ => {
                let wo = self.frame.to_local(self.i.wo);
                let s = self.drawn(u, u2, mode)?;
                let wi = self.frame.to_world(s.wi);
                let back = || self.scattering.bsdf.pdf(s.wi, wo, mode.adjoint());
                Some(Drawn {
                    wi,
                    weight: if mode == TransportMode::Radiance {
                        s.weight
                    } else {
                        s.weight * self.adjoint(&self.frame, wo.z, wi)
                    },
                    eta: s.eta,
                    densities: (!s.lobe.is_specular()).then(|| (s.pdf, back())),
                    is_two_way: true,
                    is_transmission: s.lobe.is_transmission(),
                })
            }
        }
    }

    /// A sample of the model in its own frame, with the effect of the ground.
    #[inline]
    fn drawn(&self, u: f32, u2: Vec2, mode: TransportMode) -> Option<BsdfSample> {
        let (s, wo) = (&self.scattering, self.frame.to_local(self.i.wo));
        match (mode, &s.ground) {
            (TransportMode::Importance, Some(Ground::Covers(cover))) => {
                let drawn = s.bsdf.sample(wo, u, u2, mode)?;
                Some(BsdfSample { weight: drawn.weight * cover.passes(wo)?, ..drawn })
            }
            _ => s.sample(wo, u, u2, mode),
        }
    }

    fn sample_by_camera(&self, shown: Shown<'_, '_>, u: f32, u2: Vec2) -> Option<Drawn> {
        // By the camera's own frame; the reverse density is that of the light's frame and its even draws.
        let s = self.drawn(u, u2, TransportMode::Radiance)?;
        let wi = self.frame.to_world(s.wi);
        let light = self.seen_from(shown, wi);
        let is_specular = s.lobe.is_specular();
        // Where the frames differ, or the direction is folded, a light subpath is not mirrored into this way.
        let is_mirrored =
            || !s.lobe.contains(Lobe::FOLDED) && light.as_ref().is_some_and(|(_, frame)| same(frame, &self.frame));
        let is_two_way = !is_specular || is_mirrored();
        let back = || light.as_ref().map_or(0.0, |side| self.light_pdf(side, wi, self.i.wo));
        let densities = (!is_specular).then(|| (s.pdf, back()));
        let is_transmission = s.lobe.is_transmission();
        Some(Drawn { wi, weight: s.weight, eta: s.eta, densities, is_two_way, is_transmission })
    }

    fn sample_by_light(&self, shown: Shown<'_, '_>, u: f32, u2: Vec2) -> Option<Drawn> {
        const MODE: TransportMode = TransportMode::Importance;
        let own = (self.scattering, self.frame);
        // One of two techniques by a share of the random number: even about the surface, or by the light's own frame.
        let (wi, eta, is_transmission) = if u < EVEN {
            (self.draw_even(u / EVEN, u2), 1.0, false)
        } else {
            let s = self.drawn((u - EVEN) / (1.0 - EVEN), u2, MODE)?;
            let wi = self.frame.to_world(s.wi);
            // A specular direction counts only where the camera's frame mirrors it in the same way.
            if s.lobe.is_specular() {
                let (_, frame) = self.seen_from(shown, wi)?;
                let cos_o = self.frame.z.dot(self.i.wo);
                let weight = s.weight * (self.adjoint(&self.frame, cos_o, wi) / (1.0 - EVEN));
                let is_two_way = same(&frame, &self.frame) && !s.lobe.contains(Lobe::FOLDED);
                let is_transmission = s.lobe.is_transmission();
                return is_two_way.then_some(Drawn {
                    wi,
                    weight,
                    eta: s.eta,
                    densities: None,
                    is_two_way,
                    is_transmission,
                });
            }
            (wi, s.eta, s.lobe.is_transmission())
        };
        // Value by the camera's frame over the mixture density.
        let camera = self.seen_from(shown, wi)?;
        let value = self.value(&camera, self.i.wo, wi, MODE).value;
        let density = self.light_pdf(&own, self.i.wo, wi);
        let weight = value / density;
        (density > 0.0 && is_light(weight)).then(|| Drawn {
            wi,
            weight,
            eta,
            densities: Some((density, pdf(&camera, wi, self.i.wo, TransportMode::Radiance))),
            is_two_way: true,
            is_transmission,
        })
    }

    /// Reference point for light sampling: the same from both sides.
    #[inline]
    pub fn context(&self) -> LightContext {
        match self.view {
            View::Detail => LightContext { p: self.i.surface.p, n: Vec3::ZERO },
            _ => nee::context(&self.i, &self.frame, &self.scattering.bsdf),
        }
    }
}

/// The density with which one side's model draws a direction.
fn pdf((s, frame): &Side<'_>, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
    s.pdf(frame.to_local(wo), frame.to_local(wi), mode)
}

/// True if two frames have one normal.
fn same(a: &Frame, b: &Frame) -> bool {
    a.z.dot(b.z) > 1.0 - 1e-6
}

fn is_light(value: Spectrum) -> bool {
    !value.is_black() && value.is_finite()
}
