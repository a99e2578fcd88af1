//! Pictures: whether their first bytes are those of a picture of the declared type.

use super::{
    Issues,
    document::{Document, index},
    elements::Data,
    issues::shown,
    objects, uri,
};
use crate::{
    files::SearchPath,
    gltf::container::{Uri, uri as read_uri},
};
use serde_json::Value;
use std::io::Read;

/// Bytes read from the beginning of an image.
const HEAD: u64 = 1 << 16;

pub(super) fn check(document: &Document<'_>, data: &Data<'_>, search: &SearchPath, issues: &mut Issues) {
    for (k, image) in document.list("images").iter().enumerate() {
        let place = format!("/images/{k}");
        let Some(bytes) = head(document, data, search, image, &place, issues) else { continue };
        let text = image["uri"].as_str();
        let declared = image["mimeType"].as_str().or_else(|| text.and_then(uri::media_type));
        if let Some(found) = recognized(&bytes) {
            objects::check_media(document, found, &place, issues);
            if let Some(declared) = declared.filter(|declared| *declared != found) {
                let place = if text.is_some() { format!("{place}/uri") } else { place.clone() };
                issues.add(place, format!("this picture is '{found}', but '{}' is declared", shown(declared)));
            }
        }
        if let Err(why) = check_header(&bytes) {
            issues.add(&place, why);
        }
    }
}

/// The first bytes of a picture.
fn head(
    document: &Document<'_>,
    data: &Data<'_>,
    search: &SearchPath,
    image: &Value,
    place: &str,
    issues: &mut Issues,
) -> Option<Vec<u8>> {
    if let Some(view) = index(image, "bufferView") {
        let bytes = data.view(document, view, 0)?;
        return Some(bytes[..bytes.len().min(HEAD as usize)].to_vec());
    }
    match read_uri(image["uri"].as_str()?).ok()? {
        Uri::Data(bytes) => Some(bytes),
        Uri::File(name) => match search.find(&name) {
            Ok(path) => {
                let mut bytes = Vec::new();
                std::fs::File::open(path).ok()?.take(HEAD).read_to_end(&mut bytes).ok()?;
                Some(bytes)
            }
            Err(why) => {
                issues.add(place, why.to_string());
                None
            }
        },
    }
}

fn recognized(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        _ => None,
    }
}

/// Follows a PNG or JPEG file to its size.
fn check_header(bytes: &[u8]) -> Result<(), &'static str> {
    const CUT_OFF: &str = "the data of this picture is cut off";
    match recognized(bytes) {
        Some("image/png") => match bytes.get(8..33) {
            None => Err(CUT_OFF),
            Some(header) if header[..8] != *b"\0\0\0\rIHDR" => Err("this picture is no PNG: its header is missing"),
            Some(_) => Ok(()),
        },
        Some("image/jpeg") => {
            let mut at = 2;
            loop {
                let Some([mark, kind, high, low]) = bytes.get(at..at + 4) else {
                    return if bytes.len() as u64 >= HEAD { Ok(()) } else { Err(CUT_OFF) };
                };
                let length = usize::from(*high) << 8 | usize::from(*low);
                match (mark, kind) {
                    (0xff, 0xff) => at += 1,
                    // The size is in frames of all kinds.
                    (0xff, 0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf) => return Ok(()),
                    (0xff, 0xd0..=0xd8 | 0x01) => at += 2,
                    (0xff, _) if length >= 2 => at += 2 + length,
                    _ => return Err("this picture is no JPEG: a segment of it is malformed"),
                }
            }
        }
        _ => Ok(()),
    }
}
