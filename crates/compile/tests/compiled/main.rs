//! What compiling descriptions gives: one program, since each takes long to link.

mod bad_values;
mod catalog;
mod colors_agree;
mod emission;
mod light_sampling;
mod one_shape;
mod test_cards;
mod textures;
