//! Planes of a picture that is being made.

use steradian_image::Image;

/// Layers have distinct names and the length of the picture, so this adds them.
pub(crate) fn push(image: &mut Image, name: &str, data: Vec<f32>) {
    let added = image.push(name, data);
    debug_assert!(added.is_ok(), "{name}: {added:?}");
}
