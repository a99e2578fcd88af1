//! Files and the head of a grid.
//!
//! A file is a sequence of segments: a head of 16 bytes (magic, version, count of grids, codec), then for each grid 176
//! bytes and its name, then the grids, packed one by one. Or it is grids as they lie in memory.

use super::tree;
use crate::{Error, Limits, Volume, blosc, bytes::Bytes, error::LISTED, unpack};

const OLD: &[u8; 8] = b"NanoVDB0";
const GRID: &[u8; 8] = b"NanoVDB1";
const FILE: &[u8; 8] = b"NanoVDB2";
const MAJOR: u32 = 32;
const SEGMENT_HEAD: u64 = 16;
const GRID_HEAD: u64 = 176;
/// Bytes of a grid before its tree.
pub(super) const GRID_SIZE: u64 = 672;
/// Bytes that Blosc packs at once.
const CHUNK: u64 = 1 << 30;

/// Tells NanoVDB's files by their first bytes.
pub(crate) fn is_one(bytes: &[u8]) -> bool {
    [OLD, GRID, FILE].iter().any(|magic| bytes.starts_with(*magic))
}

/// Reads the first grid of a name, or the first at all for an empty one.
pub(crate) fn read(bytes: &[u8], name: &str, limits: &Limits) -> Result<Volume, Error> {
    let mut there = Vec::new();
    let mut is_wanted = |found: &str| {
        if there.len() < LISTED {
            there.push(found.to_owned());
        }
        name.is_empty() || found == name
    };
    let file = Bytes { all: bytes, what: "its list of grids" };
    let mut at = 0;
    while at < bytes.len() as u64 {
        let magic = file.part(at, 8)?;
        if magic == GRID {
            // Grids as they lie in memory, one after the other.
            let found = text(file.part(at + 40, 256)?);
            let size = file.u64(at + 32)?;
            if is_wanted(&found) {
                return grid(Bytes { all: bytes, what: "its grid" }.part(at, size)?, &found, limits);
            }
            at = at.checked_add(size.max(GRID_SIZE)).ok_or(Error::Short("its grid"))?;
            continue;
        }
        if magic != OLD && magic != FILE {
            return Err(Error::Malformed(format!("at byte {at} there is no segment of grids")));
        }
        check_version(file.u32(at + 8)?)?;
        let (count, codec) = (file.u16(at + 12)?, file.u16(at + 14)?);
        let mut head = at + SEGMENT_HEAD;
        let mut grids = Vec::new();
        for _ in 0..count {
            let (size, packed) = (file.u64(head)?, file.u64(head + 8)?);
            let length = u64::from(file.u32(head + 136)?);
            grids.push((text(file.part(head + GRID_HEAD, length)?), size, packed));
            head += GRID_HEAD + length;
        }
        at = head;
        for (found, size, packed) in grids {
            let body = Bytes { all: bytes, what: "its grid" }.part(at, packed)?;
            if is_wanted(&found) {
                return grid(&unpacked(body, codec, size, limits)?, &found, limits);
            }
            at += packed;
        }
    }
    Err(Error::NoGrid { name: name.into(), there })
}

/// Text up to its first zero.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.split(|b| *b == 0).next().unwrap_or_default()).into_owned()
}

fn check_version(version: u32) -> Result<(), Error> {
    let (major, minor) = (version >> 21, version >> 10 & 0x7ff);
    if major == MAJOR {
        return Ok(());
    }
    Err(Error::Unsupported(format!("it is of NanoVDB's version {major}.{minor}; {MAJOR} is read")))
}

/// The bytes of a grid as they lie in memory.
fn unpacked(body: &[u8], codec: u16, size: u64, limits: &Limits) -> Result<Vec<u8>, Error> {
    if size > limits.bytes {
        return Err(Error::Limit(format!("its grid has {size} bytes, more than {}", limits.bytes)));
    }
    let body = Bytes { all: body, what: "its packed grid" };
    match codec {
        0 => Ok(body.part(0, size)?.to_vec()),
        1 => unpack::inflate(body.part(8, body.u64(0)?)?, size),
        2 => {
            let (mut all, mut at) = (Vec::new(), 0_u64);
            while (all.len() as u64) < size {
                let packed = body.u64(at)?;
                let chunk = (size - all.len() as u64).min(CHUNK);
                all.extend(blosc::unpack(body.part(at + 8, packed)?, chunk)?);
                at += 8 + packed;
            }
            Ok(all)
        }
        other => Err(Error::Unsupported(format!("its grids are packed by codec {other}, which is not known"))),
    }
}

/// The dense grid of a grid as it lies in memory.
fn grid(bytes: &[u8], name: &str, limits: &Limits) -> Result<Volume, Error> {
    let grid = Bytes { all: bytes, what: "its grid" };
    let magic = grid.part(0, 8)?;
    if magic != OLD && magic != GRID {
        return Err(Error::Malformed(format!("its grid '{name}' does not begin with NanoVDB's magic number")));
    }
    check_version(grid.u32(16)?)?;
    match grid.u32(632)? {
        // Of no class, or of densities.
        0 | 2 => {}
        1 => return Err(Error::Unsupported(format!("its grid '{name}' is a level set: distances, no densities"))),
        other => return Err(Error::Unsupported(format!("its grid '{name}' is of class {other}, not of densities"))),
    }
    // The map: a matrix by rows and what is added, in double precision.
    let mut map = [[0.0; 4]; 3];
    for (i, row) in (0_u64..).zip(&mut map) {
        for (j, value) in (0_u64..).zip(row) {
            *value = grid.f64(if j < 3 { 384 + 8 * (3 * i + j) } else { 528 + 8 * i })?;
        }
    }
    let leaves = tree::Leaves::of(grid.u32(636)?)
        .map_err(|kind| Error::Unsupported(format!("its grid '{name}' is of {kind}; numbers of 32 bits are read")))?;
    Ok(Volume { world_from_index: map, ..tree::dense(&grid, &leaves, name, limits)? })
}
