//! A list of integrators with options, in one word of the command line.

use std::str::FromStr;

/// Integrators, `NAME` or `NAME:key=value,…`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names(pub Vec<String>);

impl FromStr for Names {
    type Err = String;

    /// Commas part integrators, and options of one integrator: what follows a comma and is `key=value` is an option of
    /// the integrator before it.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut names: Vec<String> = Vec::new();
        for part in text.split(',') {
            let is_option = part.split_once('=').is_some_and(|(key, _)| !key.contains(':'));
            match names.last_mut().filter(|last| is_option && last.contains(':')) {
                Some(last) => *last += &format!(",{part}"),
                None => names.push(part.into()),
            }
        }
        for name in &names {
            steradian::Quality::of(name).request().map_err(|e| e.to_string())?;
        }
        Ok(Self(names))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_stay_with_their_integrator() {
        let parse = |text: &str| text.parse::<Names>().map(|names| names.0);
        assert_eq!(parse("path,bdpt").unwrap(), ["path", "bdpt"]);
        let one = "path:reuse=1,guiding=false";
        assert_eq!(parse(&format!("{one},bdpt")).unwrap(), [one, "bdpt"]);
        for bad in ["", "path,", "pth", "path,reuse=1"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
