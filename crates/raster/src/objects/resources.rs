//! Resources of shaders as a draw or a dispatch finds them bound: textures, images, and blocks in buffers. Shaders
//! change images and storage in words of their own, which are written back when the command has ended.

use std::{
    cell::Ref,
    collections::BTreeMap,
    rc::Rc,
    sync::{OnceLock, atomic::AtomicU32},
};

use super::{
    buffers::Buffer,
    context::{BufferTarget, Context},
    framebuffers::Attachment,
    images::{Image, ImageAccess},
    indexed::IndexedBuffer,
    names::{Object, written},
    storage::Storage,
};
use crate::{
    error::Result,
    format::Format,
    texture::{Sampler, Texture, TextureKind, TextureView, ViewRange},
};

/// Unit and kind of a bound texture, the part that lookups see, its sampler, its texels, and the rule that it breaks.
type BoundTexture = ((u32, u8), ViewRange, Sampler, Object<Texture>, Option<String>);

/// References to all that is bound.
pub(super) struct Gathered {
    textures: Vec<BoundTexture>,
    images: BTreeMap<u32, GatheredImage>,
    /// Levels of the images, each once.
    levels: Vec<(Object<Texture>, u32)>,
    /// Ranges by target and index, with the place of their buffer.
    blocks: BTreeMap<(BufferTarget, u32), (IndexedBuffer, usize)>,
    /// Buffers of the ranges, each once.
    buffers: Vec<Object<Buffer>>,
}

/// An image, the place of its level, and the rule that it breaks.
#[derive(Debug)]
struct GatheredImage {
    place: usize,
    format: Format,
    size: [u32; 3],
    first: u32,
    access: ImageAccess,
    feedback: Option<String>,
}

/// A texture that is bound, and its sampler.
#[derive(Debug)]
pub(super) struct Bound<'a> {
    /// Unit and kind.
    pub key: (u32, u8),
    pub texture: TextureView<'a>,
    pub sampler: Sampler,
    /// The texture and the attachment that are a feedback loop.
    pub feedback: Option<String>,
}

/// Bytes, and words of them that shaders change once one of them asks.
#[derive(Debug)]
struct Cell<'a> {
    bytes: &'a [u8],
    /// Bytes of a texel, which has words of its own; 4 in buffers.
    unit: usize,
    words: OnceLock<Vec<AtomicU32>>,
}

impl<'a> Cell<'a> {
    fn new(bytes: &'a [u8], unit: usize) -> Self {
        Self { bytes, unit, words: OnceLock::new() }
    }

    fn words(&self) -> &[AtomicU32] {
        self.words.get_or_init(|| {
            let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
            let units = self.bytes.chunks(self.unit).flat_map(|unit| unit.chunks(4));
            units.map(|bytes| AtomicU32::new(word(bytes))).collect()
        })
    }

    /// The bytes of the words, if there are words.
    fn changed(self) -> Option<Vec<u8>> {
        let mut bytes = self.bytes.to_vec();
        let words = self.words.into_inner()?;
        let units = bytes.chunks_mut(self.unit).flat_map(|unit| unit.chunks_mut(4));
        for (bytes, word) in units.zip(words) {
            let length = bytes.len();
            bytes.copy_from_slice(&word.into_inner().to_le_bytes()[..length]);
        }
        Some(bytes)
    }
}

/// Resources, borrowed for the time of a command.
#[derive(Debug)]
pub(super) struct Resources<'a> {
    pub textures: Vec<Bound<'a>>,
    images: &'a BTreeMap<u32, GatheredImage>,
    levels: Vec<Cell<'a>>,
    blocks: BTreeMap<(BufferTarget, u32), (std::ops::Range<usize>, usize)>,
    buffers: Vec<Cell<'a>>,
}

