//! Pictures against references: of other sizes, and with noise of their own.

mod noise;
mod reference;

pub use noise::Noise;
pub use reference::Reference;
