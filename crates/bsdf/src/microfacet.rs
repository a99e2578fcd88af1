//! Microfacet surfaces: what a mirror or a refracting interface made of small facets does to light (Walter et al. 2007;
//! Heitz 2014).
//!
//! ```text
//! f_r cosθ_i = F D(m) G₂ / (4 |cosθ_o|)                                         m the half vector
//! f_t cosθ_i = (1 − F) D(m) G₂ |wo·m| |wi·m| / (|cosθ_o| (wi·m + wo·m/η)²)      m its generalisation
//! ```
//!
//! The distributions `D` are in `normal_distribution.rs`, `G₁` and `G₂` in `masking.rs`. Normals are drawn as the
//! direction sees them where a way to do so is known: GGX and Beckmann under Smith's masking, and every distribution in
//! V-grooves; else as they are.

use super::{
    fresnel,
    masking::{projected_area, v_groove},
    normal_distribution::ggx_root,
    visible_normals,
};
pub use super::{masking::Shadowing, normal_distribution::NormalDistribution};
use std::f32::consts::FRAC_1_PI;
use steradian_math::{Vec2, Vec3};

/// A rough surface. Roughness values are those of the distributions above (the root-mean-square slope of Beckmann is
/// `α/√2`).
#[derive(Clone, Copy, Debug)]
pub struct Microfacet {
    alpha_x: f32,
    alpha_y: f32,
    distribution: NormalDistribution,
    shadowing: Shadowing,
}

/// A facet that carries light from `wi` to `wo`, for unit Fresnel factor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// `wo·m`, negative when `wo` lies below the facet.
    pub cos_o: f32,
    /// `f·|cosθ_i| / F` with `F` the reflected or transmitted fraction.
    pub value: f32,
    /// Density of `wi` when `m` is drawn by [`Microfacet::sample_visible`].
    pub pdf: f32,
    /// Value over density.
    pub weight: f32,
}

/// A facet that mirrors `wo` into another direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirror {
    /// Square of the cosine between its normal and either direction.
    pub cos2: f32,
    spread: Spread,
}

/// GGX terms of a normal and a direction `wo`; zero for other distributions.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    /// `√(π D/(α_x α_y))`.
    root: f32,
    /// The area of the facets that `wo` sees.
    area: f32,
}

/// Change of variables at a facet that turns `wi` into `wo`.
struct Turn {
    /// `wo·m`, negative when `wo` lies below the facet.
    cos_o: f32,
    /// Solid angle of normals per solid angle of `wi`.
    jacobian: f32,
    /// `jacobian |wo·m|`.
    seen: f32,
}

/// A normal that was drawn for a direction `wo`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    /// Along it, of any length, and one over the square of that.
    direction: Vec3,
    inverse2: f32,
    /// The product with `wo`, which lies below the facet where that is negative.
    projected: f32,
    spread: Spread,
}

impl Normal {
    /// `wo·m`, negative when `wo` lies below the facet.
    #[inline(always)]
    pub fn cos_o(&self) -> f32 {
        self.projected * self.inverse2.sqrt()
    }

    /// Its square.
    #[inline(always)]
    pub fn cos2(&self) -> f32 {
        self.projected * self.projected * self.inverse2
    }

    /// The direction that is mirrored into `wo`.
    #[inline(always)]
    pub fn mirrored(&self, wo: Vec3) -> Vec3 {
        // Reflection: wi = 2 (wo·m) m − wo, with m of any length.
        (2.0 * self.projected * self.inverse2) * self.direction - wo
    }

    /// Facet that mirrors it.
    #[inline(always)]
    pub fn mirror(&self) -> Mirror {
        Mirror { cos2: self.cos2(), spread: self.spread }
    }

    /// Fresnel terms at the facet, if the medium below it has the index `eta` relative to the one above.
    #[inline(always)]
    pub fn crossing(&self, eta: f32) -> fresnel::Crossing {
        // From below the interface is crossed the other way, by the inverse of the index.
        fresnel::Crossing::by_square(self.cos2(), if self.projected < 0.0 { 1.0 / eta } else { eta })
    }

    /// The direction that is refracted into `wo`, and its relative index; none under total reflection.
    #[inline(always)]
    pub fn refracted(&self, wo: Vec3, crossing: &fresnel::Crossing) -> Option<(Vec3, f32)> {
        crossing.refract(wo, self.direction * self.inverse2.sqrt(), self.projected)
    }
}

