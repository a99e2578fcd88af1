//! Format of a picture file, by its content or its name.

use std::path::Path;

/// The first bytes of a KTX2 file.
pub(crate) const KTX2: [u8; 12] = [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, b'\r', b'\n', 0x1a, b'\n'];

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
            _ if bytes.starts_with(&KTX2) => Some(Self::Ktx2),
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
}
