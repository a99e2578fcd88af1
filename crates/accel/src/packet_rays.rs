//! The rays that are traced together.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::simd::{COLUMNS, Lanes, WIDE, Wide};
use glam::Mat4;
use std::mem::offset_of;
use steradian_math::{Ray, Vec3};

/// The rays of a packet by rows.
#[derive(Clone, Debug)]
pub(crate) struct Packet {
    pub origin: [Wide; 3],
    pub direction: [Wide; 3],
    pub t_max: Wide,
}

impl Packet {
    /// Without rays.
    const EMPTY: Self =
        Self { origin: [Wide::splat(0.0); 3], direction: [Wide::splat(0.0); 3], t_max: Wide::splat(0.0) };

    /// Packet of some rays, no more than there are lanes; the lanes after these have no meaning.
    #[inline(always)]
    pub fn new<L: Lanes>(l: L, rays: &[Ray]) -> Self {
        // Fill the lanes of a short packet with copies of the first ray, which keeps their arithmetic harmless.
        if rays.len() < L::COUNT {
            let mut padded = [rays[0]; WIDE];
            padded[..rays.len()].copy_from_slice(rays);
            return Self::full(l, &padded);
        }
        Self::full(l, rays)
    }

    /// Packet of as many rays as there are lanes, from the start of a slice.
    #[inline(always)]
    fn full<L: Lanes>(l: L, rays: &[Ray]) -> Self {
        const { assert!(size_of::<Ray>() == size_of::<[f32; COLUMNS]>() && align_of::<Ray>() == align_of::<f32>()) };
        // Transpose rays into columns, one register for each coordinate.
        // SAFETY: a ray is so many `f32`.
        let columns = l.columns(unsafe { std::slice::from_raw_parts(rays.as_ptr().cast(), rays.len()) });
        let mut packet = Self::EMPTY;
        const ORIGIN: usize = offset_of!(Ray, origin) / size_of::<f32>();
        const DIRECTION: usize = offset_of!(Ray, direction) / size_of::<f32>();
        for axis in 0..3 {
            l.write(columns[ORIGIN + axis], &mut packet.origin[axis]);
            l.write(columns[DIRECTION + axis], &mut packet.direction[axis]);
        }
        l.write(columns[offset_of!(Ray, t_max) / size_of::<f32>()], &mut packet.t_max);
        packet
    }

    /// The rays in the space of an instance, with the same rounding as `Mat4::transform_point3` and
    /// `transform_vector3`, up to given distances.
    #[inline(always)]
    pub fn transformed<L: Lanes>(&self, l: L, m: &Mat4, t_max: &Wide) -> Self {
        let mut packet = Self { t_max: *t_max, ..Self::EMPTY };
        let [ox, oy, oz] = [l.read(&self.origin[0]), l.read(&self.origin[1]), l.read(&self.origin[2])];
        let [dx, dy, dz] = [l.read(&self.direction[0]), l.read(&self.direction[1]), l.read(&self.direction[2])];
        for axis in 0..3 {
            let (x, y) = (l.splat(m.x_axis[axis]), l.splat(m.y_axis[axis]));
            let (z, w) = (l.splat(m.z_axis[axis]), l.splat(m.w_axis[axis]));
            // Multiply and add in the order of the scalar matrix product, so that every ray gets its own bits.
            let origin = l.add(l.mul(z, oz), l.add(l.mul(y, oy), l.mul(x, ox)));
            let direction = l.add(l.mul(z, dz), l.add(l.mul(y, dy), l.mul(x, dx)));
            l.write(l.add(w, origin), &mut packet.origin[axis]);
            l.write(direction, &mut packet.direction[axis]);
        }
        packet
    }

    /// One of the rays, up to a distance. Packets are of scenes in which nothing moves.
    #[inline(always)]
    pub fn ray(&self, lane: usize, t_max: f32) -> Ray {
        let vector = |rows: &[Wide; 3]| Vec3::new(rows[0].0[lane], rows[1].0[lane], rows[2].0[lane]);
        Ray { t_max, ..Ray::new(vector(&self.origin), vector(&self.direction)) }
    }
}
