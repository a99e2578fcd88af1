//! The two containers of glTF, and the buffers: in the file, beside it, or as data URIs.

use super::{Reader, json::At};
use crate::files;
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

/// Where the parts of a file are.
#[derive(Debug)]
pub(super) struct Parts {
    pub json: Range<usize>,
    pub bin: Option<Range<usize>>,
}

/// Tells the parts of a .glb apart; any other file is JSON as a whole.
pub(super) fn split(bytes: &[u8]) -> Result<Parts, String> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Parts { json: 0..bytes.len(), bin: None });
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
    let (mut json, mut bin, mut at) = (None, None, 12);
    while at + 8 <= length {
        let size = word(at).unwrap_or(0);
        let chunk = at + 8..(at + 8).saturating_add(size);
        if chunk.end > length {
            return Err(format!("a chunk of {size} bytes at byte {at} reaches past the end of the file"));
        }
        match &bytes[at + 4..at + 8] {
            b"JSON" if json.is_none() => json = Some(chunk.clone()),
            b"BIN\0" if bin.is_none() => bin = Some(chunk.clone()),
            _ => {}
        }
        at = chunk.end.next_multiple_of(4);
    }
    Ok(Parts { json: json.ok_or("the .glb file has no JSON chunk")?, bin })
}

/// What a URI stands for.
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

/// RFC 4648, with or without padding.
fn base64(text: &str) -> Result<Vec<u8>, String> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for b in text.bytes().filter(|b| !b.is_ascii_whitespace()) {
        let value = match b {
            b'A'..=b'Z' => b - b'A',
            b'a'..=b'z' => b - b'a' + 26,
            b'0'..=b'9' => b - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => break,
            _ => return Err("the data URI is not base64".into()),
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    Ok(out)
}

impl Reader<'_> {
    /// Loads all buffers; one that cannot be had is an error unless nothing needs it.
    pub(super) fn load_buffers(&mut self, root: &At<'_>) {
        for (index, buffer) in root.list("buffers").enumerate() {
            let bytes = self.buffer(index, &buffer);
            self.buffers.push(bytes);
        }
    }

    fn buffer(&mut self, index: usize, buffer: &At<'_>) -> Option<Bytes> {
        // A stand-in for what EXT_meshopt_compression unpacks need not be there.
        if buffer.extension("EXT_meshopt_compression").is_some_and(|e| e.value["fallback"] == true) {
            return None;
        }
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
        for cut in 1..glb.len() {
            let _ = split(&glb[..cut]);
        }
        assert!(split(&glb[..30]).is_err());
        glb[12] = 200;
        assert!(split(&glb).is_err());
        glb[4] = 1;
        assert!(split(&glb).unwrap_err().contains("version 1"));
    }
}
