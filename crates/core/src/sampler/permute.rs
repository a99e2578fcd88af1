//! Random permutations of `0..n`, evaluated at one place.

/// A random permutation of `0..n`, evaluated at `i < n` (Kensler 2013, "Correlated Multi-Jittered Sampling").
pub(super) fn permute(mut i: u32, n: u32, p: u32) -> u32 {
    let w = n.next_power_of_two().wrapping_sub(1);
    // Hash within the next power of two and walk the cycle until the result is in range.
    loop {
        i ^= p;
        i = i.wrapping_mul(0xe170_893d);
        i ^= p >> 16;
        i ^= (i & w) >> 4;
        i ^= p >> 8;
        i = i.wrapping_mul(0x0929_eb3f);
        i ^= p >> 23;
        i ^= (i & w) >> 1;
        i = i.wrapping_mul(1 | p >> 27);
        i = i.wrapping_mul(0x6935_fa69);
        i ^= (i & w) >> 11;
        i = i.wrapping_mul(0x74dc_b303);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0x9e50_1cc3);
        i ^= (i & w) >> 2;
        i = i.wrapping_mul(0xc860_a3df);
        i &= w;
        i ^= i >> 5;
        if i < n {
            return (i.wrapping_add(p)) % n;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::permute;

    #[test]
    fn permutations_are_bijective() {
        for n in [1, 2, 3, 7, 64, 100] {
            let mut seen = vec![false; n as usize];
            (0..n).for_each(|i| seen[permute(i, n, 0x1234_5678) as usize] = true);
            assert!(seen.iter().all(|&s| s));
        }
    }
}
