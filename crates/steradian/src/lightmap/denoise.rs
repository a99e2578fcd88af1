//! Lightmaps without most of their noise: regression ([`steradian_denoise::nlm`]) over each chart by itself.
//!
//! A chart is a picture of its own, guided by the variances of its texels and the normals of their surfaces. Distances
//! in it are those on the surface, so positions tell nothing more. Texels about it repeat the nearest one, for noise
//! that neighbours tell of; as they show no surface they have no weight, and charts never mix.

use super::{NONE, Texel, spread};
use crate::Error;
use rayon::prelude::*;
use steradian_denoise::{
    Image,
    nlm::{Picture, Settings, denoise},
};
use steradian_math::Vec3;

/// Texels of the box about a chart from which charts are taken one after the other, to bound the memory.
const LARGE: usize = 1 << 16;
/// Columns and rows about a chart that repeat the texels nearest to them.
const AROUND: u32 = 3;

/// Removes the noise of all parts of texels in an atlas of `side` columns. The light of each chart stays in the mean.
///
/// # Errors
/// [`Error::Denoise`] for charts too large to filter.
pub(super) fn charts(texels: &mut [Texel], side: usize) -> Result<(), Error> {
    let mut order: Vec<usize> = (0..texels.len()).collect();
    order.sort_by_key(|k| texels[*k].chart);
    let charts: Vec<Chart<'_>> =
        order.chunk_by(|a, b| texels[*a].chart == texels[*b].chart).map(|m| Chart::of(m, texels, side)).collect();
    let (large, small): (Vec<&Chart<'_>>, Vec<&Chart<'_>>) = charts.iter().partition(|c| c.size[0] * c.size[1] > LARGE);
    let large = large.into_iter().map(|chart| Ok((chart.members, chart.filtered(texels, side)?)));
    let mut found = large.collect::<Result<Vec<_>, Error>>()?;
    let small = small.into_par_iter().map(|chart| Ok((chart.members, chart.filtered(texels, side)?)));
    found.extend(small.collect::<Result<Vec<_>, Error>>()?);
    for (members, parts) in found {
        members.iter().zip(parts).for_each(|(k, parts)| texels[*k].parts = parts);
    }
    Ok(())
}

/// A chart in a box about it.
struct Chart<'a> {
    /// Its texels.
    members: &'a [usize],
    /// First column and row of the box; those beyond the atlas count on below zero.
    first: [isize; 2],
    /// Columns and rows of the box.
    size: [usize; 2],
}

impl<'a> Chart<'a> {
    fn of(members: &'a [usize], texels: &[Texel], side: usize) -> Self {
        let reach = AROUND as usize;
        let range = |along: &dyn Fn(usize) -> usize| {
            let ends = members.iter().map(|k| along(texels[*k].number));
            ends.fold([usize::MAX, 0], |[low, high], at| [low.min(at), high.max(at)])
        };
        let ranges = [range(&|number| number % side), range(&|number| number / side)];
        Self {
            members,
            first: ranges.map(|[low, _]| low as isize - reach as isize),
            size: ranges.map(|[low, high]| high - low + 1 + 2 * reach),
        }
    }

    /// New parts of its texels.
    fn filtered(&self, texels: &[Texel], side: usize) -> Result<Vec<Vec<[f32; 3]>>, Error> {
        let [width, height] = self.size;
        let place = |k: usize| {
            let at = [texels[k].number % side, texels[k].number / side];
            let [x, y] = [0, 1].map(|axis| (at[axis] as isize - self.first[axis]) as usize);
            y * width + x
        };
        let settings = Settings::default();
        let mut numbers = vec![NONE; width * height];
        self.members.iter().for_each(|k| numbers[place(*k)] = *k as u32);
        let depth = numbers.iter().map(|number| if *number == NONE { f32::INFINITY } else { 1.0 }).collect();
        let depth = Image::new(width as u32, height as u32, depth)?;
        let numbers = spread(numbers, self.size, AROUND);
        let image = |value: &dyn Fn(&Texel) -> Vec3| {
            let values = numbers.iter().map(|number| texels.get(*number as usize).map_or(Vec3::ZERO, value));
            Image::new(width as u32, height as u32, values.collect())
        };
        let normal = image(&|texel| texel.normal)?;
        let mut parts = vec![Vec::new(); self.members.len()];
        for part in 0..texels[self.members[0]].parts.len() {
            let radiance = image(&|texel| texel.parts[part].into())?;
            let variance = image(&|texel| texel.variances[part].into())?;
            let picture = Picture {
                radiance: &radiance,
                variance: Some(&variance),
                albedo: None,
                normal: Some(&normal),
                depth: Some(&depth),
            };
            let denoised = denoise(&picture, &settings)?.radiance;
            for (parts, k) in parts.iter_mut().zip(self.members) {
                parts.push(denoised.values()[place(*k)].to_array());
            }
        }
        Ok(parts)
    }
}
