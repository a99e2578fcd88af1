//! First-order regression against what is known of it by other means.

mod halves;
mod hostile;
mod means;
mod noise;
mod scene;
mod sequence;
mod surfaces;
