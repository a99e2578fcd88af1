//! A picture that is shown, as pages get it.

use crate::{
    groups,
    protocol::{FrameEnd, FrameKind, ServerMessage},
    tile::{self, Plane},
};
use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};
use steradian::{
    Film, Layer, Scene, develop,
    film::{Crop, LayerInputs, Pixel},
    image::Image,
};

/// Layers that are there of every picture.
pub const LAYERS: [Layer; 9] = [
    Layer::ALBEDO,
    Layer::NORMAL,
    Layer::GEOMETRIC_NORMAL,
    Layer::POSITION,
    Layer::DEPTH,
    Layer::UV,
    Layer::IDS,
    Layer::VARIANCE,
    Layer::SAMPLES,
];

/// A picture with what is known of it.
pub struct Shown {
    /// Generation of the view's state.
    pub generation: u32,
    /// The part of the full picture that it shows, in that one's pixels.
    pub crop: [u32; 4],
    /// Origin of the picture.
    pub kind: FrameKind,
    /// Rendered scene.
    pub scene: Arc<Scene>,
    /// The sums.
    pub film: Film,
    /// Samples per pixel, in the mean.
    pub samples: f64,
    /// Samples per pixel of the finished render.
    pub target: u32,
    /// Relative error.
    pub error: Option<f64>,
    /// Time of rendering.
    pub seconds: f64,
    /// True if no samples are to come.
    pub is_done: bool,
    /// Samples that count as black.
    pub nonfinite: u64,
    /// Without its noise, where that was removed.
    pub denoised: Option<Image>,
}

impl Shown {
    /// The picture, with layers; without noise where that was removed.
    pub fn picture(&self, layers: &[Layer]) -> Image {
        let plain = self.plain(layers);
        let Some(denoised) = &self.denoised else { return plain };
        let mut picture = denoised.clone();
        for channel in plain.into_channels() {
            if picture.channel(&channel.name).is_none() {
                // It has as many pixels.
                let _ = picture.push(channel.name, channel.data);
            }
        }
        picture
    }

    /// The picture as it was rendered.
    fn plain(&self, layers: &[Layer]) -> Image {
        let layers: Vec<Layer> = layers.iter().copied().filter(|l| self.has(*l)).collect();
        develop(&self.scene, &self.film, &layers)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.film.crop.width() as usize, self.film.crop.height() as usize]
    }

    fn has(&self, layer: Layer) -> bool {
        !layer.inputs().has(LayerInputs::FIRST_HITS) || !self.film.layers.features.is_empty()
    }

    /// Column, row and number of the pixel at a place in the full picture; `None` where it has none.
    pub fn place(&self, x: u32, y: u32) -> Option<[u32; 3]> {
        let [x0, y0, x1, y1] = self.crop;
        if !(x0..x1).contains(&x) || !(y0..y1).contains(&y) {
            return None;
        }
        // A preview is smaller than what it shows.
        let film = &self.film;
        let at = |v: u32, [from, to]: [u32; 2], count: u32| {
            (u64::from(v - from) * u64::from(count) / u64::from(to - from)) as u32
        };
        let (w, h) = (film.crop.width(), film.crop.height());
        let (i, j) = (at(x, [x0, x1], w), at(y, [y0, y1], h));
        Some([i, j, j * w + i])
    }

    /// A single pixel of it, at a place in the full picture; `None` where it has none.
    pub fn pixel(&self, x: u32, y: u32) -> Option<Film> {
        let ([i, j, k], film) = (self.place(x, y)?, &self.film);
        let k = k as usize;
        let pixels: Vec<Pixel> = film.pixels.get(k..k + 1)?.to_vec();
        let (cx, cy) = (film.crop.x0 + i, film.crop.y0 + j);
        let crop = Crop { x0: cx, y0: cy, x1: cx + 1, y1: cy + 1 };
        Some(Film { crop, pixels, layers: film.layers.pixel(k), halves: Vec::new(), bins: 0, bands: None })
    }
}

/// The layer of a name, if pages can show it.
///
/// # Errors
/// Which there are.
pub fn layer(name: &str) -> Result<Layer, String> {
    LAYERS.into_iter().find(|l| l.name() == name).ok_or_else(|| {
        let known = LAYERS.map(Layer::name).join(", ");
        format!("there is no layer '{name}' here; known are {known}")
    })
}

