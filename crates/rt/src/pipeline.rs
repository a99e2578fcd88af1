//! Pipelines: shaders by name, linked from libraries (DXR, "State objects"; Vulkan, "Ray Tracing Pipelines", "Pipeline
//! Libraries").

use crate::error::PipelineError;
use crate::group::HitGroup;
use crate::interface::Interface;
use crate::stages::{Callable, Miss, RayGeneration};
use crate::table::{Handle, kind};
use std::collections::HashSet;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicU64, Ordering};

/// Most that a pipeline may declare as recursion depth (`D3D12_RAYTRACING_MAX_DECLARABLE_TRACE_RECURSION_DEPTH`).
pub const MAX_RECURSION_DEPTH: u32 = 31;
/// Largest call depth of callable shaders, over all rays of a launch id. The APIs bound it by the stack alone.
pub const MAX_CALL_DEPTH: u32 = 64;

/// A shader or hit group with its name and the stack that it declares, in bytes.
#[derive(Clone, Debug)]
pub struct Export<S, Z = u32> {
    /// Its name, which is unique among its kind in a pipeline.
    pub name: String,
    /// The shader or hit group.
    pub shader: S,
    /// Bytes of stack that it declares.
    pub stack: Z,
}

impl<S, Z: Default> Export<S, Z> {
    /// An export that declares no stack.
    pub fn new(name: impl Into<String>, shader: S) -> Self {
        Self { name: name.into(), shader, stack: Z::default() }
    }

    /// As it is, but with a stack in bytes.
    #[must_use]
    pub fn with_stack(self, stack: Z) -> Self {
        Self { stack, ..self }
    }
}

/// The stacks of the shaders of a hit group, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HitGroupStack {
    /// Stack of the intersection shader.
    pub intersection: u32,
    /// Stack of the any-hit shader.
    pub any_hit: u32,
    /// Stack of the closest-hit shader.
    pub closest_hit: u32,
}

/// Shaders that are made together: a part of pipelines. All shaders of a kind have one type; where they differ it is a
/// box, such as `Box<dyn HitGroup<I>>`.
#[derive(Clone, Debug)]
pub struct Library<I, R, H, M = (), C = ()> {
    /// Ray-generation shaders.
    pub ray_generation: Vec<Export<R>>,
    /// Hit groups.
    pub hit_groups: Vec<Export<H, HitGroupStack>>,
    /// Miss shaders.
    pub miss: Vec<Export<M>>,
    /// Callable shaders.
    pub callable: Vec<Export<C>>,
    interface: PhantomData<fn() -> I>,
}

impl<I, R, H, M, C> Default for Library<I, R, H, M, C> {
    fn default() -> Self {
        let (ray_generation, hit_groups, miss, callable) = Default::default();
        Self { ray_generation, hit_groups, miss, callable, interface: PhantomData }
    }
}

impl<I: Interface, R: RayGeneration<I>, H: HitGroup<I>, M: Miss<I>, C: Callable<I>> Library<I, R, H, M, C> {
    /// A library without shaders.
    pub fn new() -> Self {
        Self::default()
    }

    /// As it is, but with another ray-generation shader.
    #[must_use]
    pub fn with_ray_generation(mut self, export: Export<R>) -> Self {
        self.ray_generation.push(export);
        self
    }

    /// As it is, but with another hit group.
    #[must_use]
    pub fn with_hit_group(mut self, export: Export<H, HitGroupStack>) -> Self {
        self.hit_groups.push(export);
        self
    }

    /// As it is, but with another miss shader.
    #[must_use]
    pub fn with_miss(mut self, export: Export<M>) -> Self {
        self.miss.push(export);
        self
    }

    /// As it is, but with another callable shader.
    #[must_use]
    pub fn with_callable(mut self, export: Export<C>) -> Self {
        self.callable.push(export);
        self
    }
}

/// Configuration of a pipeline (DXR, "D3D12_RAYTRACING_PIPELINE_CONFIG", "Pipeline stack").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PipelineConfig {
    /// Maximum recursion depth of rays: 0 for no rays, 1 for those of ray generation, at most [`MAX_RECURSION_DEPTH`].
    pub max_recursion_depth: u32,
    /// Bytes of stack for each launch id; `None` for [`Pipeline::default_stack_size`].
    pub stack_size: Option<u64>,
}

impl Default for PipelineConfig {
    fn default() -> Self {
        Self { max_recursion_depth: 1, stack_size: None }
    }
}

