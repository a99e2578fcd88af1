//! Vertices in columns, and the kernels that fill them: what follows from a hit, random numbers, light samples and
//! sampled directions.

use bytemuck::Zeroable;
use std::f32::consts::FRAC_1_PI;
use steradian_accel::{
    columns::{Column, WIDTH, get3, get4, set3, set4},
    kernel,
};
use steradian_core::{
    light::{
        LightContext,
        area::{FlatLight, FlatSample},
        tree::{Cluster, choose_child},
    },
    medium,
    sampler::sobol_scramble,
    scene::shadow_ray,
    shape::mesh::{on_triangle, usual_face_normal},
};
use steradian_engine::dimension;
use steradian_math::{Frame, Vec2, Vec3, ray::offset_ray_origin, warp};
use steradian_transport::{
    Depth,
    flight::by_lane,
    power_heuristic,
    roulette::{IN_MEDIUM, roulette},
};

/// Vertices on triangles of meshes. All columns are one value, so that kernels see that none overlaps another.
#[repr(align(64))]
#[derive(Clone, Debug, Zeroable)]
pub struct Block {
    // The hit, and the path that comes to it.
    /// Corners of the triangle.
    pub corners: [[Column; 3]; 3],
    /// Normals at these, of meshes that have them.
    pub normals: [[Column; 3]; 3],
    /// Flags of the mesh: it has normals, and it is turned over.
    pub is_smooth: Column<u32>,
    pub is_flipped: Column<u32>,
    /// Barycentric coordinates.
    pub uv: [Column; 2],
    /// Ray direction.
    pub direction: [Column; 3],
    pub beta: [Column; 4],
    pub roulette_scale: Column,
    /// True if one wavelength is left.
    pub is_single: Column<u32>,
    /// True if the vertex is in a medium.
    pub is_in_medium: Column<u32>,
    /// Scattering events before this one, and surfaces passed.
    pub events: Column<u32>,
    pub passes: Column<u32>,
    /// Seed and reversed index of the sampler.
    pub sampler: [Column<u32>; 2],

    // Of paths in media.
    /// Origin of the ray, and how far it is to its hit.
    pub from: [Column; 3],
    pub end: Column,
    /// Coefficients of absorption and scattering, zero where there is no medium, and the asymmetry of scattering.
    pub sigma_a: [Column; 4],
    pub sigma_s: [Column; 4],
    pub asymmetry: Column,
    /// Number of lanes of these that count.
    pub lanes: Column<u32>,
    /// Outcome of the flight: [`PASSES`](super::media::PASSES), [`SCATTERS`](super::media::SCATTERS) or
    /// [`IS_BLACK`](super::media::IS_BLACK).
    pub flight: Column<u32>,

    // By `surfaces` or `flights`.
    pub p: [Column; 3],
    pub error: [Column; 3],
    pub n: [Column; 3],
    pub ns: [Column; 3],
    /// True if the triangle is too small or too large for that.
    pub is_unusual: Column<u32>,
    /// True if the ray comes from the side that the shading normal points to.
    pub is_front: Column<u32>,

    // By `numbers`.
    pub light_u: [Column; 2],
    pub bsdf_u: [Column; 2],
    pub lobe_u: Column,
    pub roulette_u: Column,

    // Two children of a node of the light tree.
    pub children: [Child; 2],
    pub choice: Column,
    /// The probability of the node.
    pub chance: Column,
    pub is_second: Column<u32>,

    // The material on that side, and a light sample of density zero where there is none.
    /// True if the vertex asks for a light sample.
    pub takes_light: Column<u32>,
    pub reflectance: [Column; 4],
    /// The side from which light matters, zero for any; at Lambertian surfaces the axis of the frame.
    pub light_n: [Column; 3],
    pub light_wi: [Column; 3],
    pub light_distance: Column,
    pub light_radiance: [Column; 4],
    pub light_pdf: Column,
    pub light_is_delta: Column<u32>,
    /// True for a flat light, which is a triangle or a rectangle and may shine to both sides: its sample is left to
    /// [`flat_lights`], and the density is that of its choice then.
    pub is_flat: Column<u32>,
    /// Number of the light that the columns below describe; they stay from block to block.
    pub flat_number: Column<u32>,
    pub flat_corner: [Column; 3],
    pub flat_edges: [[Column; 3]; 2],
    pub flat_n: [Column; 3],
    pub flat_area: Column,
    pub flat_is_triangle: Column<u32>,
    pub flat_is_two_sided: Column<u32>,

