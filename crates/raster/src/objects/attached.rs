//! Images of framebuffers for draws. Targets of the pipeline lie in tiles, textures in rows: each draw copies what is
//! attached from one to the other and back.

use glam::Vec4;

use super::{
    context::Context,
    framebuffers::{Attachment, AttachmentPoint, FramebufferObject, FramebufferStatus},
    names,
    storage::Storage,
};
use crate::{
    error::{Result, refuse},
    format::{Format, Numeric},
    output::Class,
    render_target::{ColorTarget, DepthFormat, DepthTarget, Extent, Framebuffer, StencilTarget},
};

/// A framebuffer with the contents of the attached images: as wide, as high and with as many layers as all of them are.
/// Colours are those of the draw buffers, by location.
pub(super) fn load(object: &FramebufferObject, call: &'static str) -> Result<Framebuffer> {
    check_complete(object, call)?;
    let extent = extent(object);
    let mut colors = Vec::new();
    // Outputs without a buffer go to a target that is dropped, of a class that fits.
    let locations = || object.draw_buffers.iter().map(|number| object.color((*number)?));
    let format = |attachment: &Attachment| attachment.storage().map(|storage| storage.format());
    let class = locations().flatten().find_map(format).map(Format::class);
    let dropped = match class {
        Some(Class::Uint) => Format::Rgba32Uint,
        Some(Class::Sint) => Format::Rgba32Sint,
        _ => Format::Rgba8Unorm,
    };
    for attachment in locations() {
        let format = attachment.and_then(format).unwrap_or(dropped);
        let mut target = ColorTarget::new(extent, format).or_else(|error| incomplete(call, error.rule))?;
        if let Some(attachment) = attachment {
            each_row(attachment, extent, |storage, (at, y, layer)| {
                target.load(
                    y,
                    layer,
                    storage.bytes(&storage.texels.borrow(), attachment.level, at, extent.width as usize),
                );
            });
        }
        colors.push(target);
    }
    let mut depth = None;
    if let Some((attachment, storage)) = part(object, AttachmentPoint::Depth) {
        let mut target =
            DepthTarget::new(extent, depth_format(storage.format())).or_else(|error| incomplete(call, error.rule))?;
        target.load(|at, layer, sample| texel(attachment, &storage, (at, layer, sample)).x);
        depth = Some(target);
    }
    let mut stencil = None;
    if let Some((attachment, storage)) = part(object, AttachmentPoint::Stencil) {
        let mut target = StencilTarget::new(extent).or_else(|error| incomplete(call, error.rule))?;
        let channel = stencil_channel(storage.format());
        target.load(|at, layer, sample| texel(attachment, &storage, (at, layer, sample))[channel].to_bits() as u8);
        stencil = Some(target);
    }
    if colors.is_empty() && depth.is_none() && stencil.is_none() {
        colors.push(ColorTarget::new(extent, dropped).or_else(|error| incomplete(call, error.rule))?);
    }
    Framebuffer::new(colors, depth, stencil).or_else(|error| incomplete(call, error.rule))
}

fn check_complete(object: &FramebufferObject, call: &'static str) -> Result<()> {
    match object.status() {
        FramebufferStatus::Complete => Ok(()),
        status => incomplete(call, format_args!("the framebuffer is not complete: {status:?}")),
    }
}

/// Targets that are read: the colour of the read buffer, depths and stencil values.
pub(super) type ReadParts = (Option<ColorTarget>, Option<DepthTarget>, Option<StencilTarget>);

impl Context {
    /// Targets of the framebuffer that is read from.
    pub(super) fn read_parts(&self, call: &'static str) -> Result<ReadParts> {
        let (framebuffer, has_color) = match &self.read_framebuffer {
            None => (self.default.clone(), true),
            Some(object) => {
                let object = object.borrow();
                check_complete(&object, call)?;
                // Of the colours only that of the read buffer.
                let number = object.read_buffer;
                let read = FramebufferObject { draw_buffers: vec![number], ..object.copied() };
                (load(&read, call)?, number.is_some())
            }
        };
        let (colors, depth, stencil) = framebuffer.into_parts();
        Ok((colors.into_iter().next().filter(|_| has_color), depth, stencil))
    }
}

