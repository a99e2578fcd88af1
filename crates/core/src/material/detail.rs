//! Surface detail by the shading frame: normal maps, bump maps, and the turn of the tangent that stretched highlights
//! follow.
//!
//! Detail changes the shading normal before the frame is made, and then bends it back so far that the mirror direction
//! leaves the surface. Displacement is geometry instead: it splits and moves triangles when the mesh is compiled
//! (`shape::displacement`). `relief` traces height fields without geometry.

// Comparisons are negated on purpose: NaN takes the way of the exception.
#![expect(clippy::neg_cmp_op_on_partial_ord, reason = "a NaN takes the branch, too")]

use super::{Fold, Ground, normal_map::NormalMap};
use steradian_math::{Frame, Vec2, Vec3, transform::Affine};
use steradian_texture::{FloatTexture, TextureContext, TextureId, Textures};

/// Treatment of a shading normal that surface detail has turned away from the viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Facing {
    /// Opaque materials: bent until the mirror direction leaves the surface. Materials that transmit: mirrored about
    /// the geometric normal, and directions on the wrong side are folded back ([`Fold`]); bent normals would make total
    /// internal reflection grazing, again and again, and trap light in a body.
    #[default]
    Bent,
    /// Opaque materials: as [`Facing::Bent`]. Materials that transmit: unchanged, and directions on the wrong side leak
    /// through the surface, as with pbrt.
    Leaking,
    /// The shading normal is mirrored about the normal without detail, and light from below the surface does not count
    /// (Mitsuba 3; Schüßler et al., "Microfacet-based normal mapping for robust Monte Carlo path tracing", 2017).
    Turned,
    /// The shading normal is unchanged; light from below the surface does not count.
    AsItIs,
}

/// Perturbation of a material's shading frame.
#[derive(Clone, Debug, Default)]
pub struct SurfaceDetail {
    /// Treatment of normals that face away.
    pub facing: Facing,
    /// Enables shading of light from near the horizon by the bumps it has to pass ([`Cover`]); not of bent normals.
    pub shadows: bool,
    /// A normal map.
    pub normal_map: Option<NormalMap>,
    /// Heights along the normal, in scene units.
    pub bump: Option<FloatTexture>,
    /// Degrees that the tangent is turned from ∂p/∂u towards ∂p/∂v, before anything is stretched along it.
    pub rotation: Option<FloatTexture>,
    /// Direction of the tangent before that turn: along ∂p/∂u and towards ∂p/∂v, each from −1 to 1 as 0 to 1.
    pub direction: Option<TextureId>,
    /// Normals of a clear coat that are its own; it has those of its base without.
    pub coat: Option<CoatNormals>,
}

/// Normals of a clear coat that do not follow the maps of its base.
#[derive(Clone, Debug)]
pub enum CoatNormals {
    /// Normals of the surface.
    Surface,
    /// Normals of a map on the surface.
    Mapped(Box<NormalMap>),
}

/// The surface that detail is put on.
#[derive(Clone, Copy, Debug)]
pub struct Base {
    /// Unit geometric normal.
    pub n: Vec3,
    /// Unit shading normal, on the same side.
    pub ns: Vec3,
    /// ∂p/∂u; may be zero.
    pub dpdu: Vec3,
    /// ∂p/∂v; may be zero.
    pub dpdv: Vec3,
    /// The tangent that normal maps were made for, and the sign of the bitangent, where the mesh has them.
    pub tangent: Option<(Vec3, f32)>,
    /// From the space of the object to the world, where normal maps ask for it; `None` if they are the same.
    pub object: Option<Affine>,
}

impl Base {
    /// The frame of normal maps, and whether their y is to be turned over: z along the shading normal, and x along the
    /// tangent. `mirrors`: y follows ∂p/∂v where the parametrisation is mirrored.
    pub fn tangent_frame(&self, mirrors: bool) -> (Frame, bool) {
        match self.tangent {
            Some((tangent, sign)) => (Frame::from_zx(self.ns, tangent), sign < 0.0),
            None => {
                let frame = Frame::from_zx(self.ns, self.dpdu);
                (frame, mirrors && frame.y.dot(self.dpdv) < 0.0)
            }
        }
    }
}

