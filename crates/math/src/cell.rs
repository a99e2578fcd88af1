//! Places in tables with even steps.

/// The cell `[i, i + 1]` of a table that holds `x`, and the place in it, `x = i + t`. There are `cells` of them, at
/// most 2²², and the first and the last go on beyond the table. A whole number is at the end of one cell or at the
/// beginning of the next. No number is converted, which would take longer than all the rest.
#[inline(always)]
pub fn cell(x: f32, cells: usize) -> (usize, f32) {
    // Added and taken away again, this rounds to an integer, which the low bits of the sum hold.
    const ROUND: f32 = 12_582_912.0;
    let shifted = (x - 0.5).clamp(0.0, (cells - 1) as f32) + ROUND;
    ((shifted.to_bits() & 0x3f_ffff) as usize, x - (shifted - ROUND))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_in_its_cell() {
        for i in -100..=1100 {
            let x = i as f32 * 0.01;
            let (cell, t) = cell(x, 10);
            assert_eq!(cell as f32 + t, x);
            assert!(cell < 10 && ((0.0..=1.0).contains(&t) || !(0.0..=10.0).contains(&x)), "{x} is in {cell} at {t}");
        }
        assert_eq!(cell(f32::NAN, 10).0, 0);
        assert_eq!(cell(f32::INFINITY, 10).0, 9);
        assert_eq!(cell(0.7, 1).0, 0);
    }
}
