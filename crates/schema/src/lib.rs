#![doc = include_str!("../README.md")]

mod family;
pub mod material;
mod model;
pub mod names;
mod page;
mod parameter;

pub use family::{FAMILIES, Family};
pub use model::{Group, Model};
pub use page::page;
pub use parameter::{Condition, Outside, Parameter, Type};
