//! Capture and replay of launches: structures, tables and size as bytes, from which another run makes the same picture.
//!
//! In the APIs tools that capture need device addresses and shader-group handles that are the same when a capture is
//! replayed (Vulkan, `accelerationStructureCaptureReplay`, `rayTracingPipelineShaderGroupHandleCaptureReplay`). Here
//! addresses are [`BottomLevel::handle`], and handles of groups [`Pipeline::handle_bytes`]. Shaders are Rust and in no
//! capture, as the APIs have them in the pipeline: the replay links the same pipeline.

use crate::bottom_level::BottomLevel;
use crate::bytes::{Header, Reader, put_slice};
use crate::error::{LaunchError, LoadError, ReplayError, UnknownHandle};
use crate::group::HitGroup;
use crate::handle_bytes::{HANDLE_BYTES, Kind};
use crate::interface::Interface;
use crate::pipeline::Pipeline;
use crate::stages::{Callable, Miss, RayGeneration};
use crate::table::{Handle, Record, ShaderTable, ShaderTables, kind};
use crate::top_level::TopLevel;
use std::collections::HashMap;
use std::sync::Arc;

/// Header of the bytes, with the version that is written and read.
const HEADER: Header = Header { what: "capture of a launch", magic: *b"SteradCR", version: 1 };

/// Inputs of a launch, but for its shaders.
#[derive(Clone, Debug)]
pub struct Capture {
    size: [u32; 3],
    scene: TopLevel,
    ray_generation: Bytes,
    miss: Table,
    hit_groups: Table,
    callable: Table,
}

/// A table without types.
#[derive(Clone, Debug)]
struct Table {
    base: u32,
    stride: u32,
    records: Vec<Bytes>,
}

/// A record as bytes: of its handle, all zero where it is null, and of its local data.
#[derive(Clone, Debug)]
struct Bytes {
    handle: [u8; HANDLE_BYTES],
    local: Vec<u8>,
}

/// Handles of one kind by their bytes.
type Handles<K> = HashMap<[u8; HANDLE_BYTES], Handle<K>>;

impl<I: Interface, R: RayGeneration<I>, H: HitGroup<I>, M: Miss<I>, C: Callable<I>> Pipeline<I, R, H, M, C> {
    /// Captures a launch of some size in a scene; `local` makes bytes of local data.
    ///
    /// # Errors
    /// A record with a handle of another pipeline.
    pub fn capture(
        &self,
        tables: &ShaderTables<I::Local>,
        size: [u32; 3],
        scene: &TopLevel,
        local: impl Fn(&I::Local) -> Vec<u8>,
    ) -> Result<Capture, LaunchError> {
        self.check(tables)?;
        Ok(Capture {
            size,
            scene: scene.clone(),
            ray_generation: Bytes::of(
                &by_place(&self.handles::<kind::RayGeneration>()),
                &tables.ray_generation,
                &local,
            ),
            miss: Table::of(&self.handles(), &tables.miss, &local),
            hit_groups: Table::of(&self.handles(), &tables.hit_groups, &local),
            callable: Table::of(&self.handles(), &tables.callable, &local),
        })
    }

    /// The tables of a capture, with handles of this pipeline; `local` makes local data of bytes.
    ///
    /// # Errors
    /// A handle that this pipeline does not have; bytes that `local` gives nothing for.
    pub fn replay(
        &self,
        capture: &Capture,
        local: impl Fn(&[u8]) -> Option<I::Local>,
    ) -> Result<ShaderTables<I::Local>, ReplayError> {
        Ok(ShaderTables::new(capture.ray_generation.record(&self.handles(), 0, &local)?)
            .with_miss(capture.miss.table(&self.handles(), &local)?)
            .with_hit_groups(capture.hit_groups.table(&self.handles(), &local)?)
            .with_callable(capture.callable.table(&self.handles(), &local)?))
    }
}

/// The bytes of handles by their places in the pipeline.
fn by_place<K>(handles: &Handles<K>) -> HashMap<u32, [u8; HANDLE_BYTES]> {
    handles.iter().map(|(bytes, handle)| (handle.index, *bytes)).collect()
}

