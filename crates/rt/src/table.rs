//! Shader tables (DXR, "Shader tables", "Addressing calculations within shader tables"; Vulkan, "Shader Binding Table").

use crate::error::Fault;
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
    /// What runs; nothing where it is null.
    pub handle: Option<Handle<K>>,
    /// What the shader can read as [`local`](crate::context::MissContext::local).
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
    /// Where the region begins (`StartAddress`, `deviceAddress`).
    pub base: u32,
    /// How far indices are apart (`StrideInBytes`, `stride`). With zero all indices are the same record.
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

    /// The same with another region.
    #[must_use]
    pub fn with_region(self, base: u32, stride: u32) -> Self {
        Self { base, stride, ..self }
    }

    /// The record at an index, or the index of the place that does not exist.
    fn record(&self, index: u64) -> Result<&Record<K, L>, u64> {
        let place = u64::from(self.base) + u64::from(self.stride) * index;
        usize::try_from(place).ok().and_then(|place| self.records.get(place)).ok_or(place)
    }
}

/// What a call of `trace` adds to the index of hit-group records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct HitIndex {
    pub ray_contribution: u32,
    pub geometry_multiplier: u32,
    pub geometry: u32,
    pub instance_offset: u32,
}

impl<K, L> ShaderTable<K, L> {
    /// `base + stride · (ray contribution + geometry multiplier · geometry index + instance offset)`; only the low 4
    /// bits of contribution and multiplier count.
    pub(crate) fn hit_group(&self, of: HitIndex) -> Result<&Record<K, L>, Fault> {
        let HitIndex { ray_contribution, geometry_multiplier, geometry, instance_offset } = of;
        let (ray_contribution, geometry_multiplier) = (ray_contribution & 0xf, geometry_multiplier & 0xf);
        let index = u64::from(ray_contribution)
            + u64::from(geometry_multiplier) * u64::from(geometry)
            + u64::from(instance_offset);
        self.record(index).map_err(|place| Fault::HitGroupRecord {
            base: self.base,
            stride: self.stride,
            ray_contribution,
            geometry_multiplier,
            geometry,
            instance_offset,
            place,
            records: self.records.len(),
        })
    }

    /// `base + stride · index`; only the low 16 bits of the index count.
    pub(crate) fn miss(&self, index: u32) -> Result<&Record<K, L>, Fault> {
        self.plain("miss", index & 0xffff)
    }

    /// `base + stride · index`.
    pub(crate) fn callable(&self, index: u32) -> Result<&Record<K, L>, Fault> {
        self.plain("callable", index)
    }

    fn plain(&self, table: &'static str, index: u32) -> Result<&Record<K, L>, Fault> {
        self.record(index.into()).map_err(|place| Fault::Record {
            table,
            base: self.base,
            stride: self.stride,
            index,
            place,
            records: self.records.len(),
        })
    }
}

/// The tables of a launch (DXR, "D3D12_DISPATCH_RAYS_DESC").
#[derive(Clone, Debug)]
pub struct ShaderTables<L> {
    /// What runs for each launch id.
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

    /// The same with these miss records.
    #[must_use]
    pub fn with_miss(self, miss: ShaderTable<kind::Miss, L>) -> Self {
        Self { miss, ..self }
    }

    /// The same with these records of hit groups.
    #[must_use]
    pub fn with_hit_groups(self, hit_groups: ShaderTable<kind::HitGroup, L>) -> Self {
        Self { hit_groups, ..self }
    }

    /// The same with these callable records.
    #[must_use]
    pub fn with_callable(self, callable: ShaderTable<kind::Callable, L>) -> Self {
        Self { callable, ..self }
    }
}