/// The step of differences where the footprint gives none (pbrt-v4's).
const STEP: f32 = 0.0005;
/// The step of differences that stand for derivatives.
const EXACT: f32 = 1e-4;

impl SurfaceDetail {
    /// The variance of slopes along both axes that the footprint hides, where it is to count as roughness.
    #[inline]
    pub fn hidden_slopes(&self, at: &TextureContext) -> Option<Vec2> {
        Some(self.normal_map.as_ref()?.filtered.as_ref()?.normal(at).1)
    }

    /// True if the shading normal may depend on the viewing direction.
    #[inline]
    pub fn depends_on_viewer(&self) -> bool {
        self.facing != Facing::AsItIs && self.bends_normals()
    }

    /// True if maps change the normal of the base or of its coat.
    pub fn bends_normals(&self) -> bool {
        self.normal_map.is_some() || self.bump.is_some() || matches!(self.coat, Some(CoatNormals::Mapped(_)))
    }

    /// The normal of a clear coat, unit length, for a viewer in `wo`; `None` if it is that of the base.
    pub fn coat_normal(&self, textures: &Textures, at: &TextureContext, base: &Base, wo: Vec3) -> Option<Vec3> {
        Some(match self.coat.as_ref()? {
            CoatNormals::Surface => base.ns,
            // A coat reflects alone, whatever is below.
            CoatNormals::Mapped(map) => self.faced(map.normal(textures, at, base, self.bends()), base, wo, false),
        })
    }

    /// The shading normal with the detail, unit length, for a viewer in `wo`. `transmits`: the material lets light
    /// through.
    pub fn shading_normal(
        &self,
        textures: &Textures,
        at: &TextureContext,
        base: &Base,
        wo: Vec3,
        transmits: bool,
    ) -> Vec3 {
        if self.normal_map.is_none() && self.bump.is_none() {
            return base.ns;
        }
        let mut ns = base.ns;
        if let Some(map) = &self.normal_map {
            ns = map.normal(textures, at, base, self.bends());
        }
        if let Some(height) = &self.bump {
            ns = bumped(height, textures, at, &Base { ns, ..*base }, !self.bends());
        }
        self.faced(ns, base, wo, transmits)
    }

    /// A normal with detail as the viewer in `wo` has it, by what is done with normals that face away.
    fn faced(&self, ns: Vec3, base: &Base, wo: Vec3, transmits: bool) -> Vec3 {
        let mirrored = |n: Vec3| if n.dot(wo) * ns.dot(wo) <= 0.0 { n * (2.0 * n.dot(ns)) - ns } else { ns };
        match self.facing {
            Facing::Bent if transmits => mirrored(base.n),
            Facing::Leaking if transmits => ns,
            Facing::Bent | Facing::Leaking => {
                let side = if base.ns.dot(wo) < 0.0 { -1.0 } else { 1.0 };
                bend(ns * side, base.n * side, wo) * side
            }
            Facing::Turned => mirrored(base.ns),
            Facing::AsItIs => ns,
        }
    }

    /// Normals turned away from the viewer are bent, on opaque materials.
    fn bends(&self) -> bool {
        matches!(self.facing, Facing::Bent | Facing::Leaking)
    }

