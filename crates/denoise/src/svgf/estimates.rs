//! Input of the filter, in columns.

use steradian_math::{Vec3, color::space::REC709};

use crate::{
    balance::{Amount, give_back},
    image::Image,
    rows::{Row, Rows},
};

/// Planes of a term: its colour, the luminance of that, which is NaN where there is no value, and the variance of
/// luminance.
pub(super) const RED: usize = 0;
pub(super) const GREEN: usize = 1;
pub(super) const BLUE: usize = 2;
pub(super) const LUMINANCE: usize = 3;
pub(super) const VARIANCE: usize = 4;
/// Number of planes of a term.
pub(super) const PLANES: usize = 5;

/// Estimates of the pixels of all terms: the planes of one after those of another. Nothing outside the picture.
#[derive(Clone, Debug)]
pub(super) struct Estimates {
    pub rows: Rows,
    /// The weights of colours in luminance.
    pub luminance: Vec3,
}

impl Estimates {
    /// Estimates of terms of which nothing is known.
    pub fn unknown(size: [u32; 2], terms: usize, margin: usize) -> Self {
        // Unknown luminance is NaN: it has no weight for others.
        let planes = [0.0, 0.0, 0.0, f32::NAN, 0.0].repeat(terms);
        Self { rows: Rows::filled(size, &planes, margin), luminance: REC709.luminance_weights_f32() }
    }

    /// True if they are of so many terms of a size.
    pub fn are_of(&self, size: [u32; 2], terms: usize) -> bool {
        self.rows.size() == size && self.rows.planes() == terms * PLANES
    }

    /// The colour of a pixel.
    #[inline]
    pub fn color(&self, term: usize, x: usize, y: usize) -> Vec3 {
        let plane = |plane| self.rows.at(term * PLANES + plane, x, y);
        Vec3::new(plane(RED), plane(GREEN), plane(BLUE))
    }

    /// The colours of all terms; NaN where nothing is known.
    pub fn colors(&self) -> Vec<Image<Vec3>> {
        let [width, height] = self.rows.size();
        let of_term = |term| {
            Image::by_rows(width, height, |x, y| {
                let (x, y) = (x as usize, y as usize);
                let luminance = self.rows.at(term * PLANES + LUMINANCE, x, y);
                if luminance.is_nan() { Vec3::NAN } else { self.color(term, x, y) }
            })
        };
        (0..self.rows.planes() / PLANES).map(of_term).collect()
    }

    /// Colours of all terms, with the light that filtering lost of `noisy` given back.
    pub fn balanced(&self, noisy: Option<&[Image<Vec3>]>) -> Vec<Image<Vec3>> {
        let mut all = self.colors();
        // Balance each term against its mean before filtering.
        for (colors, noisy) in all.iter_mut().zip(noisy.unwrap_or_default()) {
            give_back(colors, noisy, None, |pixel| noisy.values()[pixel].is_finite(), Amount::ALL);
        }
        all
    }

    /// The variance of its luminance.
    #[inline]
    pub fn variance(&self, term: usize, x: usize, y: usize) -> f32 {
        self.rows.at(term * PLANES + VARIANCE, x, y)
    }

    /// Sets a colour in a row, and its luminance, NaN where there is none.
    #[inline]
    pub fn set_color(row: &mut Row<'_>, term: usize, x: usize, color: Vec3, luminance: f32) {
        // One value for each plane of the term.
        let planes = [(RED, color.x), (GREEN, color.y), (BLUE, color.z), (LUMINANCE, luminance)];
        planes.into_iter().for_each(|(plane, value)| row.set(term * PLANES + plane, x, value));
    }
}