impl Microfacet {
    /// A mirror-like surface without roughness.
    pub const SMOOTH: Self = Self {
        alpha_x: 0.0,
        alpha_y: 0.0,
        distribution: NormalDistribution::Ggx,
        shadowing: Shadowing::HeightCorrelated,
    };

    /// Below this roughness in both directions the surface counts as smooth (pbrt-v4's threshold).
    pub const SMOOTH_BELOW: f32 = 1e-3;

    /// A surface of roughness `alpha_x` along the tangent and `alpha_y` along the bitangent, each in `[0, 16]`
    /// (clamped; NaN counts as 0). Where only one of them is smaller than 10⁻⁴ it is raised to that.
    pub fn new(distribution: NormalDistribution, shadowing: Shadowing, alpha_x: f32, alpha_y: f32) -> Self {
        let in_range = |alpha: f32| if alpha > 0.0 { alpha.min(16.0) } else { 0.0 };
        let mut m = Self { alpha_x: in_range(alpha_x), alpha_y: in_range(alpha_y), distribution, shadowing };
        if !m.is_smooth() {
            m.alpha_x = m.alpha_x.max(1e-4);
            m.alpha_y = m.alpha_y.max(1e-4);
        }
        m
    }

    /// GGX with height-correlated shadowing.
    pub fn ggx(alpha_x: f32, alpha_y: f32) -> Self {
        Self::new(NormalDistribution::Ggx, Shadowing::HeightCorrelated, alpha_x, alpha_y)
    }

    /// GGX of one roughness that is in range already.
    pub(super) const fn isotropic(alpha: f32) -> Self {
        Self { alpha_x: alpha, alpha_y: alpha, ..Self::SMOOTH }
    }

