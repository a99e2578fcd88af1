use super::*;
use crate::Vec2;
use crate::chi_square::{assert_fits, random_2d};
use crate::hash::{HashRng, ONE_MINUS_EPSILON};

/// Values of every kind: zeros at the ends and inside, a spike, tiny ones.
fn mixed(n: usize) -> Vec<f32> {
    let mut rng = HashRng::new(n as u64);
    (0..n)
        .map(|i| match (i + 1) % 7 {
            0 | 1 => 0.0,
            2 => 40.0 * rng.next_f32(),
            3 => -rng.next_f32(),
            _ => rng.next_f32(),
        })
        .collect()
}

#[test]
fn samples_in_one_dimension_follow_the_density() {
    for n in [12, 100, 1003] {
        let values = mixed(n);
        let d = Piecewise1D::new(&values);
        let total: f64 = values.iter().map(|v| f64::from(v.abs())).sum();
        assert!((f64::from(d.integral()) * n as f64 / total - 1.0).abs() < 1e-6);
        let (mut rng, mut counts) = (HashRng::new(1), vec![0.0; n]);
        let samples = 400_000;
        for _ in 0..samples {
            let (x, pdf, i) = d.sample(rng.next_f32());
            assert_eq!((x * n as f32) as usize, i);
            assert_eq!(pdf, d.pdf(x));
            assert!(pdf > 0.0 && values[i] != 0.0);
            assert_eq!(d.value_sign(i), values[i].signum());
            counts[i] += 1.0;
        }
        let expected: Vec<f64> = values.iter().map(|v| f64::from(v.abs()) / total * f64::from(samples)).collect();
        assert_fits(&format!("{n} pieces"), &counts, &expected);
    }
}

#[test]
fn sampling_is_monotone_and_fills_pieces_evenly() {
    let d = Piecewise1D::new(&[1.0, 0.0, 3.0]);
    let mut last = -1.0;
    for i in 0..10_000 {
        let (x, ..) = d.sample(i as f32 / 10_000.0);
        assert!(x >= last);
        last = x;
    }
    // A quarter of the probability lies in the first third.
    assert!((d.sample(0.125).0 - 1.0 / 6.0).abs() < 1e-6);
    assert!((d.sample(0.625).0 - 5.0 / 6.0).abs() < 1e-6);
    assert_eq!((d.pdf(0.5), d.pdf(-0.1), d.pdf(1.0)), (0.0, 0.0, 0.0));
}

#[test]
fn the_guide_table_finds_what_a_search_finds() {
    // Extremely uneven pieces, among them 4000 that share the last millionth.
    let mut values = vec![1e-9_f32; 5000];
    values[17] = 1.0;
    values[4999] = 1e-5;
    for values in [values, mixed(4097), vec![1.0; 64]] {
        let d = Piecewise1D::new(&values);
        let n = values.len();
        let (mut cdf, mut guide) = (vec![0.0; n + 1], vec![0; guide_len(n)]);
        accumulate(values.iter().map(|&v| weight(v)), &mut cdf, &mut guide);
        let mut rng = HashRng::new(9);
        let ends = [0.0, f32::MIN_POSITIVE, ONE_MINUS_EPSILON, 0.25, 0.5];
        for u in (0..20_000).map(|_| rng.next_f32()).chain(ends).chain(cdf[1..n].iter().copied().filter(|&c| c < 1.0)) {
            let by_search = cdf.partition_point(|&c| c <= u) - 1;
            assert_eq!(d.sample(u).2, by_search, "u = {u}");
        }
    }
}

#[test]
fn samples_in_two_dimensions_follow_the_density() {
    let (nu, nv) = (21, 13);
    let mut values = mixed(nu * nv);
    values[5 * nu..6 * nu].fill(0.0);
    let d = Piecewise2D::new(&values, nu, nv);
    assert_eq!(d.size(), [nu, nv]);
    let total: f64 = values.iter().map(|v| f64::from(v.abs())).sum();
    assert!((f64::from(d.integral()) * (nu * nv) as f64 / total - 1.0).abs() < 1e-6);
    let (mut rng, mut counts) = (HashRng::new(2), vec![0.0; nu * nv]);
    let samples = 400_000;
    for _ in 0..samples {
        let u = random_2d(&mut rng);
        let (p, pdf, [i, j]) = d.sample_cell(u);
        assert_eq!((p, pdf), d.sample(u));
        assert_eq!(pdf, d.pdf(p));
        assert_eq!(d.value_sign([i, j]), values[j * nu + i].signum());
        assert!(pdf > 0.0);
        counts[j * nu + i] += 1.0;
    }
    let expected: Vec<f64> = values.iter().map(|v| f64::from(v.abs()) / total * f64::from(samples)).collect();
    assert_fits("grid", &counts, &expected);
}

