use super::*;
use crate::{DVec3, hash::HashRng};

fn xyz(text: &str) -> Result<Expression<3>, Fault> {
    Expression::new(text, &["x", "y", "z"])
}

#[test]
fn faults_of_expressions_have_their_column() {
    let says = |text: &str| xyz(text).unwrap_err().to_string();
    for (text, parts) in [
        ("", vec!["column 1", "expected a number", "the end"]),
        ("x + ", vec!["column 5", "the end"]),
        ("x y", vec!["column 3", "an operator or the end", "'y'"]),
        ("(x", vec!["column 3", "')'"]),
        ("2 * sine(x)", vec!["column 5", "'sine'", "sin"]),
        ("min(x)", vec!["column 6", "','"]),
        ("sin x", vec!["column 5", "'('"]),
        ("x + é", vec!["column 5", "'é'"]),
        ("1e999", vec!["column 1", "a number"]),
        (".", vec!["column 1", "a number"]),
    ] {
        let said = says(text);
        assert!(parts.iter().all(|p| said.contains(p)), "{text}: {said}");
    }
    assert!(says(&"(".repeat(100)).contains("64 deep"));
    assert!(says(&"-".repeat(100)).contains("64 deep"));
    assert!(says(&format!("x{}", " ".repeat(5000))).contains("4096 letters"));
    assert!(says(&format!("x{}", "+x".repeat(1000))).contains("1024 operations"));
    // Powers bind to the right and before signs.
    for (text, value) in [
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("8/2/2", 2.0),
        ("1-2-3", -4.0),
        ("max(1,3,2)", 3.0),
        ("-x^2*3", -12.0),
        ("x^0.5 * x^0.5", 2.0),
        ("2e0*pi/pi", 2.0),
        ("+-1", -1.0),
        ("floor(-x/4) + floor(7/x)", 2.0),
    ] {
        let v: f64 = xyz(text).unwrap().value([2.0, 0.0, 0.0]);
        assert!((v - value).abs() < 1e-12, "{text}: {v}");
    }
}

/// Intervals contain what they are of.
#[test]
fn intervals_contain_their_values() {
    let mut rng = HashRng::new(77);
    for text in [
        "sin(x)*cos(3*y)",
        "x^3 - y^2/ (2+cos(z))",
        "exp(x)/(1+y^2)",
        "abs(x-y)*min(x,z)",
        "max(x,y)^4 - sqrt(abs(z))",
        "log(3+x)^-2",
        "abs(y)^1.7",
        "x - floor(2*y)",
    ] {
        let e = xyz(text).unwrap();
        for _ in 0..500 {
            let mut n = || f64::from(rng.next_f32() - 0.5) * 4.0;
            let (o, d) = (DVec3::new(n(), n(), n()), DVec3::new(n(), n(), n()) * 0.2);
            let along = |k: usize| {
                let (a, b) = (o[k], o[k] + d[k]);
                Dual::new(Interval::new(a.min(b), a.max(b)), Interval::new(d[k], d[k]))
            };
            let all = e.value([along(0), along(1), along(2)]);
            for s in [0.0, 0.3, 0.5, 1.0] {
                let (v, g) = e.sample((o + d * s).to_array());
                let slope = DVec3::from_array(g).dot(d);
                let near = |i: Interval, v: f64| {
                    v.is_nan() || i.is_none() || (i.low - 1e-12 * v.abs() <= v && v <= i.high + 1e-12 * v.abs())
                };
                assert!(near(all.value, v) && near(all.slope, slope), "{text}: {v} {slope} in {all:?}");
                assert!(!all.value.is_none() || v.is_nan());
            }
        }
    }
}

/// Names that are not known are told, with all that are; variables are the caller's.
#[test]
fn names_are_those_of_the_variables() {
    let fault = Expression::<2>::new("u + w", &["u", "v"]).unwrap_err();
    assert_eq!((fault.column, fault.name.as_deref()), (Some(5), Some("w")));
    assert!(fault.what.contains("u, v, pi or a function"), "{fault}");
    assert!(
        Expression::<2>::names(&["u", "v"])
            .eq(["u", "v", "pi", "min", "max", "abs", "sqrt", "sin", "cos", "exp", "log", "floor"])
    );
    let product = Expression::new("u*v", &["u", "v"]).unwrap();
    assert_eq!((product.value([3.0, 4.0]), product.uses(1)), (12.0, true));
    assert!(!Expression::new("2*u", &["u", "v"]).unwrap().uses(1));
}
