//! What is filtered, in columns.

use rayon::prelude::*;
use steradian_math::{Vec3, color::space::REC709};

use super::accumulate::Accumulated;
use crate::rows::{Row, Rows};

/// Planes of a term: its colour, the luminance of that, which is NaN where there is no value, and the variance of
/// luminance.
pub(super) const RED: usize = 0;
pub(super) const GREEN: usize = 1;
pub(super) const BLUE: usize = 2;
pub(super) const LUMINANCE: usize = 3;
pub(super) const VARIANCE: usize = 4;
/// How many planes a term has.
pub(super) const PLANES: usize = 5;

/// What is known of the pixels of all terms: the planes of one after those of another. Nothing outside the picture.
#[derive(Clone, Debug)]
pub(super) struct Estimates {
    pub rows: Rows,
    /// The weights of colours in luminance.
    pub luminance: Vec3,
}

impl Estimates {
    /// Of terms of which nothing is known.
    pub fn unknown(size: [u32; 2], terms: usize, margin: usize) -> Self {
        let planes = [0.0, 0.0, 0.0, f32::NAN, 0.0].repeat(terms);
        Self { rows: Rows::filled(size, &planes, margin), luminance: REC709.luminance_weights_f32() }
    }

    /// Whether they are of so many terms of a size.
    pub fn are_of(&self, size: [u32; 2], terms: usize) -> bool {
        self.rows.size() == size && self.rows.planes() == terms * PLANES
    }

    /// The colour of a pixel.
    #[inline]
    pub fn color(&self, term: usize, x: usize, y: usize) -> Vec3 {
        let plane = |plane| self.rows.at(term * PLANES + plane, x, y);
        Vec3::new(plane(RED), plane(GREEN), plane(BLUE))
    }

    /// The variance of its luminance.
    #[inline]
    pub fn variance(&self, term: usize, x: usize, y: usize) -> f32 {
        self.rows.at(term * PLANES + VARIANCE, x, y)
    }

    /// Makes histories of colours.
    pub fn keep_colors(&self, accumulated: &mut Rows<Accumulated>) {
        let (width, terms) = (accumulated.width(), accumulated.planes());
        accumulated.par_rows().for_each(|(y, mut row)| {
            for (term, x) in (0..terms).flat_map(|term| (0..width).map(move |x| (term, x))) {
                row.get_mut(term, x).color = self.color(term, x, y);
            }
        });
    }

    /// Sets a colour in a row, and its luminance, NaN where there is none.
    #[inline]
    pub fn set_color(row: &mut Row<'_>, term: usize, x: usize, color: Vec3, luminance: f32) {
        let planes = [(RED, color.x), (GREEN, color.y), (BLUE, color.z), (LUMINANCE, luminance)];
        planes.into_iter().for_each(|(plane, value)| row.set(term * PLANES + plane, x, value));
    }
}
