//! Loops over columns of numbers, compiled for each instruction set.
//!
//! A [`Kernel`] is a loop of plain arithmetic. Compiled where an instruction set is enabled, it becomes code for that
//! set's registers; as no operation is reordered or fused, every set gives the same bits.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::Isa;

/// Code compiled for each instruction set. [`Kernel::run`] and all that it calls must be `#[inline(always)]`, since a
/// function of its own is compiled for the baseline.
pub trait Kernel {
    /// Does it.
    fn run(self);
}

/// An instruction set that this machine has, to run kernels with.
#[derive(Clone, Copy, Debug)]
pub struct Lanes(Isa);

impl Lanes {
    /// The widest.
    pub fn best() -> Self {
        Self(Isa::best())
    }

    /// Lanes of a level, or of the baseline if this machine lacks it.
    pub fn of(isa: Isa) -> Self {
        Self(if isa.is_supported() { isa } else { Isa::Baseline })
    }

    /// Runs a kernel.
    #[inline]
    pub fn run(self, kernel: impl Kernel) {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the value is of an instruction set that this machine has.
        unsafe {
            match self.0 {
                Isa::Baseline => kernel.run(),
                Isa::Avx2 => avx2(kernel),
                Isa::Avx512 => avx512(kernel),
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        kernel.run();
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,popcnt")]
fn avx2(kernel: impl Kernel) {
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2,bmi1,bmi2,popcnt")]
fn avx512(kernel: impl Kernel) {
    kernel.run();
}

/// A function over columns as a kernel: `kernel! { fn name(arguments) { body } }`. References among the arguments have
/// the lifetime `'a`. Columns that are read and written are fields of one argument, so that the compiler sees that they
/// do not overlap.
#[macro_export]
macro_rules! kernel {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident($($argument:ident: $ty:ty),* $(,)?) $body:block) => {
        $(#[$doc])*
        $visibility fn $name<'a>(lanes: $crate::Lanes, $($argument: $ty),*) {
            struct Body<'a> {
                $($argument: $ty,)*
                lifetime: std::marker::PhantomData<&'a ()>,
            }
            impl<'a> $crate::Kernel for Body<'a> {
                #[inline(always)]
                fn run(self) {
                    let Self { $($argument,)* .. } = self;
                    $body
                }
            }
            lanes.run(Body { $($argument,)* lifetime: std::marker::PhantomData });
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    kernel! {
        fn roots(of: &'a mut [f32; 64]) {
            for x in of {
                *x = x.sqrt() + 1.0 / *x;
            }
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let numbers = std::array::from_fn(|k| 0.3 + 1.7 * k as f32);
        let expected = numbers.map(|x: f32| (x.sqrt() + 1.0 / x).to_bits());
        for isa in Isa::ALL {
            let mut found = numbers;
            roots(Lanes::of(isa), &mut found);
            assert_eq!(found.map(f32::to_bits), expected, "{isa:?}");
        }
    }
}
