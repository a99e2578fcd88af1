//! Bottom-level structures as bytes, with a header that names the version (DXR,
//! "D3D12_SERIALIZED_RAYTRACING_ACCELERATION_STRUCTURE_HEADER"; Vulkan, "Serialization").
//!
//! What is written is what the structure holds, in little-endian order; the hierarchy is built from it when it is read.
//! Hits do not depend on its shape, so that they have the same bits.

use crate::bottom_level::{BottomLevel, Boxes, Content, Form, Triangles};
use crate::bytes::{Header, Reader, boolean, option_bytes};
use crate::error::{BuildError, LoadError};
use crate::flags::GeometryFlags;
use steradian_math::{Bounds3, Vec3, hash::combine64};

/// Header of the bytes, with the version that is written and read.
const HEADER: Header = Header { what: "bottom-level structure", magic: *b"SteradRT", version: 2 };

impl BottomLevel {
    /// The structure as bytes.
    pub fn serialize(&self) -> Vec<u8> {
        let mut out = HEADER.written();
        out.extend(option_bytes(self.options()));
        match &self.content {
            Content::Triangles(all) => {
                out.push(0);
                out.extend((all.len() as u32).to_le_bytes());
                for Triangles { corners, flags, form } in all {
                    out.extend([flags.bits(), form.index_bytes, form.is_transformed.into()]);
                    out.extend((form.vertices as u64).to_le_bytes());
                    out.extend(form.index_hash.to_le_bytes());
                    put_points(&mut out, corners.len(), corners.as_flattened().iter().copied());
                }
            }
            Content::Boxes(all) => {
                out.push(1);
                out.extend((all.len() as u32).to_le_bytes());
                for Boxes { boxes, flags } in all {
                    out.push(flags.bits());
                    put_points(&mut out, boxes.len(), boxes.iter().flat_map(|b| [b.min, b.max]));
                }
            }
        }
        out
    }

    /// The structure that bytes are of.
    ///
    /// # Errors
    /// Bytes that are of something else, of another version, that end too early, go on too long, or hold what no
    /// structure may have.
    pub fn deserialize(bytes: &[u8]) -> Result<Self, LoadError> {
        let mut rest = HEADER.read(bytes)?;
        let options = rest.options()?;
        let [kind] = rest.take()?;
        let content = match kind {
            0 => Content::Triangles(rest.list(Reader::triangles)?),
            1 => Content::Boxes(rest.list(Reader::boxes)?),
            _ => return Err(LoadError::Invalid { what: "kind of geometry" }),
        };
        rest.end()?;
        Self::from_content(content, options).map_err(|error: BuildError| LoadError::Build(Box::new(error)))
    }

    /// The handle by which serialised top levels refer to it. It depends on what the structure holds alone, so that it
    /// is the same in every run (Vulkan, "capture and replay" of device addresses). It is found by reading all of it.
    pub fn handle(&self) -> u64 {
        let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte));
        self.serialize().chunks(8).fold(0, |hash, bytes| combine64(hash, word(bytes)))
    }

    /// Tests two structures for bitwise equality: of their contents, and of their hierarchies.
    pub fn same_bits(&self, other: &Self) -> bool {
        self.bvh.same_bits(&other.bvh) && self.serialize() == other.serialize()
    }
}

fn put_points(out: &mut Vec<u8>, count: usize, points: impl Iterator<Item = Vec3>) {
    out.extend((count as u64).to_le_bytes());
    out.extend(points.flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
}

impl Reader<'_> {
    fn flags(&mut self) -> Result<GeometryFlags, LoadError> {
        let [bits] = self.take()?;
        GeometryFlags::from_bits(bits).ok_or(LoadError::Invalid { what: "set of geometry flags" })
    }

    fn triangles(&mut self) -> Result<Triangles, LoadError> {
        let flags = self.flags()?;
        let [index_bytes, is_transformed] = self.take()?;
        if !matches!(index_bytes, 0 | 2 | 4) {
            return Err(LoadError::Invalid { what: "format of indices" });
        }
        let vertices = u64::from_le_bytes(self.take()?);
        let vertices = usize::try_from(vertices).map_err(|_| LoadError::Invalid { what: "number of vertices" })?;
        let index_hash = u64::from_le_bytes(self.take()?);
        let form = Form { vertices, index_bytes, index_hash, is_transformed: boolean(is_transformed)? };
        Ok(Triangles { corners: self.points()?, flags, form })
    }

    fn boxes(&mut self) -> Result<Boxes, LoadError> {
        let flags = self.flags()?;
        let boxes = self.points()?.into_iter().map(|[min, max]| Bounds3 { min, max }).collect();
        Ok(Boxes { boxes, flags })
    }
}
