//! Real files by others, which lie beside the repository and not in it.

use std::path::{Path, PathBuf};

/// Set where tests must not pass without the assets.
const REQUIRED: &str = "STERADIAN_REQUIRE_ASSETS";

/// A file or folder of the assets; `None`, with a word about it, where it is not there.
///
/// # Panics
/// Where it is not there and the environment says that it must be (`STERADIAN_REQUIRE_ASSETS`).
#[expect(clippy::print_stdout, reason = "says that something was skipped")]
pub fn asset(name: &str) -> Option<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/assets")).join(name);
    if path.exists() {
        return Some(path);
    }
    assert!(std::env::var_os(REQUIRED).is_none(), "{} is not there, and {REQUIRED} is set", path.display());
    println!("skipped: {name} of the assets is not here");
    None
}
