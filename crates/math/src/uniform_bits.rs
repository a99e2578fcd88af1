//! Decisions by uniform numbers.

/// A uniform number or a probability in `[0, 1]` by its bits, which are ordered as the numbers are. A branch that
/// chance decides is often mispredicted; compared as integers it is known to be so at once, and not only when the
/// arithmetic before it is done.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Chance(u32);

impl From<f32> for Chance {
    #[inline(always)]
    fn from(number: f32) -> Self {
        Self(number.to_bits())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_are_ordered_as_numbers_are() {
        let increasing = [0.0, f32::MIN_POSITIVE, 0.3, 0.300_000_1, 0.999_999_9, 1.0].map(Chance::from);
        assert!(increasing.is_sorted_by(|a, b| a < b));
    }
}
