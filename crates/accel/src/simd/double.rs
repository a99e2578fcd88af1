//! Two rows of lanes as one: two chains of operations, of which neither waits for the other.

use super::{COLUMNS, Lanes, Wide};
use std::array::from_fn;

/// Twice the lanes of a level.
#[derive(Clone, Copy)]
pub(crate) struct DoubleLanes<L>(pub L);

/// Operations on numbers, for either half.
macro_rules! numbers {
    ($($name:ident($($arg:ident),*))*) => {$(
        #[inline(always)]
        fn $name(self, $($arg: Self::F),*) -> Self::F {
            [self.0.$name($($arg[0]),*), self.0.$name($($arg[1]),*)]
        }
    )*};
}

/// Operations on two numbers or truth values that give truth values, for either half.
macro_rules! truths {
    ($of:ident: $($name:ident)*) => {$(
        #[inline(always)]
        fn $name(self, a: Self::$of, b: Self::$of) -> Self::M {
            [self.0.$name(a[0], b[0]), self.0.$name(a[1], b[1])]
        }
    )*};
}

impl<L: Lanes> Lanes for DoubleLanes<L> {
    const COUNT: usize = 2 * L::COUNT;
    type Half = L;
    type F = [L::F; 2];
    type M = [L::M; 2];

    numbers! { add(a, b) sub(a, b) mul(a, b) mul_add(a, b, c) div(a, b) min(a, b) max(a, b) nearer(a, b) farther(a, b) }
    truths! { F: le lt eq }
    truths! { M: and or }

    #[inline(always)]
    fn half(self) -> L {
        self.0
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [self.0.splat(x); 2]
    }
    #[inline(always)]
    fn bits(self, m: Self::M) -> u32 {
        self.0.bits(m[0]) | self.0.bits(m[1]) << L::COUNT
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        [self.0.mask(bits), self.0.mask(bits >> L::COUNT)]
    }
    #[inline(always)]
    fn least(self, a: Self::F) -> f32 {
        self.0.least(self.0.min(a[0], a[1]))
    }
    #[inline(always)]
    fn greatest(self, a: Self::F) -> f32 {
        self.0.greatest(self.0.max(a[0], a[1]))
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        [self.0.select(m[0], a[0], b[0]), self.0.select(m[1], a[1], b[1])]
    }
    #[inline(always)]
    fn read_from(self, wide: &Wide, first: usize) -> Self::F {
        [self.0.read_from(wide, first), self.0.read_from(wide, first + L::COUNT)]
    }
    #[inline(always)]
    fn write_from(self, a: Self::F, wide: &mut Wide, first: usize) {
        self.0.write_from(a[0], wide, first);
        self.0.write_from(a[1], wide, first + L::COUNT);
    }
    #[inline(always)]
    fn columns(self, rows: &[[f32; COLUMNS]]) -> [Self::F; COLUMNS] {
        let (first, second) = rows.split_at(L::COUNT);
        let (first, second) = (self.0.columns(first), self.0.columns(second));
        from_fn(|column| [first[column], second[column]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::portable::Portable;

    #[test]
    fn lanes_of_one_half_are_found() {
        let double = DoubleLanes(Portable);
        let halves = [0x0001, 0x00ff, 0x0100, 0xff00, 0x0180, 0xffff].map(|lanes| double.half_of(lanes));
        assert_eq!(halves, [Some(0), Some(0), Some(8), Some(8), None, None]);
        assert_eq!(Portable.half_of(0x0f), None, "one register has no halves");
    }
}
