//! Top-level structures as bytes. As in both APIs they refer to their bottom levels by handles, which follow the header
//! (DXR, "D3D12_SERIALIZED_RAYTRACING_ACCELERATION_STRUCTURE_HEADER"; Vulkan,
//! `vkCopyAccelerationStructureToMemoryKHR`).

use crate::bottom_level::BottomLevel;
use crate::bytes::{Header, Reader, option_bytes};
use crate::error::LoadError;
use crate::flags::InstanceFlags;
use crate::top_level::{Instance, Placed, TopLevel};
use crate::transform::Transform3x4;
use std::collections::HashMap;
use std::sync::Arc;

/// Header of the bytes, with the version that is written and read.
const HEADER: Header = Header { what: "top-level structure", magic: *b"SteradTL", version: 1 };

impl TopLevel {
    /// The bottom levels that it refers to, each once, in the order in which instances name them first.
    pub fn bottom_levels(&self) -> Vec<Arc<BottomLevel>> {
        self.by_number().0
    }

    /// The bottom levels, and for each instance the number of its one.
    fn by_number(&self) -> (Vec<Arc<BottomLevel>>, Vec<u32>) {
        let (mut levels, mut numbers) = (Vec::new(), HashMap::new());
        let number = |placed: &Placed| {
            *numbers.entry(Arc::as_ptr(&placed.bottom_level)).or_insert_with(|| {
                levels.push(placed.bottom_level.clone());
                levels.len() as u32 - 1
            })
        };
        let of_instances = self.instances.iter().map(number).collect();
        (levels, of_instances)
    }

    /// The structure as bytes: with the handles of its bottom levels, but without these.
    pub fn serialize(&self) -> Vec<u8> {
        let (levels, numbers) = self.by_number();
        let mut out = HEADER.written();
        out.extend((levels.len() as u32).to_le_bytes());
        out.extend(levels.iter().flat_map(|level| level.handle().to_le_bytes()));
        out.extend(option_bytes(self.options));
        out.extend((self.instances.len() as u32).to_le_bytes());
        for (placed, number) in self.instances.iter().zip(numbers) {
            let rows = Transform3x4::from_mat4(&placed.place.m).rows;
            out.extend(number.to_le_bytes());
            out.extend(rows.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
            out.extend([placed.custom_index, placed.hit_group_offset].map(u32::to_le_bytes).as_flattened());
            out.extend([placed.mask, placed.flags.bits()]);
        }
        out
    }

    /// The handles of the bottom levels that serialised bytes refer to, in their order.
    ///
    /// # Errors
    /// Bytes that are of something else, of another version, or end too early.
    pub fn serialized_handles(bytes: &[u8]) -> Result<Vec<u64>, LoadError> {
        handles(&mut HEADER.read(bytes)?)
    }

    /// The structure that bytes are of, over bottom levels in the order of [`TopLevel::serialized_handles`].
    ///
    /// # Errors
    /// As [`BottomLevel::deserialize`]; other bottom levels than those that the bytes refer to, or another number.
    pub fn deserialize(bytes: &[u8], bottom_levels: &[Arc<BottomLevel>]) -> Result<Self, LoadError> {
        let mut rest = HEADER.read(bytes)?;
        let handles = handles(&mut rest)?;
        let (expected, given) = (handles.len(), bottom_levels.len());
        if expected != given {
            return Err(LoadError::BottomLevelCount { expected, given });
        }
        for (place, (expected, level)) in handles.into_iter().zip(bottom_levels).enumerate() {
            let given = level.handle();
            if expected != given {
                return Err(LoadError::BottomLevel { place, expected, given });
            }
        }
        let options = rest.options()?;
        let instances = rest.list(|rest| instance(rest, bottom_levels))?;
        rest.end()?;
        Self::build(&instances, options).map_err(|error| LoadError::Build(Box::new(error)))
    }

    /// Tests two structures and their bottom levels for bitwise equality.
    pub fn same_bits(&self, other: &Self) -> bool {
        let (a, b) = (self.bottom_levels(), other.bottom_levels());
        self.bvh.same_bits(&other.bvh)
            && self.serialize() == other.serialize()
            && a.len() == b.len()
            && a.iter().zip(&b).all(|(a, b)| a.same_bits(b))
    }
}

fn handles(rest: &mut Reader) -> Result<Vec<u64>, LoadError> {
    rest.list(|rest| Ok(u64::from_le_bytes(rest.take()?)))
}

fn instance(rest: &mut Reader, bottom_levels: &[Arc<BottomLevel>]) -> Result<Instance, LoadError> {
    let level = bottom_levels.get(rest.u32()? as usize).ok_or(LoadError::Invalid { what: "bottom level" })?;
    let mut rows = [[0.0; 4]; 3];
    for number in rows.as_flattened_mut() {
        *number = f32::from_le_bytes(rest.take()?);
    }
    let (custom_index, hit_group_offset, [mask, flags]) = (rest.u32()?, rest.u32()?, rest.take()?);
    let flags = InstanceFlags::from_bits(flags).ok_or(LoadError::Invalid { what: "set of instance flags" })?;
    let bottom_level = level.clone();
    Ok(Instance { bottom_level, transform: Transform3x4 { rows }, custom_index, mask, hit_group_offset, flags })
}
