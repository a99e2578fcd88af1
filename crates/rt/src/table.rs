//! Shader tables (DXR, "Shader tables", "Addressing calculations within shader tables"; Vulkan, "Shader Binding
//! Table").

use crate::error::Fault;
use serde::Serialize;
use std::fmt;
use std::marker::PhantomData;

/// Names a shader or hit group of a pipeline; the type says of which kind (DXR, "Shader identifier").
#[derive(Debug)]
pub struct Handle<K> {
    pub(crate) index: u32,
    /// The pipeline that it belongs to.
    pub(crate) pipeline: u64,
    kind: PhantomData<fn() -> K>,
}

impl<K> Handle<K> {
    pub(crate) fn new(pipeline: u64, index: usize) -> Self {
        Self { index: index as u32, pipeline, kind: PhantomData }
    }
}

impl<K> Clone for Handle<K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K> Copy for Handle<K> {}

impl<K> PartialEq for Handle<K> {
    fn eq(&self, other: &Self) -> bool {
        (self.index, self.pipeline) == (other.index, other.pipeline)
    }
}

/// Kinds of tables, as types.
pub mod kind {
    /// Ray-generation shaders.
    #[derive(Clone, Debug)]
    pub enum RayGeneration {}
    /// Hit groups.
    #[derive(Clone, Debug)]
    pub enum HitGroup {}
    /// Miss shaders.
    #[derive(Clone, Debug)]
    pub enum Miss {}
    /// Callable shaders.
    #[derive(Clone, Debug)]
    pub enum Callable {}
}

/// A record: which shader runs, and data that is for it alone.
#[derive(Clone, Debug)]
pub struct Record<K, L> {
    /// The shader or hit group of the record; `None` for a null record, which runs nothing.
    pub handle: Option<Handle<K>>,
    /// Local data, which the shader can read as [`local`](crate::context::MissContext::local).
    pub local: L,
}

impl<K, L> Record<K, L> {
    /// A record of a shader.
    pub fn new(handle: Handle<K>, local: L) -> Self {
        Self { handle: Some(handle), local }
    }

    /// A record that runs nothing.
    pub fn null(local: L) -> Self {
        Self { handle: None, local }
    }
}

/// A table: records in memory, and the region of them that a launch uses. Places are counted in records, where the APIs
/// count in bytes.
#[derive(Clone, Debug)]
pub struct ShaderTable<K, L> {
    /// The memory.
    pub records: Vec<Record<K, L>>,
    /// Index of the first record of the region (`StartAddress`, `deviceAddress`).
    pub base: u32,
    /// Stride between indices, in records (`StrideInBytes`, `stride`). With zero all indices are the same record.
    pub stride: u32,
}

impl<K, L> Default for ShaderTable<K, L> {
    fn default() -> Self {
        Self::new(Vec::new())
    }
}

impl<K, L> ShaderTable<K, L> {
    /// A table whose indices are those of the records.
    pub fn new(records: Vec<Record<K, L>>) -> Self {
        Self { records, base: 0, stride: 1 }
    }

    /// As it is, but with another region.
    #[must_use]
    pub fn with_region(self, base: u32, stride: u32) -> Self {
        Self { base, stride, ..self }
    }

    /// `base + stride · index`.
    #[inline]
    fn place(&self, index: u64) -> u64 {
        u64::from(self.base) + u64::from(self.stride) * index
    }

    /// The record at an index, or the index of the place that does not exist.
    #[inline]
    fn record(&self, index: u64) -> Result<&Record<K, L>, u64> {
        let place = self.place(index);
        usize::try_from(place).ok().and_then(|place| self.records.get(place)).ok_or(place)
    }
}

/// Contributions to the index of a hit-group record, of `trace`, geometry and instance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct HitIndex {
    pub ray_contribution: u32,
    pub geometry_multiplier: u32,
    pub geometry: u32,
    pub instance_offset: u32,
}

impl HitIndex {
    /// `ray contribution + geometry multiplier · geometry index + instance offset`.
    #[inline]
    fn index(&self) -> u64 {
        u64::from(self.ray_contribution & 0xf)
            + u64::from(self.geometry_multiplier & 0xf) * u64::from(self.geometry)
            + u64::from(self.instance_offset)
    }
}