    // By the model; the sampled direction, and whether there is one, are overwritten by `diffuse` too.
    pub is_drawn: Column<u32>,
    pub wi: [Column; 3],

    // By `diffuse` and `depart`.
    /// Contribution of the light sample if nothing is before it, and a flag that it is not black.
    pub light: [Column; 4],
    pub is_lit: Column<u32>,
    pub shadow_origin: [Column; 3],
    pub shadow_direction: [Column; 3],
    pub shadow_end: Column,
    /// Density of the sampled direction.
    pub pdf: Column,
    pub origin: [Column; 3],
    /// Outcome of the path: [`ENDS`], [`GOES_ON`] or [`IS_NOT_FINITE`].
    pub fate: Column<u32>,
}

/// A child of a node of the light tree.
#[derive(Clone, Debug, Zeroable)]
pub struct Child {
    center: [Column; 3],
    half2: Column,
    axis: [Column; 3],
    cos_o: Column,
    cos_e: Column,
    intensity: Column,
    two_sided: Column<u32>,
}

impl Child {
    #[inline(always)]
    pub fn set(&mut self, k: usize, c: &Cluster) {
        set3(&mut self.center, k, c.center);
        set3(&mut self.axis, k, c.axis);
        (self.half2[k], self.cos_o[k], self.cos_e[k], self.intensity[k]) = (c.half2, c.cos_o, c.cos_e, c.intensity);
        self.two_sided[k] = c.two_sided.into();
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Cluster {
        Cluster {
            center: get3(&self.center, k),
            half2: self.half2[k],
            axis: get3(&self.axis, k),
            cos_o: self.cos_o[k],
            cos_e: self.cos_e[k],
            intensity: self.intensity[k],
            two_sided: self.two_sided[k] != 0,
        }
    }
}

pub const ENDS: u32 = 0;
pub const GOES_ON: u32 = 1;
/// The throughput is not finite.
pub const IS_NOT_FINITE: u32 = 2;

impl Default for Block {
    fn default() -> Self {
        // No light is in the columns of flat lights yet.
        Self { flat_number: [u32::MAX; WIDTH], ..Self::zeroed() }
    }
}

#[inline(always)]
pub fn is_black(v: [f32; 4]) -> bool {
    (v[0] == 0.0) & (v[1] == 0.0) & (v[2] == 0.0) & (v[3] == 0.0)
}

kernel! {
    /// The surface at the hits.
    pub fn surfaces(b: &'a mut Block) {
        for k in 0..WIDTH {
            let corners = [get3(&b.corners[0], k), get3(&b.corners[1], k), get3(&b.corners[2], k)];
            let normals = [get3(&b.normals[0], k), get3(&b.normals[1], k), get3(&b.normals[2], k)];
            // Position with its error bounds, geometric and shading normal at the barycentric coordinates.
            let face = usual_face_normal(corners);
            let how = (b.is_smooth[k] != 0, b.is_flipped[k] != 0);
            let s = on_triangle(corners, normals, how, (b.uv[0][k], b.uv[1][k]), face.unwrap_or(Vec3::ZERO));
            // Degenerate triangles have no usual normal: their vertices are made anew one by one.
            b.is_unusual[k] = u32::from(face.is_none());
            set3(&mut b.p, k, s.p);
            set3(&mut b.error, k, s.error);
            set3(&mut b.n, k, s.n);
            set3(&mut b.ns, k, s.ns);
            b.is_front[k] = u32::from(s.ns.dot(-get3(&b.direction, k)) > 0.0);
        }
    }
}

kernel! {
    /// The numbers of Sobol' samplers for the event.
    pub fn numbers(b: &'a mut Block) {
        for k in 0..WIDTH {
            let (seed, reversed, event) = (b.sampler[0][k], b.sampler[1][k], b.events[k]);
            let at = |event: u32, decision: u32| sobol_scramble(seed, dimension::at(event, decision));
            // Sobol' points of the event: for the light, for the direction, for the lobe, and for roulette after it.
            let light = at(event, dimension::LIGHT_POINT).point_2d(reversed);
            let turn = at(event, dimension::DIRECTION).point_2d(reversed);
            (b.light_u[0][k], b.light_u[1][k]) = (light[0], light[1]);
            (b.bsdf_u[0][k], b.bsdf_u[1][k]) = (turn[0], turn[1]);
            let lobe = dimension::at(event, dimension::LOBE) ^ (b.passes[k] << 16);
            b.lobe_u[k] = sobol_scramble(seed, lobe).point_1d(reversed);
            b.roulette_u[k] = at(event.wrapping_add(1), dimension::ROULETTE).point_1d(reversed);
        }
    }
}

kernel! {
    /// A step down the light tree.
    pub fn children(b: &'a mut Block) {
        for k in 0..WIDTH {
            let ctx = LightContext { p: get3(&b.p, k), n: get3(&b.light_n, k) };
            // Importance of both children for the vertex, and a choice in proportion to it.
            let [first, second] = [b.children[0].get(k).importance(&ctx), b.children[1].get(k).importance(&ctx)];
            let (is_second, chance, u) = choose_child(first, second, b.choice[k]);
            (b.is_second[k], b.choice[k]) = (is_second.into(), u);
            // The probability of a light is the product of the choices on the way to it.
            b.chance[k] *= chance;
        }
    }
}

kernel! {
    /// Samples of flat lights, of which some may be large.
    pub fn flat_lights(b: &'a mut Block) {
        for k in 0..WIDTH {
            flat_light(b, k, true);
        }
    }
}

kernel! {
    /// Samples of flat lights none of which is large.
    pub fn small_lights(b: &'a mut Block) {
        for k in 0..WIDTH {
            flat_light(b, k, false);
        }
    }
}

/// [`flat_lights`] at a vertex.
#[inline(always)]
fn flat_light(b: &mut Block, k: usize, may_be_large: bool) {
    let light = FlatLight {
        corner: get3(&b.flat_corner, k),
        edges: [get3(&b.flat_edges[0], k), get3(&b.flat_edges[1], k)],
        n: get3(&b.flat_n, k),
        area: b.flat_area[k],
        is_triangle: b.flat_is_triangle[k] != 0,
    };
    // A point of the triangle or rectangle, with its density per solid angle.
    let u = Vec2::new(b.light_u[0][k], b.light_u[1][k]);
    let FlatSample { wi, distance, pdf, .. } = light.sample(get3(&b.p, k), u, may_be_large);
    // One-sided lights emit on the side of their normal only.
    let shines = (b.flat_is_two_sided[k] != 0) | (light.n.dot(-wi) > 0.0);
    let pdf = if shines { pdf * b.light_pdf[k] } else { 0.0 };
    // Selections instead of branches: lanes with other lights keep their samples.
    let is_flat = b.is_flat[k] != 0;
    let (before, distance_before) = (get3(&b.light_wi, k), b.light_distance[k]);
    set3(&mut b.light_wi, k, if is_flat { wi } else { before });
    b.light_distance[k] = if is_flat { distance } else { distance_before };
    b.light_pdf[k] = if is_flat { pdf } else { b.light_pdf[k] };
}

kernel! {
    /// Light and the sampled direction at Lambertian surfaces, with the rays that leave.
    pub fn diffuse(b: &'a mut Block, depth: Depth) {
        for k in 0..WIDTH {
            diffuse_at(b, k, false);
            depart_from(b, k, &depth);
        }
    }
}

kernel! {
    /// [`diffuse`] where some are in media.
    pub fn diffuse_in_media(b: &'a mut Block, depth: Depth) {
        for k in 0..WIDTH {
            diffuse_at(b, k, true);
            depart_from(b, k, &depth);
        }
    }
}

kernel! {
    /// [`diffuse_in_media`] without the rays that leave.
    pub fn diffuse_light(b: &'a mut Block) {
        for k in 0..WIDTH {
            diffuse_at(b, k, true);
        }
    }
}

/// Light and the sampled direction at a Lambertian vertex.
#[inline(always)]
fn diffuse_at(b: &mut Block, k: usize, in_media: bool) {
    let frame = Frame::from_z(get3(&b.light_n, k));
    let o = frame.to_local(-get3(&b.direction, k));
    let (reflectance, beta) = (get4(&b.reflectance, k), get4(&b.beta, k));

    // Light sample: ρ/π cosθ L w / p, with w the power heuristic against the density cosθ/π.
    let i = frame.to_local(get3(&b.light_wi, k));
    let (pdf, cos) = (b.light_pdf[k], i.z * FRAC_1_PI);
    let weight = if b.light_is_delta[k] != 0 { 1.0 } else { power_heuristic(pdf, cos) };
    let factor = weight / pdf;
    let radiance = get4(&b.light_radiance, k);
    let light = by_lane(|c| reflectance[c] * cos * radiance[c] * factor);
    let light = if in_media { attenuated(b, k, light) } else { light };
    set4(&mut b.light, k, by_lane(|c| beta[c] * light[c]));
    b.is_lit[k] = u32::from((o.z > 0.0) & (i.z > 0.0) & (pdf > 0.0) & !is_black(light));

    // Direction by the cosine: f cosθ / p = ρ, so the throughput is multiplied by the reflectance.
    let w = warp::cosine_hemisphere(Vec2::new(b.bsdf_u[0][k], b.bsdf_u[1][k]));
    b.is_drawn[k] = u32::from((o.z > 0.0) & (w.z > 0.0) & !is_black(reflectance));
    b.pdf[k] = w.z * FRAC_1_PI;
    set3(&mut b.wi, k, frame.to_world(w));
    set4(&mut b.beta, k, by_lane(|c| beta[c] * reflectance[c]));
}

/// Attenuates the light of a light sample by the medium, `exp(−σt d)`.
#[inline(always)]
pub fn attenuated(b: &Block, k: usize, light: [f32; 4]) -> [f32; 4] {
    let (sigma_a, sigma_s, distance) = (get4(&b.sigma_a, k), get4(&b.sigma_s, k), b.light_distance[k]);
    by_lane(|c| light[c] * medium::beer_lambert(sigma_a[c] + sigma_s[c], distance))
}

kernel! {
    /// The rays that leave, towards the light and on, and roulette.
    pub fn depart(b: &'a mut Block, depth: Depth) {
        for k in 0..WIDTH {
            depart_from(b, k, &depth);
        }
    }
}

/// [`depart`] of a vertex.
#[inline(always)]
pub fn depart_from(b: &mut Block, k: usize, depth: &Depth) {
    let (p, error, n) = (get3(&b.p, k), get3(&b.error, k), get3(&b.n, k));
    let wi = get3(&b.light_wi, k);
    // Shadow ray, and the origin of the next ray, both moved off the surface by its error bounds.
    let ray = shadow_ray(p, offset_ray_origin(p, error, n, wi), wi, b.light_distance[k]);
    set3(&mut b.shadow_origin, k, ray.origin);
    set3(&mut b.shadow_direction, k, ray.direction);
    b.shadow_end[k] = ray.t_max;
    set3(&mut b.origin, k, offset_ray_origin(p, error, n, get3(&b.wi, k)));
    let beta = get4(&b.beta, k);
    let is_finite = beta[0].is_finite() & beta[1].is_finite() & beta[2].is_finite() & beta[3].is_finite();
    // Russian roulette by the strongest lane, or by the first where one wavelength is left.
    let most = beta[0].max(beta[1]).max(beta[2].max(beta[3]));
    let live = if b.is_single[k] != 0 { beta[0] } else { most } * b.roulette_scale[k];
    let live = if b.is_in_medium[k] != 0 { live * IN_MEDIUM } else { live };
    let number = b.roulette_u[k];
    let scale = roulette(live, b.events[k].wrapping_add(1), depth, None, || number);
    let survives = scale.is_some();
    let scale = scale.unwrap_or(0.0);
    set4(&mut b.beta, k, by_lane(|c| beta[c] * scale));
    b.fate[k] = if b.is_drawn[k] == 0 {
        ENDS
    } else if !is_finite {
        IS_NOT_FINITE
    } else {
        u32::from(survives)
    };
}

#[cfg(test)]
mod tests {
    use super::{
        super::media::{PASSES, SCATTERS, flights, phases},
        *,
    };
    use steradian_accel::{Isa, Lanes};
    use steradian_math::hash::HashRng;