    /// True if the surface scatters as a delta distribution.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.alpha_x < Self::SMOOTH_BELOW && self.alpha_y < Self::SMOOTH_BELOW
    }

    /// The isotropic roughness with the same area of the slope ellipse, `√(α_x α_y)`.
    pub fn mean_alpha(&self) -> f32 {
        (self.alpha_x * self.alpha_y).sqrt()
    }

    /// The roughness, if it is the same along both tangents.
    pub(super) fn isotropic_alpha(&self) -> Option<f32> {
        ((self.alpha_x - self.alpha_y).abs() <= 0.01 * self.alpha_x).then_some(self.alpha_x)
    }

    #[inline]
    pub(super) fn alpha(&self) -> Vec2 {
        Vec2::new(self.alpha_x, self.alpha_y)
    }

    /// `D(m)`, for `m` in the upper hemisphere (sr⁻¹).
    #[inline]
    pub fn d(&self, m: Vec3) -> f32 {
        self.distribution.density(self.alpha(), m)
    }

    /// Smith's `Λ(w)`: masked over visible facet area.
    #[inline]
    pub fn lambda(&self, w: Vec3) -> f32 {
        self.area(w) / w.z.abs() - 1.0
    }

    /// The facets' area that `w` sees, projected on it, per area of the surface: `|cosθ| (1 + Λ)`.
    #[inline]
    fn area(&self, w: Vec3) -> f32 {
        projected_area(self.distribution, self.alpha(), w)
    }

    /// The fraction `G₁(w, m)` of the facets with normal `m` that `w` sees. Under Smith's assumption `m` does not
    /// matter.
    #[inline]
    pub fn g1(&self, w: Vec3, m: Vec3) -> f32 {
        match self.shadowing {
            Shadowing::VGroove => v_groove(w, m),
            _ => w.z.abs() / self.area(w),
        }
    }

    /// The fraction of the facets with normal `m` that both directions see; they may lie on different sides.
    #[inline]
    pub fn g2(&self, wo: Vec3, wi: Vec3, m: Vec3) -> f32 {
        match self.shadowing {
            Shadowing::VGroove => {
                // V-grooves: the lesser of both on one side, the overlap of both on different sides.
                let (o, i) = (v_groove(wo, m), v_groove(wi, m));
                if wo.z * wi.z >= 0.0 { o.min(i) } else { (o + i - 1.0).max(0.0) }
            }
            _ => wo.z.abs() * self.smith_g2(wo, wi, self.area(wo)),
        }
    }

    /// Smith's `G₂/|cosθ_o|` by the area that `wo` sees.
    #[inline]
    fn smith_g2(&self, wo: Vec3, wi: Vec3, area_o: f32) -> f32 {
        let (cos_o, cos_i, area_i) = (wo.z.abs(), wi.z.abs(), self.area(wi));
        // 1/(1 + Λ(wo) + Λ(wi)) and 1/((1 + Λ(wo)) (1 + Λ(wi))).
        cos_i
            / match self.shadowing {
                Shadowing::Separable => area_o * area_i,
                _ => area_o * cos_i + (area_i - cos_i) * cos_o,
            }
    }

    /// True if visible normals are drawn by stretching a surface of unit roughness.
    #[inline]
    fn is_stretched(&self) -> bool {
        matches!(self.distribution, NormalDistribution::Ggx | NormalDistribution::Beckmann)
            && self.shadowing != Shadowing::VGroove
    }

    /// The commonest of these.
    #[inline]
    fn is_ggx(&self) -> bool {
        self.distribution == NormalDistribution::Ggx && self.shadowing != Shadowing::VGroove
    }

    /// Density of the normals that [`Microfacet::sample_visible`] draws for `w` (sr⁻¹): `G₁(w, m) |w·m| D(m) /
    /// |cosθ_w|` where visible normals are drawn, else that of the distribution.
    #[inline]
    pub fn d_visible(&self, w: Vec3, m: Vec3) -> f32 {
        if w.z == 0.0 {
            return 0.0;
        }
        if self.is_stretched() {
            // Visible normals: D_ω(m) = G₁ |w·m| D(m)/|cos θ|, with the area in place of |cos θ|/G₁.
            return w.dot(m).abs() * self.d(m) / self.area(w);
        }
        self.visible(w, m, self.d(m))
    }

    /// Density of sampled normals of surfaces that are not stretched, by `d = D(m)`.
    #[inline]
    fn visible(&self, w: Vec3, m: Vec3, d: f32) -> f32 {
        let drawn = self.distribution.sampled_density(self.alpha(), m, d);
        // The facet and its mirror image across the groove share the density by the area that w sees of each.
        match self.shadowing {
            Shadowing::VGroove => {
                let (here, across) = faces_of_groove(if w.z < 0.0 { -w } else { w }, m);
                if here > 0.0 { drawn * 2.0 * here / (here + across) } else { 0.0 }
            }
            _ => drawn,
        }
    }

    /// Draws a normal with the density [`Microfacet::d_visible`]: one that `w` sees, where that can be done. `w` may
    /// lie on either side, the normal is in the upper hemisphere.
    #[inline]
    pub fn sample_visible(&self, w: Vec3, u: Vec2) -> Vec3 {
        let n = self.draw(w, u);
        n.direction * n.inverse2.sqrt()
    }

    /// Draws a normal as [`Microfacet::sample_visible`] does, with the other terms of a facet.
    #[inline(always)]
    pub(super) fn draw(&self, w: Vec3, u: Vec2) -> Normal {
        // Sample for the direction above the surface; normals are the same seen from below.
        let above = w * 1f32.copysign(w.z);
        let mut spread = Spread::default();
        let direction = if self.is_ggx() {
            // The distribution with unit roughness is sampled for the stretched direction; the normal is stretched
            // back. It has the density of that, in which all normals are alike, times what stretching does to the solid
            // angle.
            let stretched = Vec3::new(self.alpha_x * above.x, self.alpha_y * above.y, above.z);
            let length = stretched.length();
            let m = visible_normals::sample_ggx(stretched, length, u);
            let least = 1e-6 * length;
            let m = Vec3::new(m.x, m.y, if m.z > least { m.z } else { least });
            let direction = Vec3::new(self.alpha_x * m.x, self.alpha_y * m.y, m.z);
            // D and the projected area come with the stretching: D = α_x α_y root²/π, A = (cos θ + length)/2.
            spread.root = direction.length_squared() / (self.alpha_x * self.alpha_y * m.length_squared());
            spread.area = 0.5 * (above.z + length);
            direction
        } else {
            unit(self.sample_slopes(above, u).extend(1.0)).unwrap_or(Vec3::Z)
        };
        Normal { direction, inverse2: 1.0 / direction.length_squared(), projected: w.dot(direction), spread }
    }

    /// Draws a normal for distributions other than GGX, as minus the slopes of the facet. (Pairs of numbers are handed
    /// back in registers, normals are not.)
    #[inline(never)]
    fn sample_slopes(&self, w: Vec3, u: Vec2) -> Vec2 {
        let alpha = self.alpha();
        if self.is_stretched() {
            // Beckmann under Smith's masking: stretch, sample slopes at unit roughness, scale them back.
            let stretched = unit(Vec3::new(alpha.x * w.x, alpha.y * w.y, w.z)).unwrap_or(Vec3::Z);
            return alpha * visible_normals::sample_beckmann(stretched, u);
        }
        // Other distributions are sampled by D alone.
        let slopes = self.distribution.sample(alpha, u);
        if self.shadowing != Shadowing::VGroove {
            return slopes;
        }
        // That facet or its mirror image across the groove, in proportion to the area seen (Heitz & d'Eon 2014, 4). The
        // last digits of the number that sets the azimuth choose between the two.
        let (here, across) = faces_of_groove(w, slopes.extend(1.0));
        if (u.x * 4096.0).fract() * (here + across) < here { slopes } else { -slopes }
    }

    /// Sample weight from `wo` to `wi` of a normal that was drawn for `wo`, for unit Fresnel factor: value over
    /// density.
    #[inline]
    pub(super) fn sampled_weight(&self, wo: Vec3, wi: Vec3, m: Vec3) -> f32 {
        let g2 = self.g2(wo, wi, m);
        if self.is_stretched() {
            // D and the Jacobian cancel: the weight is G₂/G₁.
            return g2 / self.g1(wo, m);
        }
        let density = self.d_visible(wo, m) * wo.z.abs();
        if density > 0.0 { g2 * wo.dot(m).abs() * self.d(m) / density } else { 0.0 }
    }

    /// Facet that mirrors `wi` into `wo`.
    #[inline(always)]
    pub(super) fn mirror(&self, wo: Vec3, wi: Vec3) -> Mirror {
        // The half vector makes the same angle with both, so that is half of its length.
        let h = wo + wi;
        let length2 = h.length_squared();
        Mirror { cos2: 0.25 * length2, spread: self.spread(h, length2, wo) }
    }

    /// GGX terms of a normal of any length, whose square is given.
    #[inline(always)]
    fn spread(&self, h: Vec3, length2: f32, wo: Vec3) -> Spread {
        if !self.is_ggx() {
            return Spread::default();
        }
        Spread { root: ggx_root(self.alpha(), h, length2), area: self.area(wo) }
    }

    /// The facet that mirrors `wi` into `wo`; both must be on one side.
    #[inline(always)]
    pub(super) fn reflecting(&self, wo: Vec3, wi: Vec3) -> Option<Facet> {
        self.reflecting_by(&self.mirror(wo, wi), wo, wi)
    }

    /// The facet that mirrors `wi` into `wo`, by its known [`Mirror`]: `f cosθ_i = F D G₂ / (4 |cosθ_o|)`.
    #[inline(always)]
    pub(super) fn reflecting_by(&self, mirror: &Mirror, wo: Vec3, wi: Vec3) -> Option<Facet> {
        // Reflection needs both directions on one side and a half vector of some length.
        if wo.z * wi.z <= 0.0 || 4.0 * mirror.cos2 < f32::MIN_POSITIVE {
            return None;
        }
        // Jacobian of the half vector: dω_m/dω_i = 1/(4 |wo·m|).
        let cos_o = mirror.cos2.sqrt().copysign(wo.z);
        self.facet(wo + wi, mirror.spread, wo, wi, Turn { cos_o, jacobian: 0.25 / cos_o.abs(), seen: 0.25 })
    }

    /// The facet that refracts `wi` into `wo`, which must be on different sides; `eta = η_t/η_i` from the side of `wo`
    /// to the side of `wi`.
    #[inline(always)]
    pub(super) fn refracting(&self, wo: Vec3, wi: Vec3, eta: f32) -> Option<Facet> {
        // Generalised half vector: m ∝ wo + η wi, turned upwards.
        let m = upper(wo + eta * wi)?;
        let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
        // A facet cannot be seen from behind.
        if wo.z * wi.z >= 0.0 || cos_o * wo.z <= 0.0 || cos_i * wi.z <= 0.0 {
            return None;
        }
        // Jacobian of refraction: |wi·m|/(wi·m + wo·m/η)² (Walter et al. 2007).
        let denominator = cos_i + cos_o / eta;
        let jacobian = cos_i.abs() / (denominator * denominator);
        self.facet(m, self.spread(m, 1.0, wo), wo, wi, Turn { cos_o, jacobian, seen: cos_o.abs() * jacobian })
    }

    /// Refraction by a facet that was drawn for `wo`. By Snell's law its cosines are known: `|wi·m| = c_t/η`, of which
    /// the denominator is `(|wo·m| − c_t)/η`, with `c_t` what the crossing calls refracted.
    #[inline(always)]
    pub(super) fn refracting_drawn(
        &self,
        n: &Normal,
        crossing: &fresnel::Crossing,
        wo: Vec3,
        wi: Vec3,
    ) -> Option<Facet> {
        if wo.z * wi.z >= 0.0 || n.projected * wo.z <= 0.0 {
            return None;
        }
        // By `c_t² − cos² = η² − 1`, which spares the difference of what is nearly the same.
        let (sum, excess) = (crossing.cos_i + crossing.refracted, crossing.eta * crossing.eta - 1.0);
        let jacobian = crossing.refracted * (sum * sum) * (crossing.eta / (excess * excess));
        let cos_o = crossing.cos_i.copysign(wo.z);
        self.facet(n.direction, n.spread, wo, wi, Turn { cos_o, jacobian, seen: crossing.cos_i * jacobian })
    }

    /// The facet whose normal is along `h` or `−h`. A density that vanishes or overflows (a grazing direction) carries
    /// nothing. Inlined: what is not used is not computed.
    #[inline(always)]
    fn facet(&self, h: Vec3, spread: Spread, wo: Vec3, wi: Vec3, turn: Turn) -> Option<Facet> {
        let Turn { cos_o, jacobian, seen } = turn;
        // GGX: value D G₂ and density D/A share their factors; the weight is their quotient.
        let (value, pdf, weight) = if self.is_ggx() {
            let d = FRAC_1_PI * self.alpha_x * self.alpha_y * (spread.root * spread.root);
            let g2 = self.smith_g2(wo, wi, spread.area);
            (seen * d * g2, seen * d / spread.area, g2 * spread.area)
        } else {
            let (value, pdf) = self.of_others(upper(h)?, wo, wi, jacobian, seen);
            (value, pdf, value / pdf)
        };
        let is_sound = (pdf > 0.0) & (pdf < f32::INFINITY) & (value < f32::INFINITY);
        is_sound.then_some(Facet { cos_o, value, pdf, weight })
    }

    /// Value and density of surfaces other than Smith's GGX.
    #[inline(never)]
    fn of_others(&self, m: Vec3, wo: Vec3, wi: Vec3, jacobian: f32, seen: f32) -> (f32, f32) {
        let d = self.d(m);
        if self.is_stretched() {
            let area = self.area(wo);
            return (seen * d * self.smith_g2(wo, wi, area), seen * d / area);
        }
        (seen * d * self.g2(wo, wi, m) / wo.z.abs(), self.visible(wo, m, d) * jacobian)
    }
}

