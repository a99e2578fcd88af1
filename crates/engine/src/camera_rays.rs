//! Samples of pixels in columns: their random numbers, places on the film, and camera rays. Each has the bits of
//! [`PixelSample::at`].

use crate::{PixelSample, dimension, partition::Place};
use steradian_accel::{
    Lanes,
    columns::{Column, WIDTH, get3, set3},
    kernel,
};
use steradian_core::{
    Scene,
    camera::Pinhole,
    sampler::{Sampler, sobol_scramble, z_order},
};
use steradian_math::{Ray, Spectrum, Vec2};

/// All columns are one value, so that kernels see that none overlaps another.
#[repr(align(64))]
#[derive(Clone, Debug)]
struct Block {
    x: Column<u32>,
    y: Column<u32>,
    /// The number of the sample, and how many bits such numbers have.
    number: Column<u32>,
    bits: Column<u32>,
    /// [`Sampler::z_base`].
    base: Column<u32>,
    // By `numbers`.
    seed: Column<u32>,
    index: Column<u32>,
    film: [Column; 2],
    /// From the pixel's middle.
    offset: [Column; 2],
    // By `rays`.
    origin: [Column; 3],
    direction: [Column; 3],
}

impl Default for Block {
    fn default() -> Self {
        let (numbers, columns) = ([0; WIDTH], [0.0; WIDTH]);
        Self {
            x: numbers,
            y: numbers,
            number: numbers,
            bits: numbers,
            base: numbers,
            seed: numbers,
            index: numbers,
            film: [columns; 2],
            offset: [columns; 2],
            origin: [columns; 3],
            direction: [columns; 3],
        }
    }
}

kernel! {
    /// The samplers, and places on the film.
    fn numbers(b: &'a mut Block) {
        for k in 0..WIDTH {
            let (seed, index) = z_order(b.base[k], [b.x[k], b.y[k]], b.number[k], b.bits[k]);
            (b.seed[k], b.index[k]) = (seed, index);
            let film = sobol_scramble(seed, dimension::FILM).point_2d(index.reverse_bits());
            (b.film[0][k], b.film[1][k]) = (film[0], film[1]);
        }
    }
}

kernel! {
    /// The camera rays.
    fn rays(b: &'a mut Block, camera: Pinhole) {
        for k in 0..WIDTH {
            let point = Vec2::new(b.x[k] as f32 + 0.5, b.y[k] as f32 + 0.5) + Vec2::new(b.offset[0][k], b.offset[1][k]);
            let (origin, direction) = camera.ray(point);
            set3(&mut b.origin, k, origin);
            set3(&mut b.direction, k, direction);
        }
    }
}

/// Takes samples of pixels, block by block.
#[derive(Debug)]
pub struct CameraRays {
    block: Box<Block>,
    lanes: Lanes,
    camera: Pinhole,
}

impl CameraRays {
    /// Camera rays of a scene; `None` where a sample takes more than places on the film and wavelengths.
    pub fn new(scene: &Scene, sampler: &Sampler) -> Option<Self> {
        let camera = scene.camera().pinhole(scene.film()).filter(|_| !scene.is_timed())?;
        sampler.z_base()?;
        Some(Self { block: Box::default(), lanes: Lanes::best(), camera })
    }

    /// Appends a sample of each pixel, given by sampler and number, with the weight that the film gives it.
    pub fn extend(
        &mut self,
        scene: &Scene,
        pixels: &[(Place, Sampler, u32)],
        samples: &mut Vec<PixelSample>,
        weights: &mut Vec<f32>,
    ) {
        let b = &mut *self.block;
        for pixels in pixels.chunks(WIDTH) {
            for (k, (place, sampler, number)) in pixels.iter().enumerate() {
                (b.x[k], b.y[k], b.number[k], b.bits[k]) = (place.x, place.y, *number, sampler.bits());
                b.base[k] = sampler.z_base().unwrap_or_default();
            }
            numbers(self.lanes, b);
            for k in 0..pixels.len() {
                let (offset, weight) = scene.film().filter.sample(Vec2::new(b.film[0][k], b.film[1][k]));
                (b.offset[0][k], b.offset[1][k]) = (offset.x, offset.y);
                weights.push(weight);
            }
            rays(self.lanes, b, self.camera);
            for (k, (_, sampler, _)) in pixels.iter().enumerate() {
                let own = sampler.at(b.seed[k], b.index[k]);
                let direction = get3(&b.direction, k);
                let ray = Ray { t_max: self.camera.end(direction), ..Ray::new(get3(&b.origin, k), direction) };
                let lambda = scene.mode().wavelengths(|| own.get_1d(dimension::WAVELENGTH));
                samples.push(PixelSample { ray, own, joint: own, lambda, radiance: Spectrum::ZERO, rays: 0 });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::partition::Partition;
    use steradian_compile::{Options, compile};
    use steradian_core::{ColorMode, sampler::SamplerKind};
    use steradian_math::{DVec3, Transform};
    use steradian_scene::{Family, Node, SceneDesc};

    #[test]
    fn samples_have_the_bits_of_single_ones() {
        for (mode, filter, near, far) in
            [(ColorMode::Rgb, "box", 0.0, f64::INFINITY), (ColorMode::Spectral, "gaussian", 0.01, 3.7)]
        {
            let mut desc = SceneDesc::default();
            desc.filter = Some(desc.add(Node::new(Family::Filter, filter, None)));
            let film = Node::new(Family::Film, "rgb", None).with("width", 300_i64).with("height", 40_i64);
            desc.film = Some(desc.add(film));
            let place = Transform::look_at(DVec3::new(0.3, 1.0, -4.0), DVec3::new(0.0, 0.7, 0.1), DVec3::Y).unwrap();
            let camera = Node::new(Family::Camera, "perspective", None).with("fov", 50.0).with("near", near);
            let camera = if far.is_finite() { camera.with("far", far) } else { camera };
            desc.cameras = vec![desc.add(camera.with("to_world", place))];
            let scene = compile(&desc, &Options { mode: Some(mode), ..Options::default() }).scene.unwrap();
            let sampler = Sampler { kind: SamplerKind::ZSobol, spp: 6, seed: 3 };
            let pixels: Vec<_> = (0..75)
                .map(|k| (Place::alone([k * 4, k % 40]), Sampler { spp: 1 + k % 20, ..sampler }.half(k), k * k))
                .collect();
            let (mut samples, mut weights) = (Vec::new(), Vec::new());
            let mut rays = CameraRays::new(&scene, &sampler).expect("a camera without lens");
            rays.extend(&scene, &pixels, &mut samples, &mut weights);
            for ((place, sampler, number), found) in pixels.iter().zip(samples.into_iter().zip(weights)) {
                let expected = PixelSample::at(&scene, sampler, &Partition::new(1, 3), *number, place);
                assert_eq!(format!("{found:?}"), format!("{expected:?}"));
            }
        }
    }
}