    /// A block of any vertices, among them degenerate triangles, lights behind, black and white surfaces.
    fn any() -> Block {
        let (mut b, mut rng) = (Block::default(), HashRng::new(7));
        for k in 0..WIDTH {
            let mut number = || rng.next_f32() * 2.0 - 1.0;
            let mut vector = || Vec3::new(number(), number(), number());
            for corner in 0..3 {
                set3(&mut b.corners[corner], k, if k == 3 { Vec3::ONE } else { vector() });
                set3(&mut b.normals[corner], k, if k == 5 { Vec3::ZERO } else { vector().normalize() });
            }
            set3(&mut b.direction, k, vector().normalize());
            set3(&mut b.light_wi, k, vector().normalize());
            set3(&mut b.light_n, k, vector().normalize());
            let (x, y) = (vector().normalize(), vector());
            let y = y - x * x.dot(y);
            set3(&mut b.flat_corner, k, vector() * 3.0);
            set3(&mut b.flat_edges[0], k, x);
            set3(&mut b.flat_edges[1], k, y);
            set3(&mut b.flat_n, k, x.cross(y).normalize());
            for child in 0..2 {
                let (center, axis) = (vector(), vector().normalize());
                let (cos_o, two_sided) = ([-1.0, 1.0, 0.3][k % 3], k % 4 == 0);
                let cluster = Cluster { center, half2: 0.01, axis, cos_o, cos_e: 0.0, intensity: 1.0, two_sided };
                b.children[child].set(k, &cluster);
            }
            let mut unit = || rng.next_f32();
            (b.choice[k], b.chance[k]) = (unit(), 1.0);
            (b.uv[0][k], b.uv[1][k]) = (unit() * 0.5, unit() * 0.5);
            b.is_flat[k] = (k % 4 < 2).into();
            (b.flat_is_triangle[k], b.flat_is_two_sided[k]) = ((k % 8 < 2).into(), (k % 3 == 0).into());
            b.flat_area[k] = 1.0;
            b.light_distance[k] = if k == 8 { f32::INFINITY } else { unit() };
            b.light_pdf[k] = if k == 9 { 0.0 } else { unit() * 4.0 };
            (b.light_is_delta[k], b.is_smooth[k]) = ((k % 3 == 0).into(), (k as u32) % 2);
            b.roulette_scale[k] = 1.0;
            b.is_single[k] = (k % 7 == 0).into();
            let grey = [0.0, 1.0, unit()][k % 3];
            set4(&mut b.reflectance, k, [grey; 4]);
            set4(&mut b.light_radiance, k, [unit(), unit(), unit(), 0.0]);
            set4(&mut b.beta, k, if k == 7 { [f32::INFINITY; 4] } else { [unit(), unit(), unit(), unit()] });
            b.events[k] = k as u32 / 2;
            b.lanes[k] = [3, 1, 4][k % 3];
            b.end[k] = if k == 4 { f32::INFINITY } else { unit() * 3.0 };
            b.asymmetry[k] = [0.0, 0.8, -0.3, 0.999][k % 4];
            set4(&mut b.sigma_a, k, [unit(), unit(), 0.0, 0.0]);
            set4(&mut b.sigma_s, k, if k == 6 { [0.0; 4] } else { [unit(), unit(), 0.5, 0.0] });
            b.sampler = [b.sampler[0], b.sampler[1]].map(|mut c| {
                c[k] = (unit() * 4e9) as u32;
                c
            });
        }
        b
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let depth = Depth { max: 20, roulette_after: 3, hide_emitters: false };
        let after = |isa| {
            let (mut b, lanes) = (any(), Lanes::of(isa));
            surfaces(lanes, &mut b);
            numbers(lanes, &mut b);
            children(lanes, &mut b);
            flat_lights(lanes, &mut b);
            let mut small = b.clone();
            small_lights(lanes, &mut small);
            let mut in_media = b.clone();
            diffuse(lanes, &mut b, depth);
            depart(lanes, &mut small, depth);
            diffuse_in_media(lanes, &mut in_media, depth);
            let mut scattered = in_media.clone();
            flights(lanes, &mut scattered);
            phases(lanes, &mut scattered, depth);
            (b, small, in_media, scattered)
        };
        let expected = format!("{:?}", after(Isa::Baseline));
        assert!(Isa::ALL.into_iter().all(|isa| format!("{:?}", after(isa)) == expected));
        let (b, _, in_media, scattered) = after(Isa::Baseline);
        assert_eq!(b.is_unusual[3], 1);
        assert_ne!(b.light, in_media.light);
        let count = |column: &Column<u32>, value| column.iter().filter(|v| **v == value).count();
        assert!(count(&b.fate, GOES_ON) > 3 && count(&b.fate, ENDS) > 3 && count(&b.is_lit, 1) > 1);
        assert!(count(&scattered.flight, SCATTERS) > 3 && count(&scattered.flight, PASSES) > 3);
    }
}
