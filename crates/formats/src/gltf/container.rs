//! The two containers of glTF, and the buffers: in the file, beside it, or as data URIs.

use super::{Reader, json::At, meshopt};
use crate::files;
use base64::{
    Engine as _,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use std::{ops::Range, sync::Arc};

/// Bytes that are shared, not copied.
#[derive(Clone, Debug)]
pub(super) struct Bytes {
    all: Arc<[u8]>,
    range: Range<usize>,
}

impl Bytes {
    pub fn new(all: Arc<[u8]>, range: Range<usize>) -> Self {
        Self { all, range }
    }

    pub fn whole(bytes: Vec<u8>) -> Self {
        let range = 0..bytes.len();
        Self { all: bytes.into(), range }
    }

    pub fn as_slice(&self) -> &[u8] {
        &self.all[self.range.clone()]
    }

    /// A part; `None` where it reaches past the end.
    pub fn part(&self, offset: usize, length: usize) -> Option<Self> {
        let start = self.range.start.checked_add(offset)?;
        let end = start.checked_add(length)?;
        (end <= self.range.end).then(|| Self { all: self.all.clone(), range: start..end })
    }
}

/// Byte ranges of the chunks of a .glb file.
#[derive(Debug)]
pub(super) struct Parts {
    pub json: Range<usize>,
    pub bin: Option<Range<usize>>,
    /// Violations of the container format that do not hinder reading.
    pub faults: Vec<String>,
}

/// Most faults that are told.
const MOST_FAULTS: usize = 10;

/// Tells the parts of a .glb apart; any other file is JSON as a whole.
pub(super) fn split(bytes: &[u8]) -> Result<Parts, String> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Parts { json: 0..bytes.len(), bin: None, faults: Vec::new() });
    }
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let version = word(4).ok_or("the header of the .glb file is cut off")?;
    if version != 2 {
        return Err(format!("version {version} of the binary container is not read; 2 is"));
    }
    let length = word(8).ok_or("the header of the .glb file is cut off")?;
    if length > bytes.len() {
        return Err(format!("the file is cut off: it holds {} of {length} bytes", bytes.len()));
    }
    let mut faults = Vec::new();
    let mut fault = |message: String| {
        if faults.len() < MOST_FAULTS {
            faults.push(message);
        }
    };
    if length < bytes.len() {
        fault(format!("the header of the .glb file declares {length} bytes, but it holds {}", bytes.len()));
    }
    let (mut json, mut bin, mut at, mut number) = (None, None, 12, 0);
    while at + 8 <= length {
        let size = word(at).unwrap_or(0);
        let chunk = at + 8..(at + 8).saturating_add(size);
        if chunk.end > length {
            return Err(format!("a chunk of {size} bytes at byte {at} reaches past the end of the file"));
        }
        let kind = &bytes[at + 4..at + 8];
        if number == 0 && kind != b"JSON" {
            fault("the first chunk of a .glb file must be JSON".into());
        }
        if !size.is_multiple_of(4) {
            fault(format!("the chunk at byte {at} has {size} bytes, which is no multiple of four"));
        }
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk.clone()),
            b"BIN\0" if bin.is_none() => {
                bin = Some(chunk.clone());
                if number != 1 {
                    fault("the binary chunk of a .glb file must be the second chunk".into());
                }
            }
            b"JSON" | b"BIN\0" => {
                fault(format!("the chunk at byte {at} repeats a type of which there is one; it is left out"))
            }
            _ => {}
        }
        at = chunk.end.next_multiple_of(4);
        number += 1;
    }
    if at < length {
        fault(format!("{} bytes at the end of the .glb file are no chunk", length - at));
    }
    let json = json.ok_or_else(|| match length {
        0..20 => format!("the header of the .glb file declares {length} bytes, too few for a JSON chunk"),
        _ => "the .glb file has no JSON chunk".into(),
    })?;
    if json.is_empty() {
        return Err("the JSON chunk of the .glb file is empty".into());
    }
    Ok(Parts { json, bin, faults })
}

/// Target of a URI.
pub(super) enum Uri {
    /// The bytes of a `data:` URI.
    Data(Vec<u8>),
    /// A relative path.
    File(String),
}

