//! Numbers and points in words.

use crate::exercise::{Function, shape};

/// A number with six digits at most.
pub(crate) fn shown(x: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return if x.is_nan() { "NaN".into() } else { format!("{}", x + 0.0) };
    }
    let magnitude = x.abs().log10().floor() as i32;
    if !(-4..9).contains(&magnitude) {
        return format!("{x:.4e}");
    }
    let text = format!("{x:.*}", (5 - magnitude).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Numbers, in parentheses if they are several.
pub(crate) fn listed(numbers: &[f64]) -> String {
    let all: Vec<String> = numbers.iter().map(|x| shown(*x)).collect();
    if let [one] = &all[..] { one.clone() } else { format!("({})", all.join(", ")) }
}

/// Inputs with their names.
pub(crate) fn point(function: &Function, inputs: &[f64]) -> String {
    let mut rest = inputs;
    let named = function.inputs.iter().map(|input| {
        let (name, count) = shape(input);
        let (numbers, others) = rest.split_at(count.min(rest.len()));
        rest = others;
        format!("{name} = {}", listed(numbers))
    });
    named.collect::<Vec<_>>().join(", ")
}

/// Outputs, with their names if they are several.
pub(crate) fn answer(function: &Function, outputs: &[f64]) -> String {
    if outputs.len() < 2 || outputs.len() != function.outputs.len() {
        return listed(outputs);
    }
    let named = function.outputs.iter().zip(outputs).map(|(name, x)| format!("{name} = {}", shown(*x)));
    format!("({})", named.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.5, "0.5"),
            (100.0, "100"),
            (-0.0, "0"),
            (1.0 / 3.0, "0.333333"),
            (123456.789, "123457"),
            (2e-9, "2.0000e-9"),
        ];
        for (x, text) in cases {
            assert_eq!(shown(x), text);
        }
        assert_eq!(listed(&[1.0, 0.25]), "(1, 0.25)");
    }
}