#[test]
fn tables_without_weight_are_uniform_and_odd_ones_are_safe() {
    let huge = [f32::MAX; 9];
    for values in [&[][..], &[0.0; 5], &[f32::NAN, f32::INFINITY, 0.0], &[2.0], &huge] {
        let d = Piecewise1D::new(values);
        for u in [0.0, 0.3, ONE_MINUS_EPSILON, f32::NAN, 2.0, -1.0] {
            let (x, pdf, i) = d.sample(u);
            assert!((0.0..1.0).contains(&x) && (pdf - 1.0).abs() < 1e-6 && i < d.len(), "{values:?} at {u}: {x} {pdf}");
        }
    }
    assert_eq!(Piecewise1D::new(&[0.0; 5]).integral(), 0.0);
    assert_eq!(Piecewise1D::new(&[f32::NAN, 1.0]).pdf(0.25), 0.0);
    for d in [
        Piecewise2D::new(&[], 0, 0),
        Piecewise2D::new(&[1.0; 5], 2, 3),
        Piecewise2D::new(&[1.0], usize::MAX, 3),
        Piecewise2D::new(&[0.0; 6], 2, 3),
        Piecewise2D::new(&huge, 3, 3),
    ] {
        let (p, pdf) = d.sample(Vec2::new(0.3, ONE_MINUS_EPSILON));
        assert!((0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y) && (pdf - 1.0).abs() < 1e-6);
    }
    // Weights as small as floats get keep their proportions.
    let tiny = f32::from_bits(1);
    assert!((Piecewise1D::new(&[tiny, tiny, 0.0, 0.0]).pdf(0.1) - 2.0).abs() < 1e-6);
}

#[test]
fn alias_tables_follow_their_weights() {
    for n in [1, 9, 100, 1003] {
        let weights = if n == 1 { vec![3.0] } else { mixed(n) };
        let t = AliasTable::new(&weights);
        assert!(((0..n).map(|i| f64::from(t.pmf(i))).sum::<f64>() - 1.0).abs() < 1e-5);
        // The exact probability of each index, from the bins themselves.
        let mut exact = vec![0.0; n];
        let steps = 2000 * n;
        for k in 0..steps {
            let (i, pmf, rest) = t.sample((k as f32 + 0.5) / steps as f32);
            assert!(weights[i] != 0.0 && pmf == t.pmf(i) && (0.0..1.0).contains(&rest));
            exact[i] += 1.0 / steps as f64;
        }
        for (i, p) in exact.into_iter().enumerate() {
            assert!((p - f64::from(t.pmf(i))).abs() < 0.02 / n as f64, "{i} of {n}");
        }
    }
}

#[test]
fn alias_tables_hand_on_uniform_numbers() {
    let t = AliasTable::new(&[0.1, 5.0, 0.0, 2.0, 1.3]);
    let (mut rng, mut counts) = (HashRng::new(4), [[0.0; 16]; 5]);
    let n = 400_000;
    for _ in 0..n {
        let (i, _, rest) = t.sample(rng.next_f32());
        counts[i][(rest * 16.0) as usize] += 1.0;
    }
    let expected: Vec<f64> = (0..5 * 16).map(|k| f64::from(t.pmf(k / 16)) * f64::from(n) / 16.0).collect();
    assert_fits("index and rest", counts.as_flattened(), &expected);
}

#[test]
fn odd_alias_tables_are_safe() {
    let empty = AliasTable::new(&[]);
    assert!(empty.is_empty());
    assert_eq!(empty.sample(0.3), (0, 0.0, 0.3));
    let zero = AliasTable::new(&[0.0, f32::NAN, f32::INFINITY]);
    assert!((zero.pmf(1) - 1.0 / 3.0).abs() < 1e-7 && zero.pmf(7) == 0.0);
    assert_eq!(zero.sample(0.5).0, 1);
    for u in [f32::NAN, -1.0, 9.0] {
        assert!(zero.sample(u).0 < 3);
    }
}