/// Reads a URI. Only `data:` URIs in base64 and relative paths inside the folder of the scene are followed.
pub(super) fn uri(text: &str) -> Result<Uri, String> {
    if let Some(rest) = text.strip_prefix("data:") {
        let (head, body) = rest.split_once(',').ok_or("the data URI has no comma before its data")?;
        if !head.ends_with(";base64") {
            return Ok(Uri::Data(percent_decoded(body)?));
        }
        return base64(body).map(Uri::Data);
    }
    if let Some((scheme, _)) = text.split_once("://") {
        return Err(format!("'{scheme}:' addresses are not read: the file must be there"));
    }
    let path = String::from_utf8(percent_decoded(text)?).map_err(|_| "the URI is not UTF-8")?;
    // `..` may not climb above the folder of the scene.
    let climbs = path.split(['/', '\\']).try_fold(0, |depth: usize, part| match part {
        ".." => depth.checked_sub(1),
        "." | "" => Some(depth),
        _ => Some(depth + 1),
    });
    let is_inside = !path.starts_with(['/', '\\']) && !path.contains(':') && climbs.is_some();
    if is_inside { Ok(Uri::File(path)) } else { Err(format!("'{path}' leads out of the folder of the scene")) }
}

fn percent_decoded(text: &str) -> Result<Vec<u8>, String> {
    let (bytes, mut out, mut at) = (text.as_bytes(), Vec::with_capacity(text.len()), 0);
    while at < bytes.len() {
        if bytes[at] == b'%' {
            let code = text.get(at + 1..at + 3).and_then(|hex| u8::from_str_radix(hex, 16).ok());
            out.push(code.ok_or("'%' in a URI is not followed by two hexadecimal digits")?);
            at += 3;
        } else {
            out.push(bytes[at]);
            at += 1;
        }
    }
    Ok(out)
}

/// RFC 4648 in either alphabet, with or without padding and line breaks.
fn base64(text: &str) -> Result<Vec<u8>, String> {
    const LENIENT: GeneralPurpose = GeneralPurpose::new(
        &STANDARD,
        GeneralPurposeConfig::new()
            .with_decode_allow_trailing_bits(true)
            .with_decode_padding_mode(DecodePaddingMode::RequireNone),
    );
    let digits = text.bytes().filter(|b| !b.is_ascii_whitespace()).take_while(|b| *b != b'=');
    let digits: Vec<u8> = digits
        .map(|b| {
            if b == b'-' {
                b'+'
            } else if b == b'_' {
                b'/'
            } else {
                b
            }
        })
        .collect();
    LENIENT.decode(digits).map_err(|_| "the data URI is not base64".into())
}

