//! Readers of scene files by extension and by content. A new format is a module with its reader and an entry in
//! [`READERS`].

use crate::{
    Import, Options, gltf,
    mesh::{model, stl},
    mitsuba, native, pbrt, usd,
};
use std::path::Path;

/// Reader of a scene format.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    /// Extensions of its files without the dot, with the content.
    pub extensions: &'static [(&'static str, &'static str)],
    /// Names that `-D name=value` sets; `None` where the reader itself tells definitions without effect, since files
    /// name what can be set.
    pub definitions: Option<&'static [&'static str]>,
    /// True if bytes look like the format.
    looks_like: fn(&Beginning<'_>) -> bool,
    file: fn(&Path, &Options) -> Import,
    bytes: fn(&Path, Vec<u8>, &Options) -> Import,
}

/// The beginning of a file.
struct Beginning<'b> {
    bytes: &'b [u8],
    /// First byte of the first line that is neither empty nor a comment with `#`; 0 without one.
    first: u8,
}

impl<'b> Beginning<'b> {
    fn of(bytes: &'b [u8]) -> Self {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let lines = text.split(|b| *b == b'\n').map(<[u8]>::trim_ascii);
        let first = lines.filter(|line| !line.is_empty()).find(|line| line[0] != b'#').map_or(0, |line| line[0]);
        Self { bytes, first }
    }
}

const MODEL_DEFINITIONS: &[&str] = &[
    "azimuth",
    "background",
    "crease",
    "elevation",
    "front",
    "ground",
    "handedness",
    "material",
    "sky",
    "strength",
    "sun",
    "turn",
    "up",
];

/// Models of one extension.
const fn model(extensions: &'static [(&'static str, &'static str)], looks_like: fn(&Beginning<'_>) -> bool) -> Reader {
    Reader {
        extensions,
        definitions: Some(MODEL_DEFINITIONS),
        looks_like,
        file: model::import,
        bytes: model::import_bytes,
    }
}

/// All readers. Bytes are held against them in this order.
pub const READERS: &[Reader] = &[
    Reader {
        extensions: &[("pbrt", "pbrt-v4 scene, also gzip-compressed (.pbrt.gz)")],
        definitions: Some(&[]),
        // Whatever looks like nothing else.
        looks_like: |_| false,
        file: pbrt::import,
        bytes: |path, bytes, options| pbrt::import_text(&path.to_string_lossy(), bytes, Path::new("."), options),
    },
    Reader {
        extensions: &[("xml", "Mitsuba scene: version 3, 2, or 0.6")],
        definitions: None,
        looks_like: |b| b.first == b'<' && !usd::looks_like(b.bytes),
        file: mitsuba::import,
        bytes: |path, bytes, options| mitsuba::import_bytes(bytes, path, options),
    },
    Reader {
        extensions: &[("steradian", "scene in Steradian's own language")],
        definitions: Some(&[]),
        // Its documents begin with their version.
        looks_like: |b| b.bytes.trim_ascii_start().starts_with(b"steradian"),
        file: native::import,
        bytes: native::import_bytes,
    },
    Reader {
        extensions: &[("gltf", "glTF 2.0 scene, also in binary form (.glb)"), ("glb", "glTF 2.0 scene in binary form")],
        definitions: Some(&[
            "animation",
            "at",
            "azimuth",
            "background",
            "elevation",
            "ground",
            "scene",
            "shutter",
            "sky",
            "strength",
            "sun",
            "turn",
            "variant",
        ]),
        looks_like: |b| b.bytes.starts_with(b"glTF") || b.first == b'{',
        file: gltf::import,
        bytes: gltf::import_bytes,
    },
    Reader {
        extensions: &[
            ("usd", "Universal Scene Description, in text or binary form"),
            ("usda", "Universal Scene Description in text"),
            ("usdc", "Universal Scene Description in binary form"),
            ("usdz", "Universal Scene Description with its pictures, as an archive"),
            ("mtlx", "MaterialX document, shown on balls"),
        ],
        definitions: Some(&["at", "azimuth", "background", "elevation", "ground", "sky", "strength", "sun", "turn"]),
        looks_like: |b| usd::looks_like(b.bytes),
        file: usd::import,
        bytes: usd::import_bytes,
    },
    model(&[("ply", "polygon model")], |b| b.bytes.starts_with(b"ply")),
    model(&[("stl", "triangles, binary or text")], |b| stl::looks_like(b.bytes)),
    // Statements of OBJ begin with a small letter, pbrt's directives with a capital.
    model(&[("obj", "Wavefront model with materials")], |b| b.first.is_ascii_lowercase()),
    model(&[("bpt", "Bézier patches in text, such as the Utah teapot")], |_| false),
];

impl Reader {
    /// The reader of files with an extension, in small letters without the dot.
    pub fn of_extension(extension: &str) -> Option<&'static Self> {
        READERS.iter().find(|reader| reader.extensions.iter().any(|e| e.0 == extension))
    }

    /// The reader of what bytes look like: pbrt's, where that is nothing else.
    pub fn of_bytes(bytes: &[u8]) -> &'static Self {
        let beginning = Beginning::of(bytes);
        READERS.iter().find(|reader| (reader.looks_like)(&beginning)).unwrap_or(&READERS[0])
    }

    /// Reads a file.
    pub fn import(&self, path: &Path, options: &Options) -> Import {
        (self.file)(path, options)
    }

    /// Reads a file in memory. Files that it names are beside `path`, of pbrt's in the current folder.
    pub fn import_bytes(&self, path: &Path, bytes: Vec<u8>, options: &Options) -> Import {
        (self.bytes)(path, bytes, options)
    }
}

/// Extensions of all formats that are read, with the content.
pub fn extensions() -> impl Iterator<Item = (&'static str, &'static str)> + Clone {
    READERS.iter().flat_map(|reader| reader.extensions).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_their_beginning() {
        for (text, format) in [
            ("ply\nformat ascii 1.0\n", "ply"),
            ("\u{feff}<?xml version='1.0'?>\n<scene/>", "xml"),
            ("\n  <scene version='3.0.0'>", "xml"),
            ("# a comment\n\nLookAt 0 0 1 0 0 0 0 1 0", "pbrt"),
            ("# Blender\r\nmtllib a.mtl\r\n", "obj"),
            ("v 0 0 0\n", "obj"),
            ("glTF\u{2}", "glb"),
            ("{ \"asset\": {} }", "gltf"),
            ("steradian: 1", "steradian"),
            ("", "pbrt"),
        ] {
            let reader = Reader::of_bytes(text.as_bytes());
            assert!(reader.extensions.iter().any(|e| e.0 == format), "{text:?}: {:?}", reader.extensions);
        }
    }
}
