//! The scene as it is rendered: [`compile`](compile::compile) turns a description into an immutable [`Scene`](scene::Scene).

pub mod bsdf;
