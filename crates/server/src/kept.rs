//! The reference that there is, for all requests.

use crate::turn::Turn;
use serde::Serialize;
use std::sync::{Arc, Mutex, PoisonError};
use steradian::image::Image;

/// The reference, if there is one.
#[derive(Default)]
pub struct Keeper {
    kept: Mutex<Option<Arc<Reference>>>,
    /// One file is decoded, or one map made, at a time.
    turn: Turn,
}

/// A picture to hold others against.
pub struct Reference {
    /// Description for pages.
    pub about: AboutReference,
    /// The picture.
    pub image: Image,
}

/// Description of a reference for pages.
#[derive(Clone, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct AboutReference {
    /// Name.
    pub name: String,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// The part of the full picture that it shows, x0, y0, x1, y1; `None` of files.
    pub crop: Option<[u32; 4]>,
}

impl Reference {
    /// Reference from a picture that tiles can hold, with colours.
    ///
    /// # Errors
    /// Where it is none of these.
    pub fn new(name: String, crop: Option<[u32; 4]>, image: Image) -> Result<Self, String> {
        image.require_rgb().map_err(|e| e.to_string())?;
        let side =
            |n: usize| u16::try_from(n).map_err(|_| format!("{n} pixels are too many along an edge: {}", u16::MAX));
        let [width, height] = [side(image.width())?, side(image.height())?].map(u32::from);
        Ok(Self { about: AboutReference { name, width, height, crop }, image })
    }
}

impl Keeper {
    /// The one there is.
    pub fn get(&self) -> Option<Arc<Reference>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Takes another one, or none.
    pub fn set(&self, reference: Option<Reference>) {
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = reference.map(Arc::new);
    }

    /// Works beside the server, one at a time.
    ///
    /// # Errors
    /// A worker thread that ended early.
    pub async fn work<T: Send + 'static>(&self, work: impl FnOnce() -> T + Send + 'static) -> std::io::Result<T> {
        self.turn.work(work).await
    }
}
