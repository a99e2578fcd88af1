#![doc = include_str!("../README.md")]

pub mod camera;
mod family;
pub mod film;
pub mod integrator;
mod kinds;
pub mod light;
pub mod material;
pub mod medium;
mod model;
pub mod names;
mod option_value;
mod page;
mod parameter;
pub mod shape;
pub mod texture;

pub use family::{FAMILIES, Family};
pub use kinds::{Kinds, Taken};
pub use model::{Group, Model};
pub use option_value::OptionValue;
pub use page::page;
pub use parameter::{Condition, Outside, Parameter, Type};
