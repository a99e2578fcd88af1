//! Buffer views packed by `EXT_meshopt_compression` (Khronos registry, ratified) or `KHR_meshopt_compression` (release
//! candidate): three kinds of streams (appendix A) and filters on what comes out of them (appendix B). Both have the
//! same members; streams of version 1 and the filter of colours, which came with the second, are read in either.

mod attributes;
mod filters;
mod indices;
#[cfg(test)]
mod tests;

use super::{Reader, container::Bytes, json::At};
use crate::limits::{MOST_OF_MESHES, unpacked};

/// The two names of the extension.
const NAMES: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// The member that says how a buffer view is packed, or that a buffer is a stand-in.
pub(super) fn of<'r>(at: &At<'r>) -> Option<At<'r>> {
    NAMES.iter().find_map(|name| at.extension(name))
}

/// Byte stream: the bytes not yet read.
struct Stream<'a> {
    left: &'a [u8],
}

impl<'a> Stream<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, left) = self.left.split_at_checked(count).ok_or("the packed data ends early")?;
        self.left = left;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    /// A number in groups of seven bits, the least first (LEB128), of at most five bytes.
    fn number(&mut self) -> Result<u32, String> {
        let mut number = 0;
        for k in 0..5 {
            let byte = self.byte()?;
            number |= u32::from(byte & 0x7f) << (7 * k);
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err("a number of the packed data has more than five bytes".into())
    }

    fn finish(self) -> Result<(), String> {
        if self.left.is_empty() {
            Ok(())
        } else {
            Err(format!("{} bytes of the packed data are left", self.left.len()))
        }
    }
}

/// The signed difference that a number stands for: 0, −1, 1, −2, …
fn unzigzag(v: u32) -> u32 {
    if v & 1 == 1 { !(v >> 1) } else { v >> 1 }
}

/// Compression parameters of a buffer view.
struct Packing<'r> {
    mode: &'r str,
    filter: &'r str,
    count: usize,
    /// Bytes of an element.
    stride: usize,
}

impl Packing<'_> {
    /// The rules of the extension for these members.
    fn check(&self) -> Result<(), String> {
        let Self { mode, filter, count, stride } = *self;
        let wants = |is_so: bool, message: &str| if is_so { Ok(()) } else { Err(message.to_owned()) };
        match mode {
            "ATTRIBUTES" => wants(
                stride.is_multiple_of(4) && (4..=256).contains(&stride),
                "'byteStride' of attributes must be a multiple of 4 from 4 to 256",
            )?,
            "TRIANGLES" | "INDICES" => {
                wants(matches!(stride, 2 | 4), "'byteStride' of packed indices must be 2 or 4")?;
                wants(filter == "NONE", "packed indices have no filter")?;
                wants(mode == "INDICES" || count.is_multiple_of(3), "'count' of triangles must be a multiple of 3")?;
            }
            _ => return Err("'mode' must be one of ATTRIBUTES, TRIANGLES, INDICES".into()),
        }
        match filter {
            "NONE" | "EXPONENTIAL" => Ok(()),
            "OCTAHEDRAL" | "COLOR" => {
                wants(matches!(stride, 4 | 8), "'byteStride' of OCTAHEDRAL and COLOR data must be 4 or 8")
            }
            "QUATERNION" => wants(stride == 8, "'byteStride' of QUATERNION data must be 8"),
            _ => Err("'filter' must be one of NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL, COLOR".into()),
        }
    }

    fn unpack(&self, packed: &[u8]) -> Result<Vec<u8>, String> {
        let mut bytes = match self.mode {
            "ATTRIBUTES" => attributes::unpack(packed, self.count, self.stride)?,
            "TRIANGLES" => indices::unpack_triangles(packed, self.count, self.stride)?,
            _ => indices::unpack_sequence(packed, self.count, self.stride)?,
        };
        match self.filter {
            "OCTAHEDRAL" => filters::octahedral(&mut bytes, self.stride),
            "QUATERNION" => filters::quaternion(&mut bytes),
            "EXPONENTIAL" => filters::exponential(&mut bytes),
            "COLOR" => filters::color(&mut bytes, self.stride),
            _ => {}
        }
        Ok(bytes)
    }
}

impl Reader<'_> {
    /// The bytes of a packed buffer view, unpacked once. What is wrong is reported, also once.
    pub(super) fn unpacked_view(
        &mut self,
        root: &At<'_>,
        number: usize,
        view: &At<'_>,
        packed: &At<'_>,
    ) -> Option<Bytes> {
        if let Some(known) = self.unpacked.get(&number) {
            return known.clone();
        }
        let bytes = self.unpack_view(root, view, packed);
        self.unpacked.insert(number, bytes.clone());
        bytes
    }

    fn unpack_view(&mut self, root: &At<'_>, view: &At<'_>, at: &At<'_>) -> Option<Bytes> {
        let packed = self.view_bytes(root, at)?;
        let size = |at: &At<'_>, name: &str| -> Option<usize> { at.get(name)?.value.as_u64()?.try_into().ok() };
        let (Some(count), Some(stride)) = (size(at, "count"), size(at, "byteStride")) else {
            self.error(at, "packed data need a 'count' and a 'byteStride'");
            return None;
        };
        let filter = at.get("filter").map_or(Some("NONE"), |f| f.value.as_str()).unwrap_or_default();
        let packing = Packing { mode: at.text("mode").unwrap_or_default(), filter, count, stride };
        if let Err(why) = packing.check() {
            self.error(at, why);
            return None;
        }
        let length = size(view, "byteLength");
        let Some(all) = count.checked_mul(stride).filter(|all| Some(*all) == length) else {
            self.error(at, format!("{count} elements of {stride} bytes are not what 'byteLength' of the view says"));
            return None;
        };
        let before: usize = self.unpacked.values().flatten().map(|b| b.as_slice().len()).sum();
        let there: usize = self.buffers.iter().flatten().map(|b| b.as_slice().len()).sum();
        let most = unpacked(there, MOST_OF_MESHES);
        if before.saturating_add(all) as u64 > most {
            self.error(
                at,
                format!("all unpacked data together are more than {most} bytes, too many for {there} packed ones"),
            );
            return None;
        }
        match packing.unpack(packed.as_slice()) {
            Ok(bytes) => Some(Bytes::whole(bytes)),
            Err(why) => {
                self.error(at, why);
                None
            }
        }
    }
}
