//! First hits of camera rays, summed over a pixel: the auxiliary layers, and the guides of a denoiser.

/// First hit of a camera ray: the auxiliary layers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FirstHit {
    /// Reflectance estimate, linear Rec.709.
    pub albedo: [f32; 3],
    /// Shading normal, world space; zero where nothing is hit.
    pub normal: [f32; 3],
    /// Albedo of what is seen, through mirrors and smooth glass: times theirs.
    pub seen_albedo: [f32; 3],
    /// Shading normal of what is seen, through mirrors and smooth glass; theirs where nothing is behind.
    pub seen_normal: [f32; 3],
    /// Geometric normal, world space, on the side of the camera; zero where nothing is hit.
    pub geometric_normal: [f32; 3],
    /// World-space position.
    pub position: [f32; 3],
    /// Distance along the camera's axis.
    pub depth: f32,
    /// Distance along the ray.
    pub distance: f32,
    /// Motion since the previous frame: pixels to the right and down on the screen, and the distance away along the
    /// camera's axis.
    pub motion: [f32; 3],
    /// Surface parameters.
    pub uv: [f32; 2],
    /// Index of the shape, counted from one; 0 for nothing.
    pub shape: u32,
    /// Index of the material, counted from one; 0 for nothing.
    pub material: u32,
    /// 1 where a surface is hit; in the mean the part of the pixel that surfaces cover.
    pub coverage: f32,
    /// Part of the background that surfaces hide: 1, or of a shadow catcher the part of its direct light that is
    /// blocked.
    pub opacity: f32,
    /// True if the surface is a shadow catcher.
    pub catches_shadows: bool,
}

/// Sums of first hits over the samples of a pixel; ids are those of the first surface that a sample hits.
#[derive(Clone, Copy, Debug, Default)]
pub struct FirstHitSums {
    /// Sum of the averaged quantities.
    pub sum: FirstHit,
    /// Samples added.
    pub samples: u32,
}

impl FirstHitSums {
    /// Adds the first hit of a sample.
    pub fn add(&mut self, hit: &FirstHit) {
        self.add_sums(&Self { sum: *hit, samples: 1 });
    }

    /// Adds the sums of further samples.
    pub fn add_sums(&mut self, of: &Self) {
        let add = |a: &mut [f32], b: &[f32]| {
            let finite = |(a, b): (&mut f32, &f32)| {
                if b.is_finite() {
                    *a = (*a + b).clamp(f32::MIN, f32::MAX);
                }
            };
            a.iter_mut().zip(b).for_each(finite);
        };
        let (s, hit) = (&mut self.sum, &of.sum);
        add(&mut s.albedo, &hit.albedo);
        add(&mut s.normal, &hit.normal);
        add(&mut s.seen_albedo, &hit.seen_albedo);
        add(&mut s.seen_normal, &hit.seen_normal);
        add(&mut s.geometric_normal, &hit.geometric_normal);
        add(&mut s.position, &hit.position);
        add(&mut s.motion, &hit.motion);
        add(&mut s.uv, &hit.uv);
        add(std::slice::from_mut(&mut s.depth), &[hit.depth]);
        add(std::slice::from_mut(&mut s.distance), &[hit.distance]);
        add(std::slice::from_mut(&mut s.coverage), &[hit.coverage]);
        add(std::slice::from_mut(&mut s.opacity), &[hit.opacity]);
        if s.shape == 0 {
            (s.shape, s.material) = (hit.shape, hit.material);
        }
        self.samples += of.samples;
    }

    /// The averages: of albedo (held in [0, 1]), normals, motion, coverage and opacity over all samples; of position,
    /// parameters and distances over those that hit a surface. Distances are infinite where none does.
    pub fn mean(&self) -> FirstHit {
        let s = &self.sum;
        let over_all = 1.0 / self.samples.max(1) as f32;
        let over_hits = if s.coverage > 0.0 { 1.0 / s.coverage } else { 0.0 };
        let distance = |sum: f32| if s.coverage > 0.0 { sum * over_hits } else { f32::INFINITY };
        FirstHit {
            albedo: s.albedo.map(|v| (v * over_all).clamp(0.0, 1.0)),
            normal: s.normal.map(|v| v * over_all),
            seen_albedo: s.seen_albedo.map(|v| (v * over_all).clamp(0.0, 1.0)),
            seen_normal: s.seen_normal.map(|v| v * over_all),
            geometric_normal: s.geometric_normal.map(|v| v * over_all),
            motion: s.motion.map(|v| v * over_all),
            position: s.position.map(|v| v * over_hits),
            uv: s.uv.map(|v| v * over_hits),
            depth: distance(s.depth),
            distance: distance(s.distance),
            coverage: s.coverage * over_all,
            opacity: s.opacity * over_all,
            ..*s
        }
    }
}