/// Copies the targets back to the attached images.
pub(super) fn store(object: &FramebufferObject, framebuffer: Framebuffer, call: &'static str) -> Result<()> {
    let extent = framebuffer.extent();
    let (colors, depth, stencil) = framebuffer.into_parts();
    for (number, target) in object.draw_buffers.iter().zip(colors) {
        let Some(attachment) = number.and_then(|number| object.color(number)) else { continue };
        let Some(storage) = attachment.storage() else { continue };
        let mut texels = names::written(&storage.texels, call)?;
        each_row(attachment, extent, |storage, (at, y, layer)| {
            let row = storage.bytes_mut(&mut texels, attachment.level, at, extent.width as usize);
            target.store(y, layer, row);
        });
    }
    // Depth and stencil are parts of one texel.
    if let Some(depth) = depth {
        store_part(object, extent, (AttachmentPoint::Depth, call), |value, _, (at, layer, sample)| {
            value.x = depth.sample(at, layer, sample).unwrap_or(value.x);
        })?;
    }
    if let Some(stencil) = stencil {
        store_part(object, extent, (AttachmentPoint::Stencil, call), |value, format, (at, layer, sample)| {
            let stored = stencil.sample(at, layer, sample).unwrap_or(0);
            value[stencil_channel(format)] = f32::from_bits(u32::from(stored));
        })?;
    }
    Ok(())
}

/// Pixel, layer and sample.
type Place = ([u32; 2], u32, u32);

/// Changes the values of the image at a point.
fn store_part(
    object: &FramebufferObject,
    extent: Extent,
    (point, call): (AttachmentPoint, &'static str),
    change: impl Fn(&mut Vec4, Format, Place),
) -> Result<()> {
    let Some((attachment, storage)) = part(object, point) else { return Ok(()) };
    let (format, samples) = (storage.format(), storage.samples);
    let mut texels = names::written(&storage.texels, call)?;
    each_row(attachment, extent, |storage, (at, y, layer)| {
        let row = storage.bytes_mut(&mut texels, attachment.level, at, extent.width as usize);
        for (place, bytes) in (0..).zip(row.chunks_exact_mut(format.bytes())) {
            let mut value = format.read(bytes);
            change(&mut value, format, ([place / samples, y], layer, place % samples));
            format.write(value, bytes);
        }
    });
    Ok(())
}

/// The least width, height and number of layers of all attachments.
fn extent(object: &FramebufferObject) -> Extent {
    let mut least = Extent { width: u32::MAX, height: u32::MAX, layers: u32::MAX, samples: 1 };
    for attachment in object.attachments.values() {
        let Some(storage) = attachment.storage() else { continue };
        let [width, height, depth] = storage.sides(attachment.level);
        let layers = if attachment.layer.is_some() { 1 } else { depth };
        least.width = least.width.min(width);
        least.height = least.height.min(height);
        least.layers = least.layers.min(layers);
        least.samples = storage.samples;
    }
    least
}

/// The image at a point.
fn part(object: &FramebufferObject, point: AttachmentPoint) -> Option<(&Attachment, Storage)> {
    let attachment = object.attachments.get(&point)?;
    Some((attachment, attachment.storage()?))
}

/// Runs through the rows of an attachment: first texel of the image, row and layer of the framebuffer.
fn each_row(attachment: &Attachment, extent: Extent, mut run: impl FnMut(&Storage, ([u32; 3], u32, u32))) {
    let Some(storage) = attachment.storage() else { return };
    let first = attachment.layer.unwrap_or(0);
    for (layer, y) in (0..extent.layers).flat_map(|layer| (0..extent.height).map(move |y| (layer, y))) {
        run(&storage, ([0, y, first + layer], y, layer));
    }
}

/// The value of a sample of an attachment.
fn texel(attachment: &Attachment, storage: &Storage, ([x, y], layer, sample): Place) -> Vec4 {
    let texels = storage.texels.borrow();
    let at = [x, y, attachment.layer.unwrap_or(0) + layer];
    let bytes = storage.bytes(&texels, attachment.level, at, 1);
    bytes.get(sample as usize * storage.format().bytes()..).map_or(Vec4::ZERO, |bytes| storage.format().read(bytes))
}

const fn depth_format(format: Format) -> DepthFormat {
    match format {
        Format::Depth16 => DepthFormat::Unorm16,
        Format::Depth24 | Format::Depth24Stencil8 => DepthFormat::Unorm24,
        _ => DepthFormat::Float32,
    }
}

/// Channel of the stencil values of a format.
fn stencil_channel(format: Format) -> usize {
    usize::from(format.numeric() == Numeric::DepthStencil)
}

pub(super) fn incomplete<T>(call: &'static str, rule: impl std::fmt::Display) -> Result<T> {
    refuse(call, format!("{rule} (INVALID_FRAMEBUFFER_OPERATION)"))
}
