//! Archives of scenes with their pictures (.usdz): zip files whose members are stored as they are.

use std::{collections::HashMap, ops::Range};

/// First bytes of a zip file.
pub(super) const MAGIC: &[u8] = b"PK\x03\x04";
const END: &[u8] = b"PK\x05\x06";
const ENTRY: &[u8] = b"PK\x01\x02";

/// Members of an archive by name.
#[derive(Debug, Default)]
pub(super) struct Members {
    /// The name of the first, which is the scene.
    pub first: String,
    pub ranges: HashMap<String, Range<usize>>,
}

fn u16_at(bytes: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?)))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    usize::try_from(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?)).ok()
}

/// The members that an archive's directory lists.
pub(super) fn members(bytes: &[u8]) -> Result<Members, String> {
    let damaged = || "the directory of the archive is missing or damaged".to_owned();
    // A comment of at most 65535 bytes is behind the end record.
    let from = bytes.len().saturating_sub(22 + 65_535);
    let tail = bytes.get(from..).unwrap_or_default();
    let end = from + tail.windows(22).rposition(|w| w.starts_with(END)).ok_or_else(damaged)?;
    let count = u16_at(bytes, end + 10).ok_or_else(damaged)?;
    let mut at = u32_at(bytes, end + 16).ok_or_else(damaged)?;
    let mut members = Members::default();
    for _ in 0..count {
        let header = |offset: usize| u16_at(bytes, at + offset).ok_or_else(damaged);
        if bytes.get(at..at + 4) != Some(ENTRY) {
            return Err(damaged());
        }
        let (flags, method) = (header(8)?, header(10)?);
        let (size, start) = (u32_at(bytes, at + 24), u32_at(bytes, at + 42));
        let (Some(size), Some(start)) = (size, start) else { return Err(damaged()) };
        let (name, extra, comment) = (header(28)?, header(30)?, header(32)?);
        let text = bytes.get(at + 46..at + 46 + name).ok_or_else(damaged)?;
        let text = String::from_utf8_lossy(text).into_owned();
        at += 46 + name + extra + comment;
        if text.ends_with('/') {
            continue;
        }
        if method != 0 || flags & 1 != 0 {
            let how = if method == 0 { "encrypted" } else { "compressed" };
            return Err(format!("its member '{text}' is {how}; members of .usdz files are stored as they are"));
        }
        let gap = u16_at(bytes, start + 26).zip(u16_at(bytes, start + 28)).ok_or_else(damaged)?;
        let begin = start + 30 + gap.0 + gap.1;
        let end = begin.checked_add(size).filter(|end| *end <= bytes.len()).ok_or_else(damaged)?;
        if members.first.is_empty() {
            members.first.clone_from(&text);
        }
        members.ranges.insert(text, begin..end);
    }
    if members.first.is_empty() { Err("the archive is empty".into()) } else { Ok(members) }
}

/// A member's name from that of the member that names it; `None` where it leads out of the archive.
pub(super) fn beside(member: &str, name: &str) -> Option<String> {
    let mut parts: Vec<&str> = member.split('/').collect();
    parts.pop();
    for part in name.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_relative_to_the_member() {
        assert_eq!(beside("a/b.usdc", "./c.png").as_deref(), Some("a/c.png"));
        assert_eq!(beside("a/b.usdc", "../c.png").as_deref(), Some("c.png"));
        assert_eq!(beside("b.usdc", "../c.png"), None);
    }
}