/// Terms of a shader table's indexing formula, and the resulting record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "table", rename_all = "snake_case")]
#[expect(missing_docs, reason = "names say what they are")]
pub enum Place {
    /// `place = base + stride · (ray contribution + geometry multiplier · geometry index + instance offset)`.
    HitGroup {
        place: u64,
        base: u32,
        stride: u32,
        ray_contribution: u32,
        geometry_multiplier: u32,
        geometry: u32,
        instance_offset: u32,
    },
    /// `place = base + stride · index`.
    Miss { place: u64, base: u32, stride: u32, index: u32 },
    /// `place = base + stride · index`.
    Callable { place: u64, base: u32, stride: u32, index: u32 },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::HitGroup {
                place,
                base,
                stride,
                ray_contribution,
                geometry_multiplier,
                geometry,
                instance_offset,
            } => {
                let sum = format_args!("{ray_contribution} + {geometry_multiplier} * {geometry} + {instance_offset}");
                write!(f, "hit-group record {place} = {base} + {stride} * ({sum})")
            }
            Self::Miss { place, base, stride, index } => write!(f, "miss record {place} = {base} + {stride} * {index}"),
            Self::Callable { place, base, stride, index } => {
                write!(f, "callable record {place} = {base} + {stride} * {index}")
            }
        }
    }
}

impl<K, L> ShaderTable<K, L> {
    /// `base + stride · (ray contribution + geometry multiplier · geometry index + instance offset)`; only the low 4
    /// bits of contribution and multiplier count.
    #[inline]
    pub(crate) fn hit_group(&self, of: HitIndex) -> Result<&Record<K, L>, Fault> {
        self.record(of.index()).map_err(|place| self.no_hit_group(of, place))
    }

    #[cold]
    fn no_hit_group(&self, of: HitIndex, place: u64) -> Fault {
        Fault::HitGroupRecord {
            base: self.base,
            stride: self.stride,
            ray_contribution: of.ray_contribution & 0xf,
            geometry_multiplier: of.geometry_multiplier & 0xf,
            geometry: of.geometry,
            instance_offset: of.instance_offset,
            place,
            records: self.records.len(),
        }
    }

    /// `base + stride · index`; only the low 16 bits of the index count.
    #[inline]
    pub(crate) fn miss(&self, index: u32) -> Result<&Record<K, L>, Fault> {
        self.plain("miss", index & 0xffff)
    }

    /// `base + stride · index`.
    #[inline]
    pub(crate) fn callable(&self, index: u32) -> Result<&Record<K, L>, Fault> {
        self.plain("callable", index)
    }

    /// Indexing of a hit-group record.
    pub(crate) fn hit_group_place(&self, of: HitIndex) -> Place {
        let HitIndex { geometry, instance_offset, .. } = of;
        let (ray_contribution, geometry_multiplier) = (of.ray_contribution & 0xf, of.geometry_multiplier & 0xf);
        let (base, stride) = (self.base, self.stride);
        Place::HitGroup {
            place: self.place(of.index()),
            base,
            stride,
            ray_contribution,
            geometry_multiplier,
            geometry,
            instance_offset,
        }
    }

    /// Indexing of a miss record.
    pub(crate) fn miss_place(&self, index: u32) -> Place {
        let index = index & 0xffff;
        Place::Miss { place: self.place(index.into()), base: self.base, stride: self.stride, index }
    }

    /// Indexing of a callable record.
    pub(crate) fn callable_place(&self, index: u32) -> Place {
        Place::Callable { place: self.place(index.into()), base: self.base, stride: self.stride, index }
    }

    #[inline]
    fn plain(&self, table: &'static str, index: u32) -> Result<&Record<K, L>, Fault> {
        self.record(index.into()).map_err(|place| self.no_record(table, index, place))
    }

    #[cold]
    fn no_record(&self, table: &'static str, index: u32, place: u64) -> Fault {
        let records = self.records.len();
        Fault::Record { table, base: self.base, stride: self.stride, index, place, records }
    }
}

/// The tables of a launch (DXR, "D3D12_DISPATCH_RAYS_DESC").
#[derive(Clone, Debug)]
pub struct ShaderTables<L> {
    /// Ray-generation record, run for each launch id.
    pub ray_generation: Record<kind::RayGeneration, L>,
    /// Miss shaders.
    pub miss: ShaderTable<kind::Miss, L>,
    /// Hit groups.
    pub hit_groups: ShaderTable<kind::HitGroup, L>,
    /// Callable shaders.
    pub callable: ShaderTable<kind::Callable, L>,
}

impl<L> ShaderTables<L> {
    /// Tables without records but that of ray generation.
    pub fn new(ray_generation: Record<kind::RayGeneration, L>) -> Self {
        let (miss, hit_groups, callable) = (ShaderTable::default(), ShaderTable::default(), ShaderTable::default());
        Self { ray_generation, miss, hit_groups, callable }
    }

    /// As it is, but with these miss records.
    #[must_use]
    pub fn with_miss(self, miss: ShaderTable<kind::Miss, L>) -> Self {
        Self { miss, ..self }
    }

    /// As it is, but with these records of hit groups.
    #[must_use]
    pub fn with_hit_groups(self, hit_groups: ShaderTable<kind::HitGroup, L>) -> Self {
        Self { hit_groups, ..self }
    }

    /// As it is, but with these callable records.
    #[must_use]
    pub fn with_callable(self, callable: ShaderTable<kind::Callable, L>) -> Self {
        Self { callable, ..self }
    }
}
