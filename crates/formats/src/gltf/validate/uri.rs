//! URIs (RFC 3986), as far as their form decides whether they can be read.

use super::issues::shown;

/// Why a URI is malformed.
pub(super) fn check(text: &str) -> Result<(), String> {
    let scheme = text.split_once(':').filter(|(scheme, _)| !scheme.contains(['/', '?', '#']));
    if let Some((scheme, _)) = scheme {
        let is_scheme = scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.bytes().all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b));
        if !is_scheme {
            return Err(format!("'{}' is not a URI: a colon follows a scheme, or is written %3A", shown(text)));
        }
    }
    if let Some(body) = text.strip_prefix("data:") {
        let Some((head, body)) = body.split_once(',') else {
            return Err("the data URI has no comma before its data".into());
        };
        if head.split(';').skip(1).any(|part| part != "base64" && !part.contains('=')) {
            return Err(format!("'{}' is no media type of a data URI", shown(head)));
        }
        if head.ends_with(";base64") {
            return base64(body);
        }
    }
    let bytes = text.as_bytes();
    let is_escape = |at: usize| bytes.get(at + 1..at + 3).is_some_and(|hex| hex.iter().all(u8::is_ascii_hexdigit));
    match (0..bytes.len()).find(|at| bytes[*at] == b'%' && !is_escape(*at)) {
        Some(_) => Err(format!("'%' in the URI '{}' is not followed by two hexadecimal digits", shown(text))),
        None => Ok(()),
    }
}

/// Base64 of RFC 4648 with padding.
fn base64(body: &str) -> Result<(), String> {
    let digits = body.trim_end_matches('=');
    let is_digit = |b: u8| b.is_ascii_alphanumeric() || b"+/-_%".contains(&b);
    if !digits.bytes().all(is_digit) || body.len() - digits.len() > 2 {
        return Err("the data URI is not base64".into());
    }
    if !body.len().is_multiple_of(4) && !digits.contains('%') {
        return Err("the base64 of the data URI is cut off: its length is not a multiple of four".into());
    }
    Ok(())
}

/// The media type of a data URI.
pub(super) fn media_type(text: &str) -> Option<&str> {
    let head = text.strip_prefix("data:")?.split_once(',')?.0;
    head.split(';').next()
}
