//! Files: a head, then each grid behind its description, which says where the next one begins.

use super::{
    head::{Head, metadata},
    tree,
    values::Values,
};
use crate::{Error, Limits, Volume, bytes::Stream, error::LISTED};

const MAGIC: &[u8; 8] = b" BDV\0\0\0\0";
/// From the version on that has one byte of form before the values of a node, to the latest one.
const VERSIONS: std::ops::RangeInclusive<u32> = 222..=225;
/// Bytes of the library's two numbers of version, and of the file's identifier.
const LIBRARY: u64 = 8;
const IDENTIFIER: u64 = 36;
/// Separates a grid's name from a number that makes it unique.
const SUFFIX: char = '\u{1e}';
/// Ending of a grid's type if its numbers are stored in 16 bits.
const HALF: &str = "_HalfFloat";

/// Tells OpenVDB's files by their first bytes.
pub(crate) fn is_one(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Reads the first grid of a name, or the first at all for an empty one.
pub(crate) fn read(bytes: &[u8], name: &str, limits: &Limits) -> Result<Volume, Error> {
    let mut file = Stream::new(bytes, "its list of grids");
    file.take(MAGIC.len() as u64)?;
    let version = file.u32()?;
    if !VERSIONS.contains(&version) {
        let (first, last) = (VERSIONS.start(), VERSIONS.end());
        return Err(Error::Unsupported(format!("it is of OpenVDB's version {version}; {first} to {last} are read")));
    }
    file.take(LIBRARY)?;
    let has_places = file.u8()? != 0;
    file.take(IDENTIFIER)?;
    metadata(&mut file)?;
    let mut there = Vec::new();
    for _ in 0..file.u32()? {
        let unique = file.text()?;
        let found = unique.split(SUFFIX).next().unwrap_or_default();
        let (kind, parent) = (file.text()?, file.text()?);
        let [grid, _, end] = [file.u64()?, file.u64()?, file.u64()?];
        if name.is_empty() || found == name {
            if !parent.is_empty() {
                let what = format!("its grid '{found}' is an instance of grid '{parent}'; name that one");
                return Err(Error::Unsupported(what));
            }
            // Streams have no places; the grid follows.
            let at = if has_places { grid } else { file.at };
            return read_grid(Stream { at, ..file }, found, &kind, limits);
        }
        if !has_places {
            let what = format!("it was written as a stream, of which only the first grid, '{found}', can be read");
            return Err(Error::Unsupported(what));
        }
        if there.len() < LISTED {
            there.push(found.to_owned());
        }
        if end <= file.at {
            return Err(Error::Malformed(format!("its grid '{found}' ends before it begins")));
        }
        file.at = end;
    }
    Err(Error::NoGrid { name: name.into(), there })
}

/// The dense grid of a grid.
fn read_grid(mut stream: Stream, name: &str, kind: &str, limits: &Limits) -> Result<Volume, Error> {
    let (tree, is_half) = kind.strip_suffix(HALF).map_or((kind, false), |tree| (tree, true));
    if tree != "Tree_float_5_4_3" {
        let what = format!("its grid '{name}' is of type '{tree}'; Tree_float_5_4_3 is read");
        return Err(Error::Unsupported(what));
    }
    stream.bytes.what = "its grid";
    let Head { packing, class, world_from_index } = Head::read(&mut stream)?;
    if class == "level set" {
        return Err(Error::Unsupported(format!("its grid '{name}' is a level set: distances, no densities")));
    }
    let values = Values { stream, packing, is_half, background: 0.0 };
    Ok(Volume { world_from_index, ..tree::dense(values, name, limits)? })
}