/// The areas of a facet `m` and of the one across its groove as `w` sees them.
#[inline]
fn faces_of_groove(w: Vec3, m: Vec3) -> (f32, f32) {
    // Areas of both faces of the groove, as products with w; a face seen from behind has none.
    let (up, aside) = (w.z * m.z, w.x * m.x + w.y * m.y);
    ((up + aside).max(0.0), (up - aside).max(0.0))
}

/// The unit vector along `v`.
#[inline]
fn unit(v: Vec3) -> Option<Vec3> {
    let length2 = v.length_squared();
    (length2 > f32::MIN_POSITIVE && length2 < f32::INFINITY).then(|| v * (1.0 / length2.sqrt()))
}

/// The direction of `v` or `−v` that points up.
#[inline]
fn upper(v: Vec3) -> Option<Vec3> {
    let m = unit(v)?;
    Some(m * 1f32.copysign(m.z))
}

/// For cases: surfaces whose normals are drawn in other ways than those of GGX and Beckmann under Smith's masking.
pub(super) fn further_surfaces() -> [(&'static str, NormalDistribution, Shadowing, f32, f32); 9] {
    use NormalDistribution::{Beckmann, Blinn, Gaussian, Ggx, StudentT};
    use Shadowing::{HeightCorrelated, Separable, VGroove};
    [
        ("Blinn, 0.2", Blinn, Separable, 0.2, 0.2),
        ("Blinn, anisotropic, V-grooves", Blinn, VGroove, 0.1, 0.5),
        ("Gaussian, 0.4", Gaussian, HeightCorrelated, 0.4, 0.4),
        ("Gaussian, V-grooves, 0.15", Gaussian, VGroove, 0.15, 0.15),
        ("Student's t, long tail, 0.1", StudentT(super::Tail::new(1.8)), HeightCorrelated, 0.1, 0.1),
        ("Student's t, short tail, anisotropic", StudentT(super::Tail::new(5.0)), Separable, 0.5, 0.2),
        ("GGX, V-grooves, 0.3", Ggx, VGroove, 0.3, 0.3),
        ("Beckmann, V-grooves, anisotropic", Beckmann, VGroove, 0.2, 0.6),
        ("Blinn, 1", Blinn, Separable, 1.0, 1.0),
    ]
}
