//! View of the scene: camera, part of the picture, layers, settings.

use crate::{
    frame,
    protocol::{COLORS, Denoiser, SettingsChange},
};
use steradian::{
    ColorMode, CompileOptions, Layer, Quality, Render, Scene, Viewpoint,
    scene::{Format, NodeId, SceneDesc, Value},
    suited_mode,
};

/// Pixels of the largest picture that is shown.
pub const MOST_PIXELS: u64 = 1 << 24;
/// Longest edge of a picture: tiles count with 16 bits.
const LONGEST_EDGE: u32 = 1 << 15;

/// Purpose of a compiled scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be rendered.
    Render,
    /// For pictures at once.
    Preview,
}

/// View of the scene.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// The camera that was chosen.
    pub camera: Option<String>,
    /// Viewpoint of a camera that was moved.
    pub view: Option<View>,
    /// The part that is rendered.
    pub region: Option<[u32; 4]>,
    /// Layers that are sent along.
    pub layers: Vec<Layer>,
    /// Settings that were chosen.
    pub settings: SettingsChange,
    /// Denoiser where none was chosen, nor its absence.
    pub usual: Option<Denoiser>,
    /// Pauses the render.
    pub paused: bool,
    /// True while a hand is on the camera.
    pub moving: bool,
    /// Tone curve to begin with.
    pub tone: Option<String>,
    /// Exposure to begin with.
    pub exposure: Option<StartExposure>,
}

/// Exposure that was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StartExposure {
    /// By the picture.
    Auto,
    /// In stops.
    Stops(f32),
}

impl Look {
    /// Denoiser of its pictures.
    pub fn denoiser(&self) -> Option<Denoiser> {
        self.settings.denoise.unwrap_or(self.usual)
    }

    /// Takes the `best` denoiser there is as the usual one, where noise can be removed from pictures of the scene.
    pub fn choose_denoiser(&mut self, scene: &Scene, best: Denoiser) {
        let has_groups = self.settings.light_groups == Some(true);
        self.usual = (!has_groups && can_be_denoised(self, scene).is_ok()).then_some(best);
    }
}

/// Tests if noise can be removed from pictures of the scene.
///
/// # Errors
/// Why not.
pub fn can_be_denoised(look: &Look, scene: &Scene) -> Result<(), String> {
    let look =
        Look { usual: None, settings: SettingsChange { denoise: None, ..look.settings.clone() }, ..look.clone() };
    let render = quality(&look).render(scene).map_err(|e| e.to_string())?;
    match render.not_denoisable(scene) {
        Some(why) => Err(format!("noise cannot be removed here: {why}")),
        None => Ok(()),
    }
}

/// Viewpoint of a moved camera, and its field of view if that was changed, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The place.
    pub point: Viewpoint,
    /// The field of view.
    pub fov: Option<f64>,
}

impl View {
    /// Puts a camera there.
    pub fn place(&self, desc: &mut SceneDesc, camera: NodeId) {
        self.point.place(desc, camera);
        if let Some(fov) = self.fov {
            desc.node_mut(camera).set("fov", Value::Float(fov), None);
        }
    }
}

/// Options of compiling the scene.
pub fn options(look: &Look, format: Format, purpose: Purpose) -> CompileOptions {
    let settings = &look.settings;
    let suited = settings.integrator.as_deref().and_then(suited_mode);
    let mode = match settings.color.as_deref() {
        Some("rgb") => Some(ColorMode::Rgb),
        Some("spectral") => Some(ColorMode::Spectral),
        // Previews are drawn by the pipeline.
        _ if suited.is_some() || purpose == Purpose::Preview => suited.or(Some(ColorMode::Rgb)),
        _ if format == Format::Pbrt => Some(ColorMode::Spectral),
        _ => Some(ColorMode::Rgb),
    };
    CompileOptions {
        mode,
        size: settings.width.zip(settings.height),
        crop: look.region,
        camera: look.camera.clone(),
        spp: settings.spp.flatten(),
        ..CompileOptions::default()
    }
}

