//! Shader stages: traits, one for each stage, whose contexts offer what is legal there and nothing else.

use crate::context::{
    AnyHitContext, CallableContext, ClosestHitContext, IntersectionContext, MissContext, RayGenerationContext,
};
use crate::decision::{Decision, EndSearch, Verdict};
use crate::error::Fault;
use crate::interface::Interface;
use std::ops::ControlFlow;

/// Runs once for each launch id: traces the first rays and makes the output (DXR, "Ray generation shaders").
pub trait RayGeneration<I: Interface>: Sync {
    /// Runs the shader.
    ///
    /// # Errors
    /// What calls in it have given; it ends the launch.
    fn run(&self, context: &mut RayGenerationContext<I>) -> Result<I::Output, Fault>;
}

/// Finds hits on a procedural primitive (DXR, "Intersection shaders").
pub trait Intersection<I: Interface>: Sync {
    /// True if there is a shader; only `()` has none.
    #[inline]
    fn is_present(&self) -> bool {
        true
    }

    /// Runs the shader. `report_hit(…)?` ends it where the search is over.
    fn run(&self, context: &mut IntersectionContext<I>) -> ControlFlow<EndSearch>;
}

/// Says whether a hit that is not opaque counts (DXR, "Any hit shaders"). `A` is [`Barycentrics`](crate::Barycentrics)
/// for triangles, else [`Interface::Attributes`].
pub trait AnyHit<I: Interface, A>: Sync {
    /// True if there is a shader; only `()` has none.
    #[inline]
    fn is_present(&self) -> bool {
        true
    }

    /// Runs the shader. The payload keeps what was written to it whatever the decision.
    fn run(&self, context: &AnyHitContext<I>, payload: &mut I::Payload, attributes: &A) -> Decision;
}

/// Runs on the closest hit (DXR, "Closest hit shaders").
pub trait ClosestHit<I: Interface, A>: Sync {
    /// True if there is a shader; only `()` has none.
    #[inline]
    fn is_present(&self) -> bool {
        true
    }

    /// Runs the shader.
    ///
    /// # Errors
    /// What calls in it have given; it ends the launch.
    fn run(&self, context: &mut ClosestHitContext<I>, payload: &mut I::Payload, attributes: &A) -> Result<(), Fault>;
}

/// Runs where nothing was hit (DXR, "Miss shaders").
pub trait Miss<I: Interface>: Sync {
    /// Runs the shader.
    ///
    /// # Errors
    /// What calls in it have given; it ends the launch.
    fn run(&self, context: &mut MissContext<I>, payload: &mut I::Payload) -> Result<(), Fault>;
}

/// Runs where it is called (DXR, "Callable shaders").
pub trait Callable<I: Interface>: Sync {
    /// Runs the shader.
    ///
    /// # Errors
    /// What calls in it have given; it ends the launch.
    fn run(&self, context: &mut CallableContext<I>, parameter: &mut I::Parameter) -> Result<(), Fault>;
}

/// No intersection shader.
impl<I: Interface> Intersection<I> for () {
    #[inline]
    fn is_present(&self) -> bool {
        false
    }

    #[inline]
    fn run(&self, _: &mut IntersectionContext<I>) -> ControlFlow<EndSearch> {
        ControlFlow::Continue(())
    }
}

/// No any-hit shader: all hits count.
impl<I: Interface, A> AnyHit<I, A> for () {
    #[inline]
    fn is_present(&self) -> bool {
        false
    }

    #[inline]
    fn run(&self, _: &AnyHitContext<I>, _: &mut I::Payload, _: &A) -> Decision {
        Decision(Verdict::Accept)
    }
}

/// No closest-hit shader.
impl<I: Interface, A> ClosestHit<I, A> for () {
    #[inline]
    fn is_present(&self) -> bool {
        false
    }

    #[inline]
    fn run(&self, _: &mut ClosestHitContext<I>, _: &mut I::Payload, _: &A) -> Result<(), Fault> {
        Ok(())
    }
}

/// No miss shaders in the pipeline.
impl<I: Interface> Miss<I> for () {
    #[inline]
    fn run(&self, _: &mut MissContext<I>, _: &mut I::Payload) -> Result<(), Fault> {
        Ok(())
    }
}

/// No callable shaders in the pipeline.
impl<I: Interface> Callable<I> for () {
    #[inline]
    fn run(&self, _: &mut CallableContext<I>, _: &mut I::Parameter) -> Result<(), Fault> {
        Ok(())
    }
}

/// Shaders of several types in one pipeline.
macro_rules! boxed {
    ($($trait:ident [$($generic:ident),*] ($($arg:ident: $ty:ty),*) -> $out:ty $(, $present:ident)?;)*) => {$(
        impl<$($generic,)* T: $trait<$($generic),*> + ?Sized> $trait<$($generic),*> for Box<T>
        where
            I: Interface,
        {
            $(#[inline]
            fn $present(&self) -> bool {
                (**self).$present()
            })?

            #[inline]
            fn run(&self, $($arg: $ty),*) -> $out {
                (**self).run($($arg),*)
            }
        }
    )*};
}

boxed! {
    RayGeneration[I](context: &mut RayGenerationContext<I>) -> Result<I::Output, Fault>;
    Intersection[I](context: &mut IntersectionContext<I>) -> ControlFlow<EndSearch>, is_present;
    AnyHit[I, A](context: &AnyHitContext<I>, payload: &mut I::Payload, attributes: &A) -> Decision, is_present;
    ClosestHit[I, A](context: &mut ClosestHitContext<I>, payload: &mut I::Payload, attributes: &A)
        -> Result<(), Fault>, is_present;
    Miss[I](context: &mut MissContext<I>, payload: &mut I::Payload) -> Result<(), Fault>;
    Callable[I](context: &mut CallableContext<I>, parameter: &mut I::Parameter) -> Result<(), Fault>;
}