/// Shaders that can be launched.
#[derive(Debug)]
pub struct Pipeline<I, R, H, M = (), C = ()> {
    pub(crate) library: Library<I, R, H, M, C>,
    pub(crate) config: PipelineConfig,
    pub(crate) stack_size: u64,
    pub(crate) number: u64,
}

/// Numbers of pipelines, by which handles of one are told from those of others.
static NEXT: AtomicU64 = AtomicU64::new(0);

impl<I: Interface, R: RayGeneration<I>, H: HitGroup<I>, M: Miss<I>, C: Callable<I>> Pipeline<I, R, H, M, C> {
    /// Links libraries to a pipeline: it has all their exports.
    ///
    /// # Errors
    /// Two exports of one kind with one name; a recursion depth above [`MAX_RECURSION_DEPTH`].
    pub fn link(
        libraries: impl IntoIterator<Item = Library<I, R, H, M, C>>,
        config: PipelineConfig,
    ) -> Result<Self, PipelineError> {
        let (declared, limit) = (config.max_recursion_depth, MAX_RECURSION_DEPTH);
        if declared > limit {
            return Err(PipelineError::RecursionDepth { declared, limit });
        }
        let mut all = Library::default();
        for library in libraries {
            all.ray_generation.extend(library.ray_generation);
            all.hit_groups.extend(library.hit_groups);
            all.miss.extend(library.miss);
            all.callable.extend(library.callable);
        }
        unique("ray-generation shader", &all.ray_generation)?;
        unique("hit group", &all.hit_groups)?;
        unique("miss shader", &all.miss)?;
        unique("callable shader", &all.callable)?;
        let mut pipeline = Self { library: all, config, stack_size: 0, number: NEXT.fetch_add(1, Ordering::Relaxed) };
        pipeline.stack_size = config.stack_size.unwrap_or_else(|| pipeline.default_stack_size());
        Ok(pipeline)
    }

    /// The formula of the API over the declared sizes, in bytes (DXR, "Default pipeline stack size"): the worst shaders
    /// of each kind to the declared depth, and two calls of the worst callable shader.
    pub fn default_stack_size(&self) -> u64 {
        let Library { ray_generation, hit_groups, miss, callable, .. } = &self.library;
        let of_groups = |size: fn(&HitGroupStack) -> u32| {
            u64::from(hit_groups.iter().map(|export| size(&export.stack)).max().unwrap_or(0))
        };
        let closest = of_groups(|stack| stack.closest_hit).max(greatest(miss));
        let search = of_groups(|stack| stack.intersection) + of_groups(|stack| stack.any_hit);
        let depth = u64::from(self.config.max_recursion_depth);
        greatest(ray_generation)
            + closest.max(search) * depth.min(1)
            + closest * depth.saturating_sub(1)
            + 2 * greatest(callable)
    }

    /// Bytes of stack for each launch id.
    pub fn stack_size(&self) -> u64 {
        self.stack_size
    }

    /// Maximum recursion depth of rays.
    pub fn max_recursion_depth(&self) -> u32 {
        self.config.max_recursion_depth
    }

    /// The handle of a ray-generation shader.
    pub fn ray_generation(&self, name: &str) -> Option<Handle<kind::RayGeneration>> {
        find(self.number, &self.library.ray_generation, name)
    }

    /// The handle of a hit group.
    pub fn hit_group(&self, name: &str) -> Option<Handle<kind::HitGroup>> {
        find(self.number, &self.library.hit_groups, name)
    }

    /// The handle of a miss shader.
    pub fn miss(&self, name: &str) -> Option<Handle<kind::Miss>> {
        find(self.number, &self.library.miss, name)
    }

    /// The handle of a callable shader.
    pub fn callable(&self, name: &str) -> Option<Handle<kind::Callable>> {
        find(self.number, &self.library.callable, name)
    }
}

fn find<K, S, Z>(pipeline: u64, exports: &[Export<S, Z>], name: &str) -> Option<Handle<K>> {
    exports.iter().position(|export| export.name == name).map(|index| Handle::new(pipeline, index))
}

fn greatest<S>(exports: &[Export<S>]) -> u64 {
    exports.iter().map(|export| export.stack.into()).max().unwrap_or(0)
}

fn unique<S, Z>(kind: &'static str, exports: &[Export<S, Z>]) -> Result<(), PipelineError> {
    let mut names = HashSet::new();
    match exports.iter().find(|export| !names.insert(&export.name)) {
        None => Ok(()),
        Some(export) => Err(PipelineError::DuplicateName { kind, name: export.name.clone() }),
    }
}
