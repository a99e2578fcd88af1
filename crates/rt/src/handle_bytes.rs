//! Handles as bytes (DXR, `GetShaderIdentifier`; Vulkan, `vkGetRayTracingShaderGroupHandlesKHR` and
//! `vkGetRayTracingCaptureReplayShaderGroupHandlesKHR`).

use crate::error::UnknownHandle;
use crate::group::HitGroup;
use crate::interface::Interface;
use crate::pipeline::{Export, Library, Pipeline};
use crate::stages::{Callable, Miss, RayGeneration};
use crate::table::{Handle, kind};
use std::collections::HashMap;
use steradian_math::hash::combine64;

/// Bytes of a handle (`shaderGroupHandleSize`, `D3D12_SHADER_IDENTIFIER_SIZE_IN_BYTES`).
pub const HANDLE_BYTES: usize = 32;

/// Trait of the [kinds](kind) of tables. No other types can be kinds.
pub trait Kind: Exported {}

/// Kinds of what a pipeline has.
pub trait Exported {
    /// Noun of the kind, for messages.
    const NAME: &'static str;
    /// The names of all exports of this kind.
    fn names<I, R, H, M, C>(library: &Library<I, R, H, M, C>) -> Vec<&str>;
}

macro_rules! kinds {
    ($($kind:ident: $name:literal, $field:ident;)*) => {
        $(impl Kind for kind::$kind {}
        impl Exported for kind::$kind {
            const NAME: &'static str = $name;
            fn names<I, R, H, M, C>(library: &Library<I, R, H, M, C>) -> Vec<&str> {
                library.$field.iter().map(|Export { name, .. }| name.as_str()).collect()
            }
        })*
    };
}

kinds! {
    RayGeneration: "ray-generation shader", ray_generation;
    HitGroup: "hit group", hit_groups;
    Miss: "miss shader", miss;
    Callable: "callable shader", callable;
}

impl<I: Interface, R: RayGeneration<I>, H: HitGroup<I>, M: Miss<I>, C: Callable<I>> Pipeline<I, R, H, M, C> {
    /// The opaque bytes of a handle; `None` for one of another pipeline. They depend on the name and the kind of what
    /// it is a handle of: a pipeline that is linked from the same exports has the same ones in every run.
    pub fn handle_bytes<K: Kind>(&self, handle: Handle<K>) -> Option<[u8; HANDLE_BYTES]> {
        let name = *K::names(&self.library).get(handle.index as usize)?;
        (handle.pipeline == self.number).then(|| bytes(K::NAME, name))
    }

    /// The handle that bytes are of, which another run may have captured.
    ///
    /// # Errors
    /// There is none.
    pub fn handle<K: Kind>(&self, captured: &[u8; HANDLE_BYTES]) -> Result<Handle<K>, UnknownHandle> {
        self.handles().get(captured).copied().ok_or(UnknownHandle { kind: K::NAME })
    }

    /// All handles of a kind by their bytes.
    pub(crate) fn handles<K: Kind>(&self) -> HashMap<[u8; HANDLE_BYTES], Handle<K>> {
        let named = |(place, name)| (bytes(K::NAME, name), Handle::new(self.number, place));
        K::names(&self.library).into_iter().enumerate().map(named).collect()
    }
}

/// Four hashes of a kind and a name. None is zero throughout: these are the bytes of a null handle.
fn bytes(kind: &str, name: &str) -> [u8; HANDLE_BYTES] {
    let hash = |seed: u64| {
        let all = kind.bytes().chain([0]).chain(name.bytes());
        all.fold(seed, |hash, byte| combine64(hash, byte.into())).to_le_bytes()
    };
    let mut out = [0; HANDLE_BYTES];
    out.as_chunks_mut().0.iter_mut().zip(1..).for_each(|(part, seed)| *part = hash(seed));
    out
}