impl Bytes {
    fn of<K, L>(
        handles: &HashMap<u32, [u8; HANDLE_BYTES]>,
        record: &Record<K, L>,
        local: impl Fn(&L) -> Vec<u8>,
    ) -> Self {
        let handle = record.handle.and_then(|handle| handles.get(&handle.index));
        Self { handle: handle.copied().unwrap_or_default(), local: local(&record.local) }
    }

    fn record<K: Kind, L>(
        &self,
        handles: &Handles<K>,
        place: usize,
        local: impl Fn(&[u8]) -> Option<L>,
    ) -> Result<Record<K, L>, ReplayError> {
        let unknown = || ReplayError::Handle { place, error: UnknownHandle { kind: K::NAME } };
        let is_null = self.handle == [0; HANDLE_BYTES];
        let handle = if is_null { None } else { Some(*handles.get(&self.handle).ok_or_else(unknown)?) };
        let no_local = || ReplayError::Local { kind: K::NAME, place, bytes: self.local.len() };
        Ok(Record { handle, local: local(&self.local).ok_or_else(no_local)? })
    }

    fn put(&self, out: &mut Vec<u8>) {
        out.extend(self.handle);
        put_slice(out, &self.local);
    }

    fn read(rest: &mut Reader) -> Result<Self, LoadError> {
        Ok(Self { handle: rest.take()?, local: rest.counted()?.to_vec() })
    }
}

impl Table {
    fn of<K, L>(handles: &Handles<K>, table: &ShaderTable<K, L>, local: impl Fn(&L) -> Vec<u8>) -> Self {
        let bytes = by_place(handles);
        let records = table.records.iter().map(|record| Bytes::of(&bytes, record, &local)).collect();
        Self { base: table.base, stride: table.stride, records }
    }

    fn table<K: Kind, L>(
        &self,
        handles: &Handles<K>,
        local: impl Fn(&[u8]) -> Option<L>,
    ) -> Result<ShaderTable<K, L>, ReplayError> {
        let records = self.records.iter().enumerate().map(|(place, bytes)| bytes.record(handles, place, &local));
        Ok(ShaderTable::new(records.collect::<Result<_, _>>()?).with_region(self.base, self.stride))
    }

    fn put(&self, out: &mut Vec<u8>) {
        out.extend([self.base, self.stride, self.records.len() as u32].map(u32::to_le_bytes).as_flattened());
        self.records.iter().for_each(|record| record.put(out));
    }

    fn read(rest: &mut Reader) -> Result<Self, LoadError> {
        Ok(Self { base: rest.u32()?, stride: rest.u32()?, records: rest.list(Bytes::read)? })
    }
}

impl Capture {
    /// Number of launch ids in each direction.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// The structures. Read from bytes they have been built again: where none had been updated, with the same bits.
    pub fn scene(&self) -> &TopLevel {
        &self.scene
    }

    /// The capture as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = HEADER.written();
        out.extend(self.size.map(u32::to_le_bytes).as_flattened());
        let levels = self.scene.bottom_levels();
        out.extend((levels.len() as u32).to_le_bytes());
        levels.iter().for_each(|level| put_slice(&mut out, &level.serialize()));
        put_slice(&mut out, &self.scene.serialize());
        self.ray_generation.put(&mut out);
        for table in [&self.miss, &self.hit_groups, &self.callable] {
            table.put(&mut out);
        }
        out
    }

    /// The capture that bytes are of.
    ///
    /// # Errors
    /// As [`TopLevel::deserialize`] and [`BottomLevel::deserialize`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, LoadError> {
        let mut rest = HEADER.read(bytes)?;
        let size = [rest.u32()?, rest.u32()?, rest.u32()?];
        let levels = rest.list(|rest| BottomLevel::deserialize(rest.counted()?).map(Arc::new))?;
        let scene = TopLevel::deserialize(rest.counted()?, &levels)?;
        let ray_generation = Bytes::read(&mut rest)?;
        let (miss, hit_groups) = (Table::read(&mut rest)?, Table::read(&mut rest)?);
        let callable = Table::read(&mut rest)?;
        rest.end()?;
        Ok(Self { size, scene, ray_generation, miss, hit_groups, callable })
    }
}