    /// The effect of the surface without detail on directions, in the shading frame with it. `transmits`: the material
    /// lets light through.
    pub fn ground(&self, base: &Base, frame: &Frame, flipped: bool, transmits: bool) -> Option<Ground> {
        if self.normal_map.is_none() && self.bump.is_none() {
            return None;
        }
        let up = |n: Vec3| frame.to_local(if flipped { -n } else { n });
        match self.facing {
            Facing::Leaking => None,
            Facing::Bent => transmits.then(|| Ground::Folds(Fold { n: up(base.n) })),
            Facing::Turned | Facing::AsItIs => {
                let up = up(base.ns);
                let roughness2 = if self.shadows { (0.125 * tan2(up.z)).min(1.0) } else { 0.0 };
                Some(Ground::Covers(Cover { up, roughness2 }))
            }
        }
    }
}

/// `tan²` of an angle by its cosine.
fn tan2(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0) / (cos * cos)
}

/// The surface under the detail: light comes and goes on one side of both, and Smith's shadowing takes the terminator
/// away that the detail would have (Conty Estevez, Lecocq, Stein, "A microfacet-based shadowing function to solve the
/// bump terminator problem", Ray Tracing Gems, 2019, ch. 12).
#[derive(Clone, Copy, Debug)]
pub struct Cover {
    /// The normal without detail, in the shading frame with it.
    up: Vec3,
    /// α² of a surface of which the detail's normal is a typical one: tan²/8 of the angle between both normals, at most
    /// 1.
    roughness2: f32,
}

impl Cover {
    /// The share of light from a direction that arrives, `2/(1 + √(1 + α² tan²θ))`; `None` where the direction is above
    /// the one surface and below the other.
    #[inline]
    pub fn passes(&self, wi: Vec3) -> Option<f32> {
        let cos = self.up.dot(wi);
        (cos * wi.z > 0.0).then(|| 2.0 / (1.0 + (1.0 + self.roughness2 * tan2(cos)).sqrt()))
    }
}

impl SurfaceDetail {
    /// ∂p/∂u, or where the detail turns it.
    pub fn tangent(&self, textures: &Textures, at: &TextureContext, base: &Base) -> Vec3 {
        let mut angle = self.rotation.as_ref().map_or(0.0, |r| r.eval(textures, at).to_radians());
        // Directions are filtered as vectors: the mean of 1° and 359° is no half turn.
        if let Some(direction) = self.direction {
            let d = textures.rgb(direction, at) * 2.0 - 1.0;
            angle += d.y.atan2(d.x);
        }
        if angle == 0.0 || !angle.is_finite() {
            return base.dpdu;
        }
        let t = base.dpdu.reject_from_normalized(base.ns).normalize_or_zero();
        let across = base.ns.cross(t);
        let side = if across.dot(base.dpdv) < 0.0 { -1.0 } else { 1.0 };
        t * angle.cos() + across * (side * angle.sin())
    }
}

/// The normal of the surface moved by heights along `ns`, with differences over half the footprint: Blinn, "Simulation
/// of Wrinkled Surfaces", SIGGRAPH 1978, without the curvature of the surface that is moved. `exact` are differences
/// over as little as numbers allow, on both sides.
fn bumped(height: &FloatTexture, textures: &Textures, at: &TextureContext, base: &Base, exact: bool) -> Vec3 {
    let FloatTexture::Texture(id) = *height else { return base.ns };
    // Without a parametrisation heights vary over space alone; any two tangents serve.
    let area = base.dpdu.cross(base.dpdv).length();
    let degenerate = !(area > 1e-12 * base.dpdu.length() * base.dpdv.length()) || !area.is_finite();
    let frame = Frame::from_z(base.ns);
    let (dpdu, dpdv) = if degenerate { (frame.x, frame.y) } else { (base.dpdu, base.dpdv) };
    let f = &at.footprint;
    let here = textures.float(id, at);
    let slope = |axis: usize, dp: Vec3| {
        let step = 0.5 * (f.duvdx[axis].abs() + f.duvdy[axis].abs());
        let step = if step > 0.0 && step.is_finite() { step.clamp(1e-6, 0.5) } else { STEP };
        let moved = |step: f32| {
            let mut duv = Vec2::ZERO;
            duv[axis] = if degenerate { 0.0 } else { step };
            let mesh = at.mesh.map(|(m, t, b)| (m, t, if degenerate { b } else { b + m.barycentric_change(t, duv) }));
            textures.float(id, &TextureContext { p: at.p + dp * step, uv: at.uv + duv, mesh, ..*at })
        };
        if exact { (moved(EXACT) - moved(-EXACT)) / (2.0 * EXACT) } else { (moved(step) - here) / step }
    };
    let (hu, hv) = (slope(0, dpdu), slope(1, dpdv));
    let tangent = |dp: Vec3, h: f32| dp + base.ns * (h - base.ns.dot(dp));
    let n = tangent(dpdu, hu).cross(tangent(dpdv, hv));
    let n = n.normalize_or(base.ns);
    if !n.is_finite() {
        return base.ns;
    }
    if n.dot(base.ns) < 0.0 { -n } else { n }
}

