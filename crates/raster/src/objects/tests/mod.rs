//! Scripted traces of calls.

mod blits;
mod buffers;
mod commands;
mod draws;
mod framebuffers;
mod names;
mod pixels;
mod queries;
mod samplers;
mod shaders;
mod textures;

use super::{Context, ShareGroup};
use crate::{Extent, Format, Framebuffer, Result};

/// A context of a group with a framebuffer of 64² pixels.
fn context_of(group: &ShareGroup) -> Context {
    Context::new(group, Framebuffer::with_color_and_depth(Extent::new(64, 64), Format::Rgba8Unorm).unwrap())
}

fn context() -> Context {
    context_of(&ShareGroup::new())
}

/// Asserts that a call is refused under its name, by a rule and a code that contain these words.
#[track_caller]
fn assert_refused<T: std::fmt::Debug>(result: Result<T>, call: &str, words: [&str; 2]) {
    let error = result.expect_err(call);
    assert_eq!(error.call, call);
    assert!(words.iter().all(|word| error.rule.contains(word)), "{error} lacks one of {words:?}");
}
