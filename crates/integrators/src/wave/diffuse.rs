//! Lambertian surfaces, wholly in columns.

use super::{
    Shadows, Walk, Walker,
    block::{self, Block, GOES_ON, IS_NOT_FINITE},
    lights::illuminate,
    media::gather_medium,
};
use steradian_accel::columns::{get3, get4, set3, set4};
use steradian_core::{ColorMode, Scene, light::LightContext, scene::Hit};
use steradian_engine::PixelSample;
use steradian_math::{Ray, Spectrum};

impl<const MEDIA: bool> Walk<'_, '_, MEDIA> {
    /// Scatters paths, up to a block of them, at such surfaces.
    pub fn scatter_diffuse(
        &self,
        vertices: &[(u32, Hit)],
        (b, walkers, shadows): (&mut Block, &mut [Walker], &mut Shadows),
        pixel_samples: &mut [PixelSample],
    ) {
        // Columns in, kernels in turn, columns out: surface, random numbers, material, light sample, direction and
        // roulette.
        gather::<MEDIA>(b, vertices, walkers, self.scene, pixel_samples);
        block::surfaces(self.lanes, b);
        block::numbers(self.lanes, b);
        materials(b, vertices, self.scene, pixel_samples);
        let numbers = vertices.iter().map(|(number, _)| *number);
        illuminate(self.lanes, b, numbers.clone(), self.scene, pixel_samples);
        let are_guided = self.are_guided(b, vertices.len());
        if are_guided.contains(&true) {
            let arriving = b.beta;
            block::diffuse_light(self.lanes, b);
            self.draw_guided(b, (vertices, &are_guided), &arriving, walkers);
            block::depart(self.lanes, b, self.path.depth);
        } else if MEDIA {
            block::diffuse_in_media(self.lanes, b, self.path.depth);
        } else {
            block::diffuse(self.lanes, b, self.path.depth);
        }
        self.depart(b, numbers.enumerate(), walkers, pixel_samples, shadows);
    }

    /// Lets paths at places of a block go on as that has it, in the medium where they are.
    pub fn depart(
        &self,
        b: &Block,
        places: impl Iterator<Item = (usize, u32)>,
        walkers: &mut [Walker],
        pixel_samples: &mut [PixelSample],
        shadows: &mut Shadows,
    ) {
        for (k, number) in places {
            let Walker { state, rays, goes_on, .. } = &mut walkers[number as usize];
            // Of the last surface there is emission alone.
            // The path goes on if the kernel says so and the depth allows another event.
            *goes_on = state.events < self.path.depth.max && b.fate[k] == GOES_ON;
            if state.events >= self.path.depth.max {
                continue;
            }
            let time = state.ray.time;
            // Light sample: its shadow ray waits for the batch.
            if b.is_lit[k] != 0 {
                shadows.push_of(b, k, number, time);
                *rays += 1;
            }
            let beta = Spectrum::new(get4(&b.beta, k));
            if b.fate[k] == IS_NOT_FINITE {
                pixel_samples[number as usize].radiance = beta;
            }
            // The state after the event: ray, throughput, and the origin for the MIS weight of the next emission.
            if *goes_on {
                state.ray = Ray { time, ..Ray::new(get3(&b.origin, k), get3(&b.wi, k)) };
                (state.beta, state.roulette_scale) = (beta, b.roulette_scale[k]);
                state.origin = Some((LightContext { p: get3(&b.p, k), n: get3(&b.light_n, k) }, b.pdf[k]));
                state.events += 1;
                (state.differential, state.is_from_medium) = (None, b.is_in_medium[k] != 0);
            }
        }
    }
}

impl Block {
    /// Fills the columns that tell of the path that comes to a place.
    #[inline]
    pub fn gather_path(&mut self, k: usize, walker: &Walker, scene: &Scene, sample: &PixelSample) {
        let state = &walker.state;
        set3(&mut self.direction, k, state.ray.direction);
        set4(&mut self.beta, k, state.beta.to_array());
        (self.roulette_scale[k], self.events[k], self.passes[k]) = (state.roulette_scale, state.events, state.passes);
        let is_spectral = scene.mode() == ColorMode::Spectral;
        self.is_single[k] = (is_spectral && sample.lambda.is_secondary_terminated()).into();
        (self.sampler[0][k], self.sampler[1][k]) = walker.sampler;
    }
}

/// Fills the columns that tell of hits and of the paths that come there.
fn gather<const MEDIA: bool>(
    block: &mut Block,
    vertices: &[(u32, Hit)],
    walkers: &[Walker],
    scene: &Scene,
    pixel_samples: &[PixelSample],
) {
    for (k, (number, hit)) in vertices.iter().enumerate() {
        let Some((mesh, _)) = scene.lambertian(hit.id) else { continue };
        // Corners, and normals where the mesh is smooth.
        let index = mesh.triangles[hit.id.prim as usize].map(|i| i as usize);
        block.corners.iter_mut().zip(index).for_each(|(corner, i)| set3(corner, k, mesh.positions[i]));
        let is_smooth = !mesh.normals.is_empty();
        if is_smooth {
            block.normals.iter_mut().zip(index).for_each(|(normal, i)| set3(normal, k, mesh.normals[i]));
        }
        (block.is_smooth[k], block.is_flipped[k]) = (is_smooth.into(), mesh.flip.into());
        (block.uv[0][k], block.uv[1][k]) = (hit.u, hit.v);
        let (walker, sample) = (&walkers[*number as usize], &pixel_samples[*number as usize]);
        block.gather_path(k, walker, scene, sample);
        block.is_in_medium[k] = 0;
        // The medium attenuates light samples; without one its coefficients are zero.
        match walker.state.medium.filter(|_| MEDIA) {
            Some(medium) => gather_medium(block, k, &scene.media()[medium as usize], (scene, &sample.lambda)),
            None => (0..4).for_each(|c| (block.sigma_a[c][k], block.sigma_s[c][k]) = (0.0, 0.0)),
        }
    }
}

/// Fills the columns of Lambertian materials.
fn materials(b: &mut Block, vertices: &[(u32, Hit)], scene: &Scene, pixel_samples: &[PixelSample]) {
    for (k, (number, hit)) in vertices.iter().enumerate() {
        let Some((mesh, lambertian)) = scene.lambertian(hit.id) else { continue };
        // Normals of degenerate triangles by the general code.
        if b.is_unusual[k] != 0 {
            let s = mesh.bare(hit.id.prim, hit.u, hit.v);
            set3(&mut b.n, k, s.n);
            set3(&mut b.ns, k, s.ns);
            b.is_front[k] = u32::from(s.ns.dot(-get3(&b.direction, k)) > 0.0);
        }
        // The reflectance of the side that the ray sees, and the axis of the shading frame on that side.
        let (reflectance, is_flipped) = lambertian.side(b.is_front[k] != 0, &pixel_samples[*number as usize].lambda);
        set4(&mut b.reflectance, k, reflectance.to_array());
        set3(&mut b.light_n, k, get3(&b.ns, k) * if is_flipped { -1.0 } else { 1.0 });
        b.takes_light[k] = 1;
    }
}
