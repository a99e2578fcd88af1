//! Two pictures over each other, with a border that the user moves.

use super::img;
use crate::brightness;
use steradian::image::{self, Image, WriteOptions};

/// Style of pages with sliders and maps.
pub const STYLE: &str = include_str!("slider.css");
/// Script that moves the borders, for the end of the page.
pub const SCRIPT: &str = include_str!("slider.js");

/// A figure of a picture and its reference, of one size, at one exposure, which the reference asks for. Names are
/// escaped already.
///
/// # Errors
/// A picture that cannot be encoded.
pub fn slider([name, other]: [&str; 2], [picture, reference]: [&Image; 2]) -> image::Result<String> {
    let stops = brightness::needed(reference).map_or(0.0, |(_, stops)| stops);
    let mut options = WriteOptions::default();
    options.tone = options.tone.with_exposure(stops)?;
    let shown = |image: &Image, alt: &str| {
        let colours = Image::from_rgb(image.width(), image.height(), &image.to_rgb()?)?;
        img(&colours, &options, alt)
    };
    Ok(format!(
        "<figure class=\"slider\"><div class=\"ab\">{}{}</div>\
         <input type=\"range\" min=\"0\" max=\"100\" step=\"0.5\" value=\"50\" \
         aria-label=\"Border between {name} (left) and its reference {other} (right)\">\
         <figcaption><b>Left</b>: {name}; <b>right</b>: {other}; exposure {stops:+} stops</figcaption></figure>\n",
        shown(picture, &format!("Picture {name}"))?,
        shown(reference, &format!("Reference {other}"))?,
    ))
}
