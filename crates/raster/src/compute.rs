//! Compute: work groups of invocations with memory in common and barriers.

use rayon::prelude::*;

use crate::error::{Result, refuse};

/// Which invocation this is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Invocation {
    /// Its number in its group, in x, y and z.
    pub local: [u32; 3],
    /// The number of its group.
    pub group: [u32; 3],
    /// Its number in the dispatch.
    pub global: [u32; 3],
    /// Its place in its group, x fastest.
    pub index: u32,
}

/// A kernel. Between two phases all invocations of a group meet (GLSL: `barrier()`); what one needs from before is in
/// its `Private`. Groups run on all threads at once: what they share beyond their own memory goes through atomics,
/// which are fields of the shader.
pub trait ComputeShader: Sync {
    /// Memory of a group, as it is at its start.
    type Shared: Default;
    /// Memory of an invocation that lasts from phase to phase.
    type Private: Default + Clone;
    /// Invocations of a group in x, y and z; at most 1024 in all.
    const LOCAL_SIZE: [u32; 3];
    /// Number of phases.
    const PHASES: u32 = 1;
    /// Runs one invocation of a phase. The invocations of a group run one after the other, in the order of their index.
    fn shade(&self, phase: u32, invocation: Invocation, private: &mut Self::Private, shared: &mut Self::Shared);
}

/// The most groups in each dimension.
const MAX_GROUPS: u32 = 65535;

/// Runs a kernel in so many groups.
///
/// # Errors
/// Where groups or invocations are more than there may be.
pub fn dispatch<S: ComputeShader>(shader: &S, groups: [u32; 3]) -> Result<()> {
    const CALL: &str = "dispatch";
    if groups.iter().any(|&n| n > MAX_GROUPS) {
        return refuse(CALL, format!("{groups:?} groups; at most {MAX_GROUPS} in each dimension"));
    }
    let [x, y, z] = S::LOCAL_SIZE;
    let size = u64::from(x) * u64::from(y) * u64::from(z);
    if size == 0 || size > 1024 {
        return refuse(CALL, format!("groups of {x} × {y} × {z} invocations; from 1 to 1024"));
    }
    let [gx, gy, gz] = groups.map(u64::from);
    (0..gx * gy * gz).into_par_iter().for_each(|number| {
        let group = [number % gx, number / gx % gy, number / gx / gy].map(|i| i as u32);
        let mut shared = S::Shared::default();
        run_group(S::LOCAL_SIZE, S::PHASES, group, |phase, invocation, private| {
            shader.shade(phase, invocation, private, &mut shared);
        });
    });
    Ok(())
}

/// Runs the phases of one group: in each all invocations, one after the other.
pub(crate) fn run_group<P: Default + Clone>(
    [x, y, z]: [u32; 3],
    phases: u32,
    group: [u32; 3],
    mut shade: impl FnMut(u32, Invocation, &mut P),
) {
    let mut private = vec![P::default(); (x * y * z) as usize];
    for phase in 0..phases {
        for (index, private) in private.iter_mut().enumerate() {
            let index = index as u32;
            let local = [index % x, index / x % y, index / x / y];
            let global = std::array::from_fn(|d| group[d] * [x, y, z][d] + local[d]);
            shade(phase, Invocation { local, group, global, index }, private);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    /// Inclusive sums over each group (Hillis and Steele 1986): a read and a write phase for each of 8 steps.
    struct Scan<'a> {
        input: &'a [u32],
        output: &'a [AtomicU32],
    }

    #[derive(Clone)]
    struct Sums([u32; 256]);

    impl Default for Sums {
        fn default() -> Self {
            Self([0; 256])
        }
    }

    impl ComputeShader for Scan<'_> {
        type Shared = Sums;
        type Private = u32;
        const LOCAL_SIZE: [u32; 3] = [256, 1, 1];
        const PHASES: u32 = 18;
        fn shade(&self, phase: u32, at: Invocation, sum: &mut u32, shared: &mut Sums) {
            let i = at.index as usize;
            match phase {
                0 => shared.0[i] = self.input[at.global[0] as usize],
                17 => self.output[at.global[0] as usize].store(shared.0[i], Ordering::Relaxed),
                _ if phase % 2 == 1 => {
                    let before = 1 << (phase / 2);
                    *sum = shared.0[i] + if i >= before { shared.0[i - before] } else { 0 };
                }
                _ => shared.0[i] = *sum,
            }
        }
    }

    #[test]
    fn groups_scan_and_meet_at_barriers() {
        let input: Vec<u32> = (0..256 * 40u32).map(|i| i.wrapping_mul(2_654_435_761) >> 24).collect();
        let output: Vec<AtomicU32> = input.iter().map(|_| AtomicU32::new(0)).collect();
        dispatch(&Scan { input: &input, output: &output }, [40, 1, 1]).unwrap();
        for (group, sums) in input.chunks(256).zip(output.chunks(256)) {
            let mut sum = 0;
            for (value, found) in group.iter().zip(sums) {
                sum += value;
                assert_eq!(found.load(Ordering::Relaxed), sum);
            }
        }
    }

    struct Count<'a>(&'a [AtomicU32]);

    impl ComputeShader for Count<'_> {
        type Shared = ();
        type Private = ();
        const LOCAL_SIZE: [u32; 3] = [4, 3, 2];
        fn shade(&self, _: u32, at: Invocation, (): &mut (), (): &mut ()) {
            let [x, y, z] = at.global;
            self.0[(x + 20 * (y + 9 * z)) as usize].fetch_add(1, Ordering::Relaxed);
        }
    }

    #[test]
    fn each_invocation_runs_once() {
        let counts: Vec<AtomicU32> = (0..20 * 9 * 8).map(|_| AtomicU32::new(0)).collect();
        dispatch(&Count(&counts), [5, 3, 4]).unwrap();
        assert!(counts.iter().all(|c| c.load(Ordering::Relaxed) == 1));
        assert!(dispatch(&Count(&counts), [0, 3, 4]).is_ok());
        assert!(dispatch(&Count(&counts), [70000, 1, 1]).unwrap_err().to_string().contains("65535"));
    }
}
