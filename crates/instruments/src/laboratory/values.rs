//! Parameters of experiments, and their values.

use super::{Error, Experiment};
use steradian_scene::names::nearest;

/// Kind of a parameter's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number in a closed range.
    Number {
        /// Used where none is given.
        default: f64,
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// A whole number in a closed range.
    Count {
        /// Used where none is given.
        default: u32,
        /// Least value.
        min: u32,
        /// Greatest value.
        max: u32,
    },
    /// One of some names, the first being the default.
    Name(&'static [&'static str]),
}

/// A parameter of an experiment.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// Description of the parameter.
    pub doc: &'static str,
    /// Its unit; empty for names and pure numbers.
    pub unit: &'static str,
    /// Kind of its values.
    pub kind: Kind,
}

impl Parameter {
    /// A number.
    pub const fn number(
        name: &'static str,
        default: f64,
        range: (f64, f64),
        unit: &'static str,
        doc: &'static str,
    ) -> Self {
        Self { name, doc, unit, kind: Kind::Number { default, min: range.0, max: range.1 } }
    }

    /// A whole number.
    pub const fn count(name: &'static str, default: u32, range: (u32, u32), doc: &'static str) -> Self {
        Self { name, doc, unit: "", kind: Kind::Count { default, min: range.0, max: range.1 } }
    }

    /// A choice.
    pub const fn choice(name: &'static str, choices: &'static [&'static str], doc: &'static str) -> Self {
        Self { name, doc, unit: "", kind: Kind::Name(choices) }
    }

    /// Its default, as it would be written on the command line.
    pub fn default_text(&self) -> String {
        match self.kind {
            Kind::Number { default, .. } => default.to_string(),
            Kind::Count { default, .. } => default.to_string(),
            Kind::Name(names) => names.first().copied().unwrap_or_default().to_owned(),
        }
    }

    /// Allowed values as text: a range, or the names.
    pub fn range_text(&self) -> String {
        match self.kind {
            Kind::Number { min, max, .. } => format!("{min} to {max}"),
            Kind::Count { min, max, .. } => format!("{min} to {max}"),
            Kind::Name(names) => names.join("|"),
        }
    }

    /// Reads a value.
    fn parse(&self, text: &str) -> Result<Value, Error> {
        let bad = || {
            let what = match self.kind {
                Kind::Number { .. } => "a number from ",
                Kind::Count { .. } => "a whole number from ",
                Kind::Name(_) => "one of ",
            };
            let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
            let why = format!("'{text}' is not {what}{}{unit}", self.range_text());
            Error::BadValue { name: self.name, why }
        };
        match self.kind {
            Kind::Number { min, max, .. } => {
                let v: f64 = text.trim().parse().map_err(|_| bad())?;
                if (min..=max).contains(&v) { Ok(Value::Number(v)) } else { Err(bad()) }
            }
            Kind::Count { min, max, .. } => {
                let v: u32 = text.trim().parse().map_err(|_| bad())?;
                if (min..=max).contains(&v) { Ok(Value::Number(f64::from(v))) } else { Err(bad()) }
            }
            Kind::Name(names) => {
                names.iter().find(|n| n.eq_ignore_ascii_case(text.trim())).map(|n| Value::Name(n)).ok_or_else(bad)
            }
        }
    }

    fn default_value(&self) -> Value {
        match self.kind {
            Kind::Number { default, .. } => Value::Number(default),
            Kind::Count { default, .. } => Value::Number(f64::from(default)),
            Kind::Name(names) => Value::Name(names.first().copied().unwrap_or_default()),
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Value {
    Number(f64),
    Name(&'static str),
}

/// The values of all parameters of an experiment.
#[derive(Clone, Debug)]
pub struct Values {
    values: Vec<(&'static str, Value, bool)>,
}

impl Values {
    /// Defaults, overridden by what is given.
    pub(crate) fn resolve(experiment: &Experiment, given: &[(String, String)]) -> Result<Self, Error> {
        let mut values: Vec<_> = experiment.parameters.iter().map(|p| (p.name, p.default_value(), false)).collect();
        for (name, text) in given {
            let Some(k) = experiment.parameters.iter().position(|p| p.name == name) else {
                let names: Vec<_> = experiment.parameters.iter().map(|p| p.name).collect();
                let hint = match nearest(name, names.iter().copied()) {
                    Some(known) => format!("; did you mean '{known}'?"),
                    None if names.is_empty() => "; it has none".to_owned(),
                    None => format!("; its parameters are {}", names.join(", ")),
                };
                return Err(Error::UnknownParameter { experiment: experiment.name, name: name.clone(), hint });
            };
            values[k].1 = experiment.parameters[k].parse(text)?;
            values[k].2 = true;
        }
        Ok(Self { values })
    }

    fn value(&self, name: &str) -> Option<Value> {
        self.values.iter().find(|v| v.0 == name).map(|v| v.1)
    }

    /// The number called `name`. A name that the experiment does not declare gives NaN, which its test shows.
    pub fn number(&self, name: &str) -> f64 {
        match self.value(name) {
            Some(Value::Number(v)) => v,
            _ => f64::NAN,
        }
    }

    /// The whole number called `name`.
    pub fn count(&self, name: &str) -> usize {
        self.number(name) as usize
    }

    /// The choice called `name`.
    pub fn choice(&self, name: &str) -> &'static str {
        match self.value(name) {
            Some(Value::Name(n)) => n,
            _ => "",
        }
    }

    /// True if the user gave a value.
    pub fn is_given(&self, name: &str) -> bool {
        self.values.iter().any(|v| v.0 == name && v.2)
    }
}