/// A picture as messages, encoded once for all pages.
#[derive(Clone, Default)]
pub struct Frame {
    /// Number of the picture: pages that have its tiles are told its end alone.
    pub number: u64,
    /// Binary tiles.
    pub tiles: Vec<axum::body::Bytes>,
    end: Option<FrameEnd>,
}

impl Frame {
    /// Encodes a picture and layers.
    pub fn new(shown: &Shown, layers: &[Layer]) -> Self {
        let image = shown.picture(layers);
        let size = [image.width() as u32, image.height() as u32];
        let mut tiles = Vec::new();
        for (number, layer) in std::iter::once(None).chain(layers.iter().map(|l| Some(*l))).enumerate() {
            let Some((components, values)) = plane(&image, layer) else { continue };
            let plane = Plane { layer: number as u16, components, size, values: &values };
            tiles.extend(tile::tiles(shown.generation, &plane).into_iter().map(Into::into));
        }
        let names = groups::names(&shown.scene, &shown.film);
        for group in 0..names.len() {
            let values = groups::plane(&shown.film, group, names.len());
            let plane = Plane { layer: groups::FIRST_PLANE + group as u16, components: 3, size, values: &values };
            tiles.extend(tile::tiles(shown.generation, &plane).into_iter().map(Into::into));
        }
        static NUMBER: AtomicU64 = AtomicU64::new(1);
        let end = FrameEnd {
            generation: shown.generation,
            width: size[0],
            height: size[1],
            origin: [shown.crop[0], shown.crop[1]],
            kind: shown.kind,
            samples: shown.samples,
            target: shown.target,
            error: shown.error.filter(|e| e.is_finite()),
            seconds: shown.seconds,
            done: shown.is_done,
            denoised: shown.denoised.is_some(),
            nonfinite: shown.nonfinite,
            light_groups: names.to_vec(),
            crop: shown.crop,
        };
        Self { number: NUMBER.fetch_add(1, Ordering::Relaxed), tiles, end: Some(end) }
    }

    /// This picture with the progress of the render that will replace it.
    pub fn while_rendered(&self, render: &Shown) -> Self {
        let end = self.end.clone().map(|end| FrameEnd {
            samples: render.samples,
            target: render.target,
            seconds: render.seconds,
            nonfinite: render.nonfinite,
            ..end
        });
        Self { end, ..self.clone() }
    }

    /// The message that ends it; `None` before the first one.
    pub fn text(&self) -> Option<String> {
        self.end.clone().map(|end| ServerMessage::Frame(end).text())
    }
}

/// R, G, B of a picture, pixel by pixel.
pub fn rgb(image: &Image) -> Vec<f32> {
    plane(image, None).unwrap_or_default().1
}

/// The channels of the picture or of a layer, pixel by pixel, one or three of them.
fn plane(image: &Image, layer: Option<Layer>) -> Option<(u16, Vec<f32>)> {
    let names: &[&str] = match layer {
        None => &["R", "G", "B"],
        // Pages show one number or three.
        Some(l) if l == Layer::UV => &["uv.U", "uv.V", ""],
        Some(l) if l == Layer::DEPTH || l == Layer::IDS => &l.channels()[..1],
        Some(layer) if LAYERS.contains(&layer) => layer.channels(),
        Some(_) => return None,
    };
    let zeros = vec![0.0; if names.contains(&"") { image.pixel_count() } else { 0 }];
    let channel = |name: &&str| if name.is_empty() { Some(zeros.as_slice()) } else { image.channel(name) };
    let found = names.iter().map(channel).collect::<Option<Vec<&[f32]>>>()?;
    let values = (0..image.pixel_count()).flat_map(|k| found.iter().map(move |plane| plane[k])).collect();
    Some((found.len() as u16, values))
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A picture of pixels, of a scene without a part in it.
    pub fn shown(kind: FrameKind, [x1, y1]: [u32; 2], pixels: Vec<Pixel>) -> Shown {
        let desc = steradian::load("builtin:cornell-box", &Default::default()).desc;
        let scene = steradian::compile(&desc, &Default::default()).scene.unwrap();
        let film = Film {
            crop: Crop { x0: 0, y0: 0, x1, y1 },
            pixels,
            layers: Default::default(),
            halves: Vec::new(),
            bins: 0,
            bands: None,
        };
        Shown {
            generation: 1,
            crop: [0, 0, x1, y1],
            kind,
            scene: Arc::new(scene),
            film,
            samples: 1.0,
            target: 1,
            error: None,
            seconds: 1.0,
            is_done: false,
            nonfinite: 0,
            denoised: None,
        }
    }
}
