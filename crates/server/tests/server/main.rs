//! The server as browsers meet it, and as those meet it who want something else.

mod client;
mod denoising;
mod focus;
mod groups;
mod intruders;
mod load;
mod path;
mod pictures;
mod reference;
mod scenes;
mod session;
mod tones;
