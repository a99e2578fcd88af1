//! Values for each pixel.

use rayon::prelude::*;

use crate::error::{Error, Result};

/// A value for each pixel, row by row from the top, each row from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<T> {
    width: u32,
    height: u32,
    values: Vec<T>,
}

impl<T> Image<T> {
    /// Image of values in rows.
    ///
    /// # Errors
    /// Where their number is not `width` times `height`.
    pub fn new(width: u32, height: u32, values: Vec<T>) -> Result<Self> {
        if u64::from(width) * u64::from(height) == values.len() as u64 {
            Ok(Self { width, height, values })
        } else {
            Err(Error::Values { found: values.len(), size: [width, height] })
        }
    }

    /// Image of one value.
    pub fn filled(width: u32, height: u32, value: T) -> Self
    where
        T: Clone,
    {
        Self { width, height, values: vec![value; width as usize * height as usize] }
    }

    /// Image of a function's values at column and row of each pixel, in order.
    pub fn from_fn(width: u32, height: u32, mut value: impl FnMut(u32, u32) -> T) -> Self {
        let values = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect();
        Self { width, height, values }
    }

    /// As [`Image::from_fn`], rows in parallel.
    pub(crate) fn by_rows(width: u32, height: u32, value: impl Fn(u32, u32) -> T + Sync) -> Self
    where
        T: Copy + Default + Send,
    {
        let mut image = Self::filled(width, height, T::default());
        image.values.par_chunks_mut(width.max(1) as usize).zip(0..height).for_each(|(row, y)| {
            row.iter_mut().zip(0..width).for_each(|(place, x)| *place = value(x, y));
        });
        image
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// All values, row by row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// All values, row by row, to be changed.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The value of a pixel, if there is one.
    #[inline]
    pub fn get(&self, x: u32, y: u32) -> Option<&T> {
        if x < self.width { self.values.get(y as usize * self.width as usize + x as usize) } else { None }
    }
}

impl<T: Copy> Image<T> {
    /// The value of a pixel that is there.
    #[inline]
    pub(crate) fn at(&self, x: u32, y: u32) -> T {
        self.values[y as usize * self.width as usize + x as usize]
    }
}
