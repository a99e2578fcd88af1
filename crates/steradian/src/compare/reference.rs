//! The reference at the size of a picture.

use std::borrow::Cow;
use steradian_image::{self as image, Image, metrics};

/// A reference that has a picture's size.
#[derive(Debug)]
pub struct Reference<'a> {
    /// Its pixels.
    pub image: Cow<'a, Image>,
    /// Width and height that it had, where it was resampled.
    pub resampled_from: Option<[usize; 2]>,
}

impl<'a> Reference<'a> {
    /// The reference of a picture, resampled by area where it has another size.
    ///
    /// # Errors
    /// Errors of [`metrics::resampled`] for another shape.
    pub fn of(picture: &Image, reference: &'a Image) -> image::Result<Self> {
        let [size, from] = [picture, reference].map(|image| [image.width(), image.height()]);
        if size == from {
            return Ok(Self { image: Cow::Borrowed(reference), resampled_from: None });
        }
        let image = Cow::Owned(metrics::resampled(reference, size[0], size[1])?);
        Ok(Self { image, resampled_from: Some(from) })
    }
}
