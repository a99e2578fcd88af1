//! Reading files, whatever format they have.

use crate::limits::{PIXELS, with_room, within};
use crate::{Error, FileKind, Image, Limits, Result, TakeBand, Texels, open_regular};
use std::io::Read;
use std::path::Path;

/// Reads an image file as linear planes: encoded samples are decoded as the kind of file says, every channel of an EXR
/// file is kept.
///
/// # Errors
/// [`Error::File`] with the path; inside, what is wrong. Damaged, oversized and unsupported files are refused, never
/// guessed at.
pub fn read(path: &Path, limits: &Limits) -> Result<Image> {
    let bytes = load(path, limits)?;
    let picture = match kind_of(&bytes, Some(path)) {
        Ok(FileKind::Exr) => crate::exr_file::decode_image(&bytes, limits),
        // The file is not held beside both its texels and the planes that are made of them.
        Ok(kind) => decode(kind, &bytes, limits).and_then(|texels| {
            drop(bytes);
            texels.to_image()
        }),
        Err(e) => Err(e),
    };
    picture.map_err(|e| e.at(path))
}

/// Reads a picture from memory; `name` helps with formats that have no signature (TGA).
///
/// # Errors
/// As [`read`], without the path.
pub fn read_bytes(bytes: &[u8], name: Option<&Path>, limits: &Limits) -> Result<Image> {
    match kind_of(bytes, name)? {
        FileKind::Exr => crate::exr_file::decode_image(bytes, limits),
        kind => decode(kind, bytes, limits)?.to_image(),
    }
}

/// Reads an image file in its own precision: colour (or grey) and alpha only.
///
/// # Errors
/// As [`read`].
pub fn read_texels(path: &Path, limits: &Limits) -> Result<Texels> {
    let bytes = load(path, limits)?;
    read_texels_bytes(&bytes, Some(path), limits).map_err(|e| e.at(path))
}

/// Reads texels from memory; `name` helps with formats that have no signature (TGA).
///
/// # Errors
/// As [`read`], without the path.
pub fn read_texels_bytes(bytes: &[u8], name: Option<&Path>, limits: &Limits) -> Result<Texels> {
    decode(kind_of(bytes, name)?, bytes, limits)
}

/// Reads texels band by band: `take` gets a band of at most `height` rows with the row it begins with, from the top,
/// and the height of the picture. A PNG file is never in memory as a whole picture; of other kinds there is one band,
/// which is the picture.
///
/// # Errors
/// As [`read_texels`]; those of `take` as [`Error::Io`].
pub fn read_bands(path: &Path, limits: &Limits, height: usize, take: TakeBand<'_, std::io::Error>) -> Result<()> {
    let bytes = load(path, limits)?;
    let mut failed = None;
    let mut whole = |rows: (usize, usize), band: &mut Texels| {
        take(rows, band).map_err(|error| {
            failed = Some(error);
            Error::Invalid("a band was not taken".into())
        })
    };
    let read = match kind_of(&bytes, Some(path)) {
        Ok(FileKind::Png) => crate::png_file::bands(&bytes, limits, height, &mut whole),
        Ok(kind) => decode(kind, &bytes, limits).and_then(|mut texels| {
            drop(bytes);
            whole((0, texels.height), &mut texels)
        }),
        Err(e) => Err(e),
    };
    match failed {
        Some(error) => Err(Error::Io { action: "keep", error }.at(path)),
        None => read.map_err(|e| e.at(path)),
    }
}

/// Bytes that [`read_texels`] takes for a file, about, by what its beginning declares; `None` where that tells nothing.
pub fn declared_bytes(path: &Path) -> Option<u64> {
    /// Longer than the header of any sensible file.
    const BEGINNING: u64 = 1 << 18;
    let mut bytes = Vec::new();
    let (file, length) = open_regular(path).ok()?;
    file.take(BEGINNING).read_to_end(&mut bytes).ok()?;
    let kind = kind_of(&bytes, Some(path)).ok()?;
    let pixel = match kind {
        // Depth and kind of colour, of the header.
        FileKind::Png => {
            let channels = match bytes.get(25)? {
                0 => 1,
                4 => 2,
                6 => 4,
                _ => 3,
            };
            channels * if *bytes.get(24)? == 16 { 2 } else { 1 }
        }
        FileKind::Jpeg | FileKind::Pnm => 3,
        FileKind::Exr => 6,
        FileKind::Hdr | FileKind::Pfm => 12,
        FileKind::Tga | FileKind::Bmp | FileKind::Dds | FileKind::Ktx2 | FileKind::WebP => 4,
    };
    // Decoders hold what is declared against the limits before they do anything else.
    match decode(kind, &bytes, &Limits { pixels: 0, ..Limits::default() }) {
        Err(Error::Limit { what: PIXELS, declared, .. }) => Some(declared.saturating_mul(pixel)),
        _ => Some(length),
    }
}

/// The kind that a file's content tells, or else its name.
fn kind_of(bytes: &[u8], path: Option<&Path>) -> Result<FileKind> {
    FileKind::from_content(bytes).or_else(|| FileKind::from_extension(path?)).ok_or(Error::UnknownFormat)
}

fn decode(kind: FileKind, bytes: &[u8], limits: &Limits) -> Result<Texels> {
    match kind {
        FileKind::Exr => crate::exr_file::decode_texels(bytes, limits),
        FileKind::Png => crate::png_file::decode(bytes, limits),
        FileKind::Jpeg | FileKind::Tga | FileKind::Bmp => crate::photo::decode(kind, bytes, limits),
        FileKind::Hdr => crate::hdr::decode(bytes, limits),
        FileKind::Pfm => crate::pfm::decode(bytes, limits),
        FileKind::Pnm => crate::pnm::decode(bytes, limits),
        FileKind::Dds => crate::dds::decode(bytes, limits),
        FileKind::Ktx2 => crate::ktx2::decode(bytes, limits),
        FileKind::WebP => crate::webp::decode(bytes, limits),
    }
}

/// The whole file, when it is not above the limit.
pub(crate) fn load(path: &Path, limits: &Limits) -> Result<Vec<u8>> {
    let io = |action| move |error| Error::Io { action, error }.at(path);
    let (file, size) = open_regular(path).map_err(io("open"))?;
    within("the file's size in bytes", size, limits.bytes).map_err(|e| e.at(path))?;
    let mut bytes = with_room(size as usize).map_err(|e| e.at(path))?;
    // A device or a file that grows does not end where its metadata say.
    file.take(limits.bytes + 1).read_to_end(&mut bytes).map_err(io("read"))?;
    within("the file's size in bytes", bytes.len() as u64, limits.bytes).map_err(|e| e.at(path))?;
    Ok(bytes)
}