impl Resources<'_> {
    /// The image of a unit, or the feedback loop that it is in.
    pub fn image(&self, unit: u32) -> Option<std::result::Result<Image<'_>, &str>> {
        let GatheredImage { place, format, size, first, access, feedback } = self.images.get(&unit)?;
        Some(match feedback {
            Some(rule) => Err(rule),
            None => Ok(Image {
                words: self.levels[*place].words(),
                format: *format,
                size: *size,
                first: *first,
                access: *access,
            }),
        })
    }

    /// Bytes that are bound to an index.
    pub fn bytes(&self, target: BufferTarget, index: u32) -> Option<&[u8]> {
        let (range, place) = self.blocks.get(&(target, index))?;
        self.buffers[*place].bytes.get(range.clone())
    }

    /// Words that are bound to an index.
    pub fn words(&self, target: BufferTarget, index: u32) -> Option<&[AtomicU32]> {
        let (range, place) = self.blocks.get(&(target, index))?;
        self.buffers[*place].words().get(range.start / 4..range.end / 4)
    }
}

/// Bytes that shaders changed, of each level and buffer.
#[derive(Default)]
pub(super) struct Changes {
    levels: Vec<Option<Vec<u8>>>,
    buffers: Vec<Option<Vec<u8>>>,
}

impl Gathered {
    /// Borrows all and runs a command; its result, and what shaders changed.
    pub fn with<R>(&self, call: &'static str, run: impl FnOnce(&Resources) -> Result<R>) -> (Result<R>, Changes) {
        let mut changes = Changes::default();
        (self.run(call, run, &mut changes), changes)
    }

    fn run<R>(
        &self,
        call: &'static str,
        run: impl FnOnce(&Resources) -> Result<R>,
        changes: &mut Changes,
    ) -> Result<R> {
        let texels: Vec<Ref<Texture>> = self.textures.iter().map(|(.., texels, _)| texels.borrow()).collect();
        let mut textures = Vec::new();
        for ((key, seen, sampler, _, feedback), texels) in self.textures.iter().zip(&texels) {
            let texture = texels.view_of(seen.clone())?;
            textures.push(Bound { key: *key, texture, sampler: *sampler, feedback: feedback.clone() });
        }
        let levels: Vec<(Ref<Texture>, u32)> =
            self.levels.iter().map(|(texels, level)| (texels.borrow(), *level)).collect();
        let stores: Vec<Ref<Buffer>> = self.buffers.iter().map(|buffer| buffer.borrow()).collect();
        let mut buffers = Vec::new();
        for store in &stores {
            buffers.push(Cell::new(store.all(call)?, 4));
        }
        let blocks = self.blocks.iter().map(|(key, (range, place))| {
            let all = buffers[*place].bytes.len();
            let start = range.offset.min(all);
            let end = range.size.map_or(all, |size| start.saturating_add(size).min(all));
            (*key, (start..end, *place))
        });
        let resources = Resources {
            textures,
            images: &self.images,
            levels: levels
                .iter()
                .map(|(texels, level)| Cell::new(texels.level(*level).unwrap_or_default(), texels.format().bytes()))
                .collect(),
            blocks: blocks.collect(),
            buffers,
        };
        let done = run(&resources);
        let Resources { levels: of_levels, buffers: of_buffers, .. } = resources;
        changes.levels = of_levels.into_iter().map(Cell::changed).collect();
        changes.buffers = of_buffers.into_iter().map(Cell::changed).collect();
        done
    }

    /// Writes what shaders changed to textures and buffers.
    pub fn write_back(&self, changes: Changes, call: &'static str) -> Result<()> {
        for ((texels, level), bytes) in self.levels.iter().zip(changes.levels) {
            if let Some(bytes) = bytes
                && let Some(level) = written(texels, call)?.level_mut(*level)
            {
                level.copy_from_slice(&bytes);
            }
        }
        for (buffer, bytes) in self.buffers.iter().zip(changes.buffers) {
            if let Some(bytes) = bytes {
                written(buffer, call)?.write(0, bytes.len(), call)?.copy_from_slice(&bytes);
            }
        }
        Ok(())
    }
}

/// The place of an item in a list, at whose end it is put if it is not there.
fn place<T>(list: &mut Vec<T>, item: T, is_same: impl Fn(&T, &T) -> bool) -> usize {
    if let Some(place) = list.iter().position(|other| is_same(other, &item)) {
        return place;
    }
    list.push(item);
    list.len() - 1
}

