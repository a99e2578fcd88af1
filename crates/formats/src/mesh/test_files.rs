//! Files for the tests of the readers.

use std::path::PathBuf;
use steradian_math::hash::HashRng;

/// The folder of shared test files; says so where it is absent.
pub(crate) fn assets() -> Option<PathBuf> {
    steradian_testkit::asset("")
}

/// Calls `check` with damaged copies of a file: bytes changed, runs removed, runs repeated.
pub(crate) fn mutants(seed: &[u8], count: usize, mut check: impl FnMut(&[u8])) {
    let mut rng = HashRng::new(seed.len() as u64);
    let mut below = move |n: usize| (rng.next_u64() % n.max(1) as u64) as usize;
    for _ in 0..count {
        let mut bytes = seed.to_vec();
        for _ in 0..=below(4) {
            let at = below(bytes.len());
            match below(6) {
                0 => {
                    let end = (at + below(8)).min(bytes.len());
                    bytes.drain(at..end);
                }
                1 => {
                    let end = (at + below(64)).min(bytes.len());
                    let run = bytes[at..end].to_vec();
                    bytes.splice(at..at, run);
                }
                2 => {
                    const NASTY: [u8; 12] = *b"\n -09/e.\0\xffn\\";
                    if let Some(b) = bytes.get_mut(at) {
                        *b = NASTY[below(NASTY.len())];
                    }
                }
                _ => {
                    if let Some(b) = bytes.get_mut(at) {
                        *b = below(256) as u8;
                    }
                }
            }
        }
        check(&bytes);
    }
}