/// Least cosine of the mirror direction above the surface.
const ABOVE: f32 = 0.01;

/// The shading normal, bent so far that the mirror direction of `wo` lies above the surface (Keller et al., "The Iray
/// Light Transport Simulation and Rendering System", 2017, appendix A.3): a normal that turns away from the viewer
/// would otherwise leave black rims. `n` and `ns` are on the side of `wo`; a viewer below the surface leaves it
/// unchanged.
pub fn bend(ns: Vec3, n: Vec3, wo: Vec3) -> Vec3 {
    let cos = wo.dot(n);
    if cos <= 0.0 {
        return ns;
    }
    let r = ns * (2.0 * ns.dot(wo)) - wo;
    let least = ABOVE.min(0.9 * cos);
    let above = r.dot(n);
    if above >= least {
        return ns;
    }
    let along = (r - n * above).normalize_or_zero();
    if along == Vec3::ZERO {
        return n;
    }
    let r = along * (1.0 - least * least).sqrt() + n * least;
    (wo + r).normalize_or(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{NormalSpace, normal_code::NormalCode};
    use std::sync::Arc;
    use steradian_math::{
        hash::HashRng,
        spectra::{ColorMode, role::Color},
    };
    use steradian_texture::{Footprint, Mapping, Pattern, PatternTexture, Texture, mapping::Projector};

    fn at(uv: Vec2) -> TextureContext<'static> {
        TextureContext::new(uv.extend(0.0), uv)
    }

    const FLAT: Base = Base { n: Vec3::Z, ns: Vec3::Z, dpdu: Vec3::X, dpdv: Vec3::Y, tangent: None, object: None };

    /// Textures with a map of constant (x, y, z) in [−1, 1].
    fn map(n: Vec3) -> (Textures, SurfaceDetail) {
        let mut textures = Textures::new(ColorMode::Rgb);
        let c = (n + 1.0) * 0.5;
        let texture = textures.add(Texture::Constant(Color::Lanes(steradian_math::Spectrum::rgb(c.x, c.y, c.z))));
        let (code, space) = (NormalCode::Xyz, NormalSpace::Tangent);
        let map = NormalMap { texture, code, space, mirrors: true, strength: 1.0, filtered: None, over: None };
        (textures, SurfaceDetail { normal_map: Some(map), ..SurfaceDetail::default() })
    }

    #[test]
    fn a_flat_map_changes_nothing() {
        let (textures, detail) = map(Vec3::Z);
        let mut rng = HashRng::new(1);
        for _ in 0..50 {
            let mut d = || Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5).normalize();
            let (n, dpdu) = (d(), d());
            let base = Base { n, ns: n, dpdu, dpdv: n.cross(dpdu), tangent: None, object: None };
            assert!((detail.shading_normal(&textures, &at(Vec2::ZERO), &base, n, false) - n).length() < 1e-6);
        }
    }

    /// Counter-clockwise seen from the normal, or as the parametrisation is mirrored; alone it leaves the normal as it
    /// is.
    #[test]
    fn the_tangent_turns_towards_the_bitangent() {
        let textures = Textures::new(ColorMode::Rgb);
        let turned = |degrees: f32, base: &Base| {
            let rotation = Some(FloatTexture::Constant(degrees));
            let detail = SurfaceDetail { rotation, ..SurfaceDetail::default() };
            let at = at(Vec2::ZERO);
            let grazing = Vec3::new(1.0, 0.0, 1e-3).normalize();
            assert_eq!(detail.shading_normal(&textures, &at, base, grazing, false), base.ns);
            detail.tangent(&textures, &at, base)
        };
        let near = |a: Vec3, b: Vec3| assert!((a - b).length() < 1e-6, "{a} {b}");
        near(turned(90.0, &FLAT), Vec3::Y);
        near(turned(-30.0, &FLAT), Vec3::new(0.75f32.sqrt(), -0.5, 0.0));
        near(turned(90.0, &Base { dpdv: -Vec3::Y, ..FLAT }), -Vec3::Y);
        let leaning = Base { dpdu: Vec3::new(2.0, 0.0, 5.0), ..FLAT };
        near(turned(180.0, &leaning), -Vec3::X);
        assert_eq!(turned(0.0, &leaning), leaning.dpdu);
    }

    /// The same direction everywhere is a turn by its angle; the mean of two directions lies between them, also across
    /// the half turn.
    #[test]
    fn directions_turn_the_tangent_as_angles_do() {
        let mut textures = Textures::new(ColorMode::Rgb);
        let mut tangent = |direction: Vec2, degrees: f32| {
            let c = (direction + 1.0) * 0.5;
            let color = Color::Lanes(steradian_math::Spectrum::rgb(c.x, c.y, 0.3));
            let direction = Some(textures.add(Texture::Constant(color)));
            let rotation = Some(FloatTexture::Constant(degrees));
            let detail = SurfaceDetail { rotation, direction, ..SurfaceDetail::default() };
            let mirrored = Base { dpdv: -Vec3::Y, ..FLAT };
            [&FLAT, &mirrored].map(|base| detail.tangent(&textures, &at(Vec2::ZERO), base))
        };
        let near = |a: Vec3, b: Vec3| assert!((a - b).length() < 2e-6, "{a} {b}");
        for (angle, turn) in [(0.0f32, 0.0f32), (0.5, 0.0), (2.0, 40.0), (-3.0, -70.0), (3.1, 300.0)] {
            let (s, c) = (angle + turn.to_radians()).sin_cos();
            let [plain, mirrored] = tangent(Vec2::from_angle(angle), turn);
            near(plain, Vec3::new(c, s, 0.0));
            near(mirrored, Vec3::new(c, -s, 0.0));
        }
        let mean = 0.5 * (Vec2::from_angle(3.0) + Vec2::from_angle(-3.0));
        near(tangent(mean, 0.0)[0], -Vec3::X);
        // No direction at all is that of the parametrisation.
        near(tangent(Vec2::ZERO, 0.0)[0], Vec3::X);
    }

    /// The coat's map and the base's give two normals; without a map of its own the coat has the surface's, or none.
    #[test]
    fn a_coat_has_normals_of_its_own() {
        let (tilted, leaning) = (Vec3::new(0.6, 0.0, 0.8), Base { ns: Vec3::new(0.0, 0.28, 0.96), ..FLAT });
        let (textures, mut detail) = map(tilted);
        let wo = Vec3::Z;
        let seen = |detail: &SurfaceDetail, base: &Base| detail.coat_normal(&textures, &at(Vec2::ZERO), base, wo);
        assert_eq!(seen(&detail, &FLAT), None);
        detail.coat = Some(CoatNormals::Surface);
        assert_eq!(seen(&detail, &leaning), Some(leaning.ns));
        let base_normal = detail.shading_normal(&textures, &at(Vec2::ZERO), &FLAT, wo, false);
        let own = detail.normal_map.take().map(|m| NormalMap { strength: 0.5, ..m });
        detail.coat = own.map(|m| CoatNormals::Mapped(Box::new(m)));
        let coat = seen(&detail, &FLAT).expect("a normal of its own");
        assert!((coat - Vec3::new(0.3, 0.0, 0.8).normalize()).length() < 1e-6, "{coat}");
        assert!((base_normal - tilted).length() < 1e-6, "{base_normal}");
        assert_eq!(detail.shading_normal(&textures, &at(Vec2::ZERO), &FLAT, wo, false), Vec3::Z);
        assert!(detail.depends_on_viewer() && detail.bends_normals());
    }

    #[test]
    fn tangent_frames_by_hand() {
        let tilted = Vec3::new(0.6, 0.0, 0.8);
        let across = Vec3::new(0.0, 0.6, 0.8);
        let seen = |m: Vec3, base: &Base, mirrors: bool| {
            let (textures, mut detail) = map(m);
            if let Some(map) = &mut detail.normal_map {
                map.mirrors = mirrors;
            }
            detail.shading_normal(&textures, &at(Vec2::ZERO), base, Vec3::Z, false)
        };
        assert!((seen(tilted, &FLAT, true) - tilted).length() < 1e-6);
        // u along +y: red tilts to +y, green to −x.
        let turned = Base { dpdu: Vec3::Y, dpdv: -Vec3::X, ..FLAT };
        assert!((seen(tilted, &turned, true) - Vec3::new(0.0, 0.6, 0.8)).length() < 1e-6);
        assert!((seen(across, &turned, true) - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6);
        // A mirrored parametrisation: green follows ∂p/∂v, or not.
        let mirrored = Base { dpdv: -Vec3::Y, ..FLAT };
        assert!((seen(across, &mirrored, true) - Vec3::new(0.0, -0.6, 0.8)).length() < 1e-6);
        assert!((seen(across, &mirrored, false) - across).length() < 1e-6);
        // Two channels give the third.
        let (textures, mut detail) = map(Vec3::new(0.6, 0.0, -1.0));
        if let Some(map) = &mut detail.normal_map {
            map.code = NormalCode::Xy;
        }
        assert!((detail.shading_normal(&textures, &at(Vec2::ZERO), &FLAT, Vec3::Z, false) - tilted).length() < 1e-6);
    }

    fn height(pattern: Pattern, mapping: Mapping, gain: f32) -> (Textures, SurfaceDetail) {
        let mut textures = Textures::new(ColorMode::Rgb);
        let mut pattern = PatternTexture::new(pattern, mapping);
        pattern.gain = gain;
        let id = textures.add(Texture::Pattern(Arc::new(pattern)));
        (textures, SurfaceDetail { bump: Some(FloatTexture::Texture(id)), ..SurfaceDetail::default() })
    }

    #[test]
    fn bumps_have_the_normal_of_the_displaced_surface() {
        // z = 0.2 noise(x, y, ½)·1: slopes by central differences of the function itself.
        let fbm = Pattern::Fbm(steradian_texture::noise::Fractal::new(1, 0.5));
        let (textures, detail) = height(fbm, Mapping::default(), 0.2);
        let f = |p: Vec3| 0.2 * steradian_texture::noise::gradient_noise(p, 0);
        for p in [Vec3::new(0.3, 0.4, 0.5), Vec3::new(1.7, -0.2, 0.5), Vec3::new(5.1, 3.3, 0.5)] {
            let c = TextureContext { p, ..at(p.truncate()) };
            let h = 1e-2;
            let slope = |e: Vec3| (f(p + e * h) - f(p - e * h)) / (2.0 * h);
            let expected = Vec3::new(-slope(Vec3::X), -slope(Vec3::Y), 1.0).normalize();
            let n = detail.shading_normal(&textures, &c, &FLAT, Vec3::Z, false);
            assert!((n - expected).length() < 2e-3, "{n} {expected}");
            // The parametrisation does not matter.
            let skewed = Base { dpdu: Vec3::new(2.0, 1.0, 0.0), dpdv: Vec3::new(-0.5, 3.0, 0.0), ..FLAT };
            let other = detail.shading_normal(&textures, &c, &skewed, Vec3::Z, false);
            assert!((other - expected).length() < 4e-3, "{other} {expected}");
            let none = Base { dpdu: Vec3::ZERO, dpdv: Vec3::ZERO, ..FLAT };
            assert!((detail.shading_normal(&textures, &c, &none, Vec3::Z, false) - expected).length() < 2e-3);
        }
    }

    #[test]
    fn ramps_tilt_and_footprints_average() {
        let ramp = Mapping { projector: Projector::Uv, ..Mapping::default() };
        let (textures, detail) = height(Pattern::Coordinate(false), ramp, 0.75);
        let n = detail.shading_normal(&textures, &at(Vec2::new(0.3, 0.3)), &FLAT, Vec3::Z, false);
        assert!((n - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-3);
        let footprint = Footprint { duvdx: Vec2::new(0.5, 0.0), duvdy: Vec2::new(0.0, 0.5), ..Footprint::default() };
        let wide = TextureContext { footprint, ..at(Vec2::new(0.3, 0.3)) };
        assert!(
            (detail.shading_normal(&textures, &wide, &FLAT, Vec3::Z, false) - Vec3::new(-0.6, 0.0, 0.8)).length()
                < 1e-6
        );
    }

    /// Mitsuba 3's rules: a normal turned away is mirrored about the one without detail; light above one surface and
    /// below the other is lost; from θ of a normal tilted by δ arrives 2/(1 + √(1 + min(tan²δ/8, 1) tan²θ)).
    #[test]
    fn turned_normals_and_their_cover() {
        let tilt = 1.2f32;
        let (textures, mut detail) = map(Vec3::new(tilt.sin(), 0.0, tilt.cos()));
        detail.facing = Facing::Turned;
        detail.shadows = true;
        let cover = |detail: &SurfaceDetail, frame: &Frame, flipped| match detail.ground(&FLAT, frame, flipped, true) {
            Some(Ground::Covers(cover)) => cover,
            other => panic!("{other:?}"),
        };
        let normal = |wo: Vec3| detail.shading_normal(&textures, &at(Vec2::ZERO), &FLAT, wo, false);
        let expected = Vec3::new(tilt.sin(), 0.0, tilt.cos());
        assert!((normal(Vec3::Z) - expected).length() < 1e-6);
        let from = |degrees: f32| Vec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        // Seen from −60° the facet is turned away by more than a right angle, from −20° it is not.
        assert!((normal(from(-20.0)) - expected).length() < 1e-6);
        assert!((normal(from(-60.0)) - Vec3::new(-tilt.sin(), 0.0, tilt.cos())).length() < 1e-6);
        // From below the tests are the same with both turned over.
        assert!((normal(-from(-20.0)) - expected).length() < 1e-6);
        for flipped in [false, true] {
            let side = if flipped { -1.0 } else { 1.0 };
            let frame = Frame::from_z(expected * side);
            let cover = cover(&detail, &frame, flipped);
            let passes = |degrees: f32| cover.passes(frame.to_local(from(degrees) * side));
            let share = |theta: f32| {
                2.0 / (1.0 + (1.0 + (0.125 * tilt.tan().powi(2)).min(1.0) * theta.to_radians().tan().powi(2)).sqrt())
            };
            for degrees in [0.0f32, 30.0, 80.0, -15.0] {
                assert!((passes(degrees).unwrap() - share(degrees)).abs() < 1e-5, "{degrees}");
            }
            // Below the facet, above the surface, and the other way round.
            assert!(passes(-60.0).is_none() && passes(120.0).is_none());
            assert!(passes(-150.0).is_some(), "through both surfaces");
        }
        detail.shadows = false;
        let frame = Frame::from_z(expected);
        assert_eq!(cover(&detail, &frame, false).passes(frame.to_local(from(80.0))), Some(1.0));
        detail.facing = Facing::AsItIs;
        let seen = detail.shading_normal(&textures, &at(Vec2::ZERO), &FLAT, from(-60.0), false);
        assert!((seen - expected).length() < 1e-6);
        detail.facing = Facing::Bent;
        assert!(detail.ground(&FLAT, &frame, false, false).is_none());
    }

    /// Mitsuba takes the derivative of the height at the point, whatever the footprint covers.
    #[test]
    fn turned_bumps_do_not_depend_on_the_footprint() {
        let projector = Mapping { projector: Projector::Uv, ..Mapping::default() };
        let (textures, mut detail) =
            height(Pattern::Fbm(steradian_texture::noise::Fractal::new(1, 0.5)), projector, 0.2);
        let footprint = Footprint { duvdx: Vec2::new(0.5, 0.0), duvdy: Vec2::new(0.0, 0.5), ..Footprint::default() };
        let (narrow, wide) = (at(Vec2::new(0.3, 0.3)), TextureContext { footprint, ..at(Vec2::new(0.3, 0.3)) });
        let normal = |d: &SurfaceDetail, at: &TextureContext| d.shading_normal(&textures, at, &FLAT, Vec3::Z, false);
        assert!((normal(&detail, &narrow) - normal(&detail, &wide)).length() > 1e-2);
        let exact = normal(&detail, &narrow);
        detail.facing = Facing::Turned;
        assert_eq!(normal(&detail, &narrow), normal(&detail, &wide));
        assert!((normal(&detail, &narrow) - exact).length() < 2e-3);
    }

    #[test]
    fn bent_normals_reflect_upwards_and_others_are_left_alone() {
        let mut rng = HashRng::new(9);
        let (mut bent, mut left) = (0, 0);
        for _ in 0..20_000 {
            let mut d = || loop {
                let v = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0;
                if v.length_squared() < 1.0 && v.length_squared() > 1e-4 {
                    break v.normalize();
                }
            };
            let (n, mut ns, mut wo) = (d(), d(), d());
            ns *= ns.dot(n).signum();
            wo *= wo.dot(n).signum();
            if wo.dot(n) < 1e-4 {
                continue;
            }
            let b = bend(ns, n, wo);
            assert!((b.length() - 1.0).abs() < 1e-5);
            let r = b * (2.0 * b.dot(wo)) - wo;
            assert!(r.dot(n) > 0.0 && b.dot(wo) > 0.0, "{n} {ns} {wo}: {}", r.dot(n));
            if b == ns { left += 1 } else { bent += 1 }
        }
        assert!(bent > 2000 && left > 2000, "{bent} {left}");
        assert_eq!(bend(Vec3::X, Vec3::Z, -Vec3::Z), Vec3::X);
        assert_eq!(bend(Vec3::Z, Vec3::Z, Vec3::new(0.6, 0.0, 0.8)), Vec3::Z);
    }

    #[test]
    fn nothing_gives_nan() {
        let (textures, detail) = map(Vec3::ZERO);
        assert_eq!(detail.shading_normal(&textures, &at(Vec2::ZERO), &FLAT, Vec3::Z, false), Vec3::Z);
        let (textures, detail) = height(Pattern::Coordinate(true), Mapping::default(), f32::MAX);
        for base in [
            FLAT,
            Base { dpdu: Vec3::splat(1e30), dpdv: Vec3::Y, ..FLAT },
            Base { dpdu: Vec3::X, dpdv: Vec3::X, ..FLAT },
        ] {
            let n = detail.shading_normal(&textures, &at(Vec2::splat(1e20)), &base, Vec3::new(0.0, 0.6, 0.8), false);
            assert!(n.is_finite() && (n.length() - 1.0).abs() < 1e-4, "{n}");
        }
    }
}