/// Quality that is asked of the session.
pub fn quality(look: &Look) -> Quality {
    let s = &look.settings;
    let groups = s.light_groups.filter(|on| *on).map(|_| Layer::LIGHT_GROUPS);
    let denoiser = look.denoiser();
    // What the inspector tells.
    let mut layers: Vec<Layer> = frame::LAYERS.into_iter().chain(groups).collect();
    layers.extend(denoiser.into_iter().flat_map(Denoiser::guides).filter(|guide| !frame::LAYERS.contains(guide)));
    Quality {
        integrator: s.integrator.clone(),
        spp: s.spp.flatten(),
        seed: s.seed.flatten(),
        max_depth: s.max_depth.flatten(),
        sampler: s.sampler.clone().flatten(),
        layers,
        independent: denoiser.is_some(),
        ..Quality::default()
    }
}

/// Bytes that the view takes for a picture: what a render takes for its film, the sums of the picture that is shown
/// beside those of the one that comes, and planes for pages.
pub fn bytes(render: &Render, scene: &Scene, look: &Look) -> u64 {
    let crop = scene.film().crop;
    let pixels = u64::from(crop.width()) * u64::from(crop.height());
    let parts = render.film_bytes(scene, quality(look).layers.len());
    // A pixel's sums with first hits, its preview, an early state, and planes of colours as floats and as halves.
    parts.saturating_add(parts / 4).saturating_add(pixels * 76)
}

/// Refuses a picture for which there is no memory. `held` are the bytes of the picture before, which goes.
///
/// # Errors
/// How much it needs.
pub fn check_memory(needed: u64, held: u64, there_is: Option<u64>) -> Result<(), String> {
    match there_is.map(|bytes| bytes.saturating_add(held)) {
        Some(bytes) if needed > bytes => {
            let gigabytes = |bytes: u64| bytes as f64 / f64::from(1 << 30);
            Err(format!(
                "a view of this picture needs about {:.1} GiB of memory, and {:.1} are there; a smaller size or a \
                 region helps",
                gigabytes(needed),
                gigabytes(bytes)
            ))
        }
        _ => Ok(()),
    }
}

/// Refuses pictures without pixels, with too many, or too long for tiles.
///
/// # Errors
/// What can be shown.
pub fn check_size(width: u32, height: u32) -> Result<(), String> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || width.max(height) > LONGEST_EDGE || pixels > MOST_PIXELS {
        return Err(format!(
            "pictures of {width} x {height} pixels are not shown: at least 1, at most {MOST_PIXELS} in all and \
             {LONGEST_EDGE} along an edge"
        ));
    }
    Ok(())
}

/// Takes over what is given.
///
/// # Errors
/// What is wrong; nothing is taken over then.
pub fn set(settings: &mut SettingsChange, change: SettingsChange) -> Result<(), String> {
    let SettingsChange { integrator, spp, sampler, color, seed, max_depth, denoise, light_groups, width, height } =
        change;
    if let Some(color) = &color
        && !COLORS.contains(&color.as_str())
    {
        return Err(format!("there is no colour mode '{color}'; known are {}", COLORS.join(", ")));
    }
    let size = [width.or(settings.width), height.or(settings.height)];
    if let [Some(w), Some(h)] = size {
        check_size(w, h)?;
    }
    if width.is_some() != height.is_some() {
        return Err("'width' and 'height' are set together".into());
    }
    fn replace<T>(old: &mut Option<T>, new: Option<T>) {
        if new.is_some() {
            *old = new;
        }
    }
    replace(&mut settings.integrator, integrator);
    replace(&mut settings.spp, spp);
    replace(&mut settings.sampler, sampler);
    replace(&mut settings.color, color);
    replace(&mut settings.seed, seed);
    replace(&mut settings.max_depth, max_depth);
    replace(&mut settings.denoise, denoise);
    replace(&mut settings.light_groups, light_groups);
    (settings.width, settings.height) = (size[0], size[1]);
    Ok(())
}