impl Reader<'_> {
    /// Loads all buffers; one that cannot be had is an error unless nothing needs it.
    pub(super) fn load_buffers(&mut self, root: &At<'_>) {
        for (index, buffer) in root.list("buffers").enumerate() {
            let bytes = if self.is_stand_in(root, index, &buffer) { None } else { self.buffer(index, &buffer) };
            self.buffers.push(bytes);
        }
    }

    /// Tests for a fallback buffer, which only represents the unpacked data of compressed views and need not be
    /// present: it is marked as such, or it has no data and nothing but such views.
    fn is_stand_in(&self, root: &At<'_>, index: usize, buffer: &At<'_>) -> bool {
        let is_empty = buffer.text("uri").is_none() && (index > 0 || self.bin.is_none());
        meshopt::of(buffer).is_some_and(|e| e.value["fallback"] == true)
            || is_empty && {
                let mut views = root.list("bufferViews").filter(|v| v.value["buffer"] == index).peekable();
                views.peek().is_some() && views.all(|v| meshopt::of(&v).is_some())
            }
    }

    fn buffer(&mut self, index: usize, buffer: &At<'_>) -> Option<Bytes> {
        let length = buffer.get("byteLength").and_then(|l| l.value.as_u64());
        let Some(length) = length.and_then(|l| usize::try_from(l).ok()) else {
            self.error(buffer, "a buffer needs a 'byteLength'");
            return None;
        };
        let bytes = match buffer.text("uri") {
            None if index == 0 && self.bin.is_some() => self.bin.clone()?,
            None => {
                self.error(buffer, "this buffer has no 'uri', and the file has no binary chunk for it");
                return None;
            }
            Some(text) => match self.resource(buffer, text) {
                Some(bytes) => Bytes::whole(bytes),
                None => return None,
            },
        };
        let there = bytes.as_slice().len();
        if there < length {
            self.error(buffer, format!("the buffer holds {there} of the {length} bytes that 'byteLength' promises"));
            return None;
        }
        bytes.part(0, length)
    }

    /// The bytes behind a URI; failures are reported.
    fn resource(&mut self, at: &At<'_>, text: &str) -> Option<Vec<u8>> {
        let read = uri(text).and_then(|uri| match uri {
            Uri::Data(bytes) => Ok(bytes),
            Uri::File(name) => {
                let found = self.search.find(&name).map_err(|e| e.to_string())?;
                let bytes = files::read(&found, &self.options.limits).map_err(|e| e.to_string())?;
                self.import.desc.sources.note(found);
                Ok(bytes)
            }
        });
        read.map_err(|why| self.error(at, why)).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_told_apart() {
        let data = |text: &str| match uri(text) {
            Ok(Uri::Data(bytes)) => String::from_utf8(bytes).unwrap(),
            _ => panic!("{text}"),
        };
        assert_eq!(data("data:application/octet-stream;base64,SGVsbG8h"), "Hello!");
        assert_eq!(data("data:;base64,SGVsbG8="), "Hello");
        assert_eq!(data("data:text/plain,a%20b"), "a b");
        let file = |text: &str| match uri(text) {
            Ok(Uri::File(name)) => name,
            _ => panic!("{text}"),
        };
        assert_eq!(file("a%20b/c.bin"), "a b/c.bin");
        assert_eq!(file("x/../y.png"), "x/../y.png");
        for bad in
            ["../x.bin", "/etc/passwd", "a/../../x", "C:\\x", "http://x/y", "data:;base64", "data:;base64,!", "a%zz"]
        {
            assert!(uri(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn binary_containers_are_checked() {
        let mut glb = b"glTF\x02\0\0\0\x20\0\0\0\x04\0\0\0JSON{}  \0\0\0\0BIN\0".to_vec();
        let parts = split(&glb).unwrap();
        assert_eq!((parts.json, parts.bin), (20..24, Some(32..32)));
        assert_eq!(parts.faults, [""; 0]);
        for cut in 1..glb.len() {
            let _ = split(&glb[..cut]);
        }
        assert!(split(&glb[..30]).is_err());
        glb[12] = 200;
        assert!(split(&glb).is_err());
        glb[4] = 1;
        assert!(split(&glb).unwrap_err().contains("version 1"));
    }
    #[test]
    fn rules_of_the_container_are_told() {
        let glb = |chunks: &[(&[u8; 4], &[u8])], rest: &[u8]| {
            let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
            for (kind, data) in chunks {
                bytes.extend((data.len() as u32).to_le_bytes());
                bytes.extend(*kind);
                bytes.extend(*data);
            }
            bytes.extend(rest);
            let length = (bytes.len() as u32).to_le_bytes();
            bytes[8..12].copy_from_slice(&length);
            bytes
        };
        let told = |bytes: &[u8], words: &str| {
            let faults = split(bytes).unwrap().faults;
            assert!(faults.iter().any(|f| f.contains(words)), "{words}: {faults:?}");
        };
        let refused = |bytes: &[u8], words: &str| {
            let why = split(bytes).unwrap_err();
            assert!(why.contains(words), "{words}: {why}");
        };
        let json: (&[u8; 4], &[u8]) = (b"JSON", b"{}  ");
        told(&glb(&[(b"JSON", b"{} ")], b""), "3 bytes, which is no multiple of four");
        told(&glb(&[json, json], b""), "repeats a type");
        told(&glb(&[json, (b"BIN\0", b""), (b"BIN\0", b"")], b""), "repeats a type");
        told(&glb(&[json, (b"XXXX", b""), (b"BIN\0", b"")], b""), "must be the second chunk");
        told(&glb(&[(b"BIN\0", b""), json], b""), "first chunk of a .glb file must be JSON");
        told(&glb(&[json], b"abc"), "3 bytes at the end");
        let mut long = glb(&[json], b"");
        long.extend(b"more");
        told(&long, "declares 24 bytes, but it holds 28");
        refused(&glb(&[], b""), "12 bytes, too few");
        refused(&glb(&[(b"BIN\0", b"")], b""), "no JSON chunk");
        refused(&glb(&[(b"JSON", b"")], b""), "is empty");
        refused(b"glTF\x02\0", "header of the .glb file is cut off");
    }
}
