//! Surfaces between opaque and absent: the layers of each pixel, and the methods that blend them with what is behind.
//!
//! A pixel shows Σ wₖ Lₖ + w L of its layers k and of the opaque surface behind them. In the order of distance
//! wₖ = αₖ Πⱼ﹤ₖ (1 − αⱼ) and w = Πⱼ (1 − αⱼ): the mean of the stochastic alpha test, and what methods are held against.

mod fragments;
mod order;

use crate::{
    Error,
    culling::Selection,
    draw_list::DrawList,
    options::Transparency,
    projection::Projected,
    visibility::{Cover, Seen, Visibility, Wanted, local},
};
use steradian_core::Scene;

/// A transparent surface at a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Fragment {
    /// Index of the pixel, by rows.
    pub pixel: u32,
    pub seen: Seen,
    /// Opacity, in (0, 1).
    pub opacity: f32,
    /// Index of its item in the draw list, and its part.
    pub part: (u32, u32),
}

/// View whose layers are asked for.
#[derive(Clone, Copy)]
pub struct View<'a> {
    pub scene: &'a Scene,
    pub list: &'a DrawList,
    pub projected: &'a Projected,
    pub selection: Selection<'a>,
    /// Opaque surfaces of the view.
    pub opaque: &'a Visibility,
}

/// The transparent layers of all pixels.
#[derive(Debug)]
pub struct Layers {
    /// Fragments by pixels, and their shares of the light.
    all: Vec<(Fragment, f32)>,
    /// First fragment of each pixel, and the end of the last.
    starts: Vec<usize>,
    /// Shares of what is opaque.
    rest: Vec<f32>,
}

impl Layers {
    /// Finds the layers of a view, up to `layers` for each pixel where they are peeled.
    ///
    /// # Errors
    /// More fragments than fit, and scenes that the method cannot order.
    pub fn new(view: &View<'_>, method: Transparency, layers: u32) -> Result<Self, Error> {
        // Fragments of one pixel after the other, those of each in the order of the method.
        let fragments = match method {
            Transparency::Peel => peeled(view, layers)?,
            Transparency::Sorted => order::sorted(view, fragments::gather(view)?),
            Transparency::Bsp => order::by_planes(view, fragments::gather(view)?)?,
            Transparency::Weighted | Transparency::ABuffer | Transparency::Dither => fragments::gather(view)?,
        };
        let mut found = Self { all: Vec::with_capacity(fragments.len()), starts: vec![0], rest: Vec::new() };
        for pixel in 0..view.opaque.depths.len() {
            let start = found.all.len();
            let of_pixel = fragments[start..].iter().take_while(|f| f.pixel as usize == pixel);
            // Front to back: each layer gets its opacity of what the layers before it let through.
            let mut rest = 1.0;
            for fragment in of_pixel {
                found.all.push((*fragment, rest * fragment.opacity));
                rest *= 1.0 - fragment.opacity;
            }
            if method == Transparency::Weighted {
                view.weigh(&mut found.all[start..], 1.0 - rest, pixel);
            }
            found.starts.push(found.all.len());
            found.rest.push(rest);
        }
        Ok(found)
    }

    /// Fragments of a pixel with their shares of its light, and the share of what is opaque.
    pub fn of(&self, pixel: usize) -> (&[(Fragment, f32)], f32) {
        (&self.all[self.starts[pixel]..self.starts[pixel + 1]], self.rest[pixel])
    }
}

impl View<'_> {
    /// Shares of the layers of a pixel that cover `covered` of it, by αₖ w(dₖ) with w = max(0.01, 3000 (1 − d)³) of
    /// distances d along the view from 0 to 1 (McGuire, Bavoil 2013, equations 2 and 10).
    fn weigh(&self, layers: &mut [(Fragment, f32)], covered: f32, pixel: usize) {
        let ray = self.ray(pixel);
        let weight = |fragment: &Fragment| {
            let distance = self.projected.along_axis(ray.at(fragment.seen.hit.t));
            let near = 1.0 - self.projected.share_of(distance);
            fragment.opacity * (3e3 * near * near * near).max(1e-2)
        };
        let sum: f32 = layers.iter().map(|(fragment, _)| weight(fragment)).sum();
        layers.iter_mut().for_each(|(fragment, share)| *share = covered * weight(fragment) / sum);
    }

    /// Ray of a pixel.
    fn ray(&self, pixel: usize) -> steradian_math::Ray {
        let width = self.scene.film().crop.width() as usize;
        self.projected.ray(self.scene, [(pixel % width) as u32, (pixel / width) as u32])
    }
}

/// Depth peeling: each picture shows the nearest transparent surface behind that of the picture before.
fn peeled(view: &View<'_>, layers: u32) -> Result<Vec<Fragment>, Error> {
    let View { scene, list, projected, selection, opaque } = *view;
    let width = scene.film().crop.width();
    let (mut all, mut cover) = (Vec::new(), Cover::Transparent);
    for _ in 0..layers {
        let picture = Visibility::draw_wanted(scene, list, projected, Wanted { selection, method: None, cover })?;
        let count = all.len();
        for (pixel, depth) in (0..).zip(&picture.depths).filter(|(pixel, d)| **d > opaque.depths[*pixel as usize]) {
            let at = [pixel % width, pixel / width];
            let Some(part) = picture.part(pixel as usize).filter(|_| *depth > 0.0) else { continue };
            let Some(seen) = picture.seen(scene, list, projected, at) else { continue };
            let ray = local(scene, &list.items[part.0 as usize], &projected.ray(scene, at));
            all.push(Fragment { pixel, seen, opacity: scene.coverage(&seen.hit, &ray), part });
        }
        if all.len() == count {
            break;
        }
        cover = Cover::Behind(picture.depths);
    }
    // Stable: the layers of a pixel keep their order.
    all.sort_by_key(|fragment| fragment.pixel);
    Ok(all)
}
