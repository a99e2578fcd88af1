//! Which format a file has, and reading it.

use crate::limits::{PIXELS, with_room, within};
use crate::{Error, Image, Limits, Result, TakeBand, Texels, open_regular};
use std::io::Read;
use std::path::Path;

/// An image file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FileKind {
    /// OpenEXR.
    Exr,
    /// Portable Network Graphics.
    Png,
    /// JPEG.
    Jpeg,
    /// Truevision TGA.
    Tga,
    /// Windows bitmap.
    Bmp,
    /// Radiance RGBE.
    Hdr,
    /// Portable float map.
    Pfm,
    /// Portable pixmap and greymap.
    Pnm,
    /// DirectDraw Surface.
    Dds,
    /// Khronos Texture 2.0.
    Ktx2,
    /// WebP.
    WebP,
}

impl std::fmt::Display for FileKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Exr => "EXR",
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Tga => "TGA",
            Self::Bmp => "BMP",
            Self::Hdr => "Radiance HDR",
            Self::Pfm => "PFM",
            Self::Pnm => "PPM/PGM",
            Self::Dds => "DDS",
            Self::Ktx2 => "KTX2",
            Self::WebP => "WebP",
        })
    }
}

impl FileKind {
    /// True if the format holds display values, to which a tone curve leads, and not radiance.
    pub fn is_display(self) -> bool {
        matches!(self, Self::Png | Self::Jpeg | Self::Pnm | Self::Dds | Self::Ktx2 | Self::WebP | Self::Tga | Self::Bmp)
    }

    /// The kind that the first bytes tell. TGA has no signature and is never found this way, unless by its footer.
    pub fn from_content(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0x76, 0x2f, 0x31, 0x01, ..] => Some(Self::Exr),
            [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', ..] => Some(Self::Png),
            [0xff, 0xd8, 0xff, ..] => Some(Self::Jpeg),
            [b'B', b'M', ..] if bytes.len() >= 26 && bytes[6..10] == [0; 4] => Some(Self::Bmp),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::WebP),
            [b'#', b'?', ..] => Some(Self::Hdr),
            [b'D', b'D', b'S', b' ', 124, 0, 0, 0, ..] => Some(Self::Dds),
            _ if bytes.starts_with(&crate::ktx2::MAGIC) => Some(Self::Ktx2),
            [b'P', b'F' | b'f', s, ..] if s.is_ascii_whitespace() => Some(Self::Pfm),
            [b'P', b'1'..=b'7', s, ..] if s.is_ascii_whitespace() || *s == b'#' => Some(Self::Pnm),
            _ if bytes.ends_with(b"TRUEVISION-XFILE.\0") => Some(Self::Tga),
            _ => None,
        }
    }

    /// The kind that a file name's extension tells.
    pub fn from_extension(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "exr" => Some(Self::Exr),
            "png" => Some(Self::Png),
            "jpg" | "jpeg" => Some(Self::Jpeg),
            "tga" => Some(Self::Tga),
            "bmp" => Some(Self::Bmp),
            "hdr" | "pic" | "rgbe" => Some(Self::Hdr),
            "pfm" => Some(Self::Pfm),
            "ppm" | "pgm" | "pnm" => Some(Self::Pnm),
            "dds" => Some(Self::Dds),
            "ktx2" => Some(Self::Ktx2),
            "webp" => Some(Self::WebP),
            _ => None,
        }
    }

    fn of(bytes: &[u8], path: Option<&Path>) -> Result<Self> {
        Self::from_content(bytes).or_else(|| Self::from_extension(path?)).ok_or(Error::UnknownFormat)
    }
}

/// Reads an image file as linear planes: encoded samples are decoded as the kind of file says, every channel of an EXR
/// file is kept.
///
/// # Errors
/// [`Error::File`] with the path; inside, what is wrong. Damaged, oversized and unsupported files are refused, never
/// guessed at.
pub fn read(path: &Path, limits: &Limits) -> Result<Image> {
    let bytes = load(path, limits)?;
    let picture = match FileKind::of(&bytes, Some(path)) {
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

/// As [`read`], from memory; `name` helps with formats that have no signature (TGA).
///
/// # Errors
/// As [`read`], without the path.
pub fn read_bytes(bytes: &[u8], name: Option<&Path>, limits: &Limits) -> Result<Image> {
    match FileKind::of(bytes, name)? {
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

/// As [`read_texels`], from memory; `name` helps with formats that have no signature (TGA).
///
/// # Errors
/// As [`read`], without the path.
pub fn read_texels_bytes(bytes: &[u8], name: Option<&Path>, limits: &Limits) -> Result<Texels> {
    decode(FileKind::of(bytes, name)?, bytes, limits)
}

/// As [`read_texels`], band by band: `take` gets a band of at most `height` rows with the row it begins with, from the
/// top, and the height of the picture. A PNG file is never in memory as a whole picture; of other kinds there is one
/// band, which is the picture.
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
    let read = match FileKind::of(&bytes, Some(path)) {
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
    let kind = FileKind::of(&bytes, Some(path)).ok()?;
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
