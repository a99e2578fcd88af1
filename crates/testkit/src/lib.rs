//! Statistics for tests: does a sample follow a density, is a mean what it should be; and the files that they read.

mod assets;
mod chi2;
mod nanovdb;
mod sphere;
mod z;

pub use assets::asset;
pub use chi2::{Chi2, chi2_test, chi2_test_within, sidak};
pub use nanovdb::nanovdb;
pub use sphere::{SphereGrid, integrate_sphere};
pub use z::{Moments, normal_two_sided_p, z_test};