impl Context {
    /// References to the resources that are bound, for a draw to the framebuffer or a dispatch, which has none.
    pub(super) fn gather(&self, draws: bool) -> Gathered {
        let feedback_loop = |of: String, storage: &Storage, seen: &ViewRange| {
            if draws { self.feedback_loop(&of, storage, seen) } else { None }
        };
        let textures = self.textures.iter().filter_map(|(key, texture)| {
            let texture = texture.borrow();
            let storage = texture.storage.clone()?;
            let seen = texture.parameters.seen(&storage);
            let feedback = feedback_loop(format!("unit {}", key.0), &storage, &seen);
            // A sampler object takes the place of the texture's own.
            let sampler = self.samplers.get(&key.0).map_or(texture.parameters.sampler(), |sampler| *sampler.borrow());
            Some((*key, seen, sampler, storage.texels, feedback))
        });
        let mut gathered = Gathered {
            textures: textures.collect(),
            images: BTreeMap::new(),
            levels: Vec::new(),
            blocks: BTreeMap::new(),
            buffers: Vec::new(),
        };
        for (unit, image) in &self.images {
            let Some(storage) = image.texture.borrow().storage.clone() else { continue };
            let level = storage.range.levels.start + image.level;
            let layers = image.layer.map_or(storage.range.layers.clone(), |layer| {
                let layer = storage.range.layers.start + layer;
                if storage.range.kind == TextureKind::D3 { 0..1 } else { layer..layer + 1 }
            });
            let seen = ViewRange { levels: level..level + 1, layers, ..storage.range.clone() };
            let [width, height, depth] = storage.sides(image.level);
            let start = if storage.range.kind == TextureKind::D3 { 0 } else { storage.range.layers.start };
            let (first, depth) = image.layer.map_or((start, depth), |layer| (start + layer, 1));
            let same = |a: &(Object<Texture>, u32), b: &(Object<Texture>, u32)| Rc::ptr_eq(&a.0, &b.0) && a.1 == b.1;
            let of_image = GatheredImage {
                feedback: feedback_loop(format!("image unit {unit}"), &storage, &seen),
                place: place(&mut gathered.levels, (storage.texels, level), same),
                format: image.format,
                size: [width, height, depth],
                first,
                access: image.access,
            };
            gathered.images.insert(*unit, of_image);
        }
        for (key, range) in &self.indexed {
            let place = place(&mut gathered.buffers, Rc::clone(&range.buffer), Rc::ptr_eq);
            gathered.blocks.insert(*key, (range.clone(), place));
        }
        gathered
    }

    /// The attachment of the framebuffer that is drawn to with texels that lookups in a texture see, and both names.
    fn feedback_loop(&self, of: &str, storage: &Storage, seen: &ViewRange) -> Option<String> {
        let framebuffer = self.draw_framebuffer.as_ref()?;
        let object = framebuffer.borrow();
        let is_seen = |attachment: &Attachment| {
            let Some(image) = attachment.storage() else { return false };
            let level = image.range.levels.start + attachment.level;
            // Slices of volumes are seen together.
            let layers = match attachment.layer {
                Some(layer) if image.range.kind != TextureKind::D3 => {
                    let layer = image.range.layers.start + layer;
                    layer..layer + 1
                }
                _ => image.range.layers.clone(),
            };
            let common = layers.start.max(seen.layers.start)..layers.end.min(seen.layers.end);
            Rc::ptr_eq(&image.texels, &storage.texels) && seen.levels.contains(&level) && !common.is_empty()
        };
        let (point, attachment) = object.attachments.iter().find(|(_, attachment)| is_seen(attachment))?;
        let names = self.shared.borrow();
        let texture = names.textures.name_of(&attachment.image);
        let framebuffer = self.framebuffers.name_of(framebuffer);
        Some(format!(
            "the texels of {of} are texture {texture}, {point:?} of framebuffer {framebuffer}: a feedback loop"
        ))
    }
}
