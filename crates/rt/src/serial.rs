//! Bottom-level structures as bytes, with a header that names the version (DXR,
//! "D3D12_SERIALIZED_RAYTRACING_ACCELERATION_STRUCTURE_HEADER"; Vulkan, "Serialization").
//!
//! What is written is what the structure holds, in little-endian order; the hierarchy is built from it when it is read.
//! Hits do not depend on its shape, so that they have the same bits.

use crate::bottom_level::{BottomLevel, Boxes, BuildOptions, Content, Form, Preference, Triangles};
use crate::error::{BuildError, LoadError};
use crate::flags::GeometryFlags;
use steradian_math::{Bounds3, Vec3};

/// What the bytes begin with.
const MAGIC: [u8; 8] = *b"SteradRT";
/// The version that is written, and the one that is read.
const VERSION: u32 = 1;

impl BottomLevel {
    /// The structure as bytes.
    pub fn serialize(&self) -> Vec<u8> {
        let mut out = [&MAGIC[..], &VERSION.to_le_bytes()].concat();
        let preference = match self.options().preference {
            Preference::Balanced => 0,
            Preference::FastTrace => 1,
            Preference::FastBuild => 2,
        };
        out.extend([u8::from(self.options().allow_update), preference]);
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
        let mut rest = Reader(bytes);
        if rest.take::<8>()? != MAGIC {
            return Err(LoadError::NoStructure);
        }
        let version = u32::from_le_bytes(rest.take()?);
        if version != VERSION {
            return Err(LoadError::Version { version, readable: VERSION });
        }
        let [allow_update, preference, kind] = rest.take()?;
        let preference = match preference {
            0 => Preference::Balanced,
            1 => Preference::FastTrace,
            2 => Preference::FastBuild,
            _ => return Err(LoadError::Invalid { what: "preference" }),
        };
        let options = BuildOptions { allow_update: boolean(allow_update)?, preference };
        let count = u32::from_le_bytes(rest.take()?);
        let content = match kind {
            0 => Content::Triangles((0..count).map(|_| rest.triangles()).collect::<Result<_, _>>()?),
            1 => Content::Boxes((0..count).map(|_| rest.boxes()).collect::<Result<_, _>>()?),
            _ => return Err(LoadError::Invalid { what: "kind of geometry" }),
        };
        if !rest.0.is_empty() {
            return Err(LoadError::TooLong { bytes: rest.0.len() });
        }
        Self::from_content(content, options).map_err(|error: BuildError| LoadError::Build(Box::new(error)))
    }
}

fn put_points(out: &mut Vec<u8>, count: usize, points: impl Iterator<Item = Vec3>) {
    out.extend((count as u64).to_le_bytes());
    out.extend(points.flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
}

fn boolean(byte: u8) -> Result<bool, LoadError> {
    if byte <= 1 { Ok(byte == 1) } else { Err(LoadError::Invalid { what: "truth value" }) }
}

/// Bytes that have not been read.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], LoadError> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(LoadError::TooShort)?;
        self.0 = rest;
        Ok(*taken)
    }

    /// Primitives of `N` points each, as many as are said to be there; no more memory is taken than there are bytes.
    fn points<const N: usize>(&mut self) -> Result<Vec<[Vec3; N]>, LoadError> {
        let count = usize::try_from(u64::from_le_bytes(self.take()?)).ok();
        let bytes = count.and_then(|n| n.checked_mul(12 * N)).ok_or(LoadError::TooShort)?;
        let (taken, rest) = self.0.split_at_checked(bytes).ok_or(LoadError::TooShort)?;
        self.0 = rest;
        let number = |b: &[u8]| f32::from_le_bytes(std::array::from_fn(|i| b[i]));
        let point = |b: &[u8]| Vec3::new(number(&b[..4]), number(&b[4..8]), number(&b[8..]));
        let primitive = |b: &[u8]| std::array::from_fn(|i| point(&b[12 * i..12 * i + 12]));
        Ok(taken.chunks_exact(12 * N).map(primitive).collect())
    }

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
