//! A parameter of a model: its type, unit, range, default and meaning.

use crate::OptionValue;
use std::fmt::Write;

/// Type of a parameter's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// A number, a spectrum, or a texture.
    Texture,
    /// A number or a texture.
    Scalar,
    /// A number or a spectrum, the same everywhere.
    Spectrum,
    /// A number.
    Number,
    /// A whole number.
    Integer,
    /// True or false.
    Flag,
    /// One of some words, with commas between them.
    Word(&'static str),
    /// One of some words, or a number.
    WordOrNumber(&'static str),
    /// Any text.
    Text,
    /// A texture.
    Map,
    /// A list of textures.
    Maps,
    /// A material.
    Material,
    /// A list of materials.
    Materials,
    /// A medium.
    Medium,
    /// A phase function.
    Phase,
    /// Three numbers.
    Vector,
    /// Some numbers.
    List,
    /// Some whole numbers.
    Integers,
    /// Numbers in a list, or one number.
    NumberOrList,
    /// A number, a texture, or numbers in a list.
    ScalarOrList,
    /// A spectrum, or numbers in a list.
    SpectrumOrList,
    /// A transform.
    Transform,
    /// The name of a file.
    File,
}

impl Type {
    fn text(self) -> &'static str {
        match self {
            Self::Texture => "number, spectrum or texture",
            Self::Scalar => "number or texture",
            Self::Spectrum => "number or spectrum",
            Self::Number => "number",
            Self::Integer => "whole number",
            Self::Flag => "true or false",
            Self::Word(words) | Self::WordOrNumber(words) => words,
            Self::Text => "text",
            Self::Map => "texture",
            Self::Maps => "textures",
            Self::Material => "material",
            Self::Materials => "materials",
            Self::Medium => "medium",
            Self::Phase => "phase function",
            Self::Vector => "three numbers",
            Self::List => "list of numbers",
            Self::Integers => "list of whole numbers",
            Self::NumberOrList => "number or list of numbers",
            Self::ScalarOrList => "number, texture or list of numbers",
            Self::SpectrumOrList => "spectrum or list of numbers",
            Self::Transform => "transform",
            Self::File => "file",
        }
    }

    /// True if the values are numbers that a range can bound.
    pub fn is_numeric(self) -> bool {
        matches!(
            self,
            Self::Texture | Self::Scalar | Self::Spectrum | Self::Number | Self::Integer | Self::NumberOrList
        )
    }
}

/// Treatment of a number outside its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// Clamped to the range, and reported.
    Held,
    /// Error.
    Refused,
    /// Error below zero; clamped to the range elsewhere.
    NegativeRefused,
    /// Error up to and including zero; clamped to the range elsewhere.
    NotPositiveRefused,
}

impl Outside {
    /// True if the value `v` outside the range is an error.
    pub fn refuses(self, v: f64) -> bool {
        match self {
            Self::Held => false,
            Self::Refused => true,
            Self::NegativeRefused => v < 0.0,
            Self::NotPositiveRefused => v <= 0.0,
        }
    }
}

/// Condition for a parameter to have an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// None.
    Always,
    /// Another parameter is given.
    Given(&'static str),
    /// Another parameter has the given word as its value.
    Is(&'static str, &'static str),
}

/// One parameter of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name in descriptions.
    pub name: &'static str,
    /// Type of the values.
    pub kind: Type,
    /// Unit; empty for pure numbers.
    pub unit: &'static str,
    /// Least and greatest number; values outside are reported. Infinite without bounds and for values that are not
    /// numbers.
    pub range: (f64, f64),
    /// Treatment of values outside the range.
    pub outside: Outside,
    /// Condition for the parameter to have an effect.
    pub condition: Condition,
    /// Default as text: a value, `none`, `needed`, or the name of another parameter; after a semicolon the condition
    /// under which another default holds.
    pub default: &'static str,
    /// Meaning, in a phrase.
    pub doc: &'static str,
}

/// Range without bounds, also of parameters that are no numbers.
pub const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Range above zero, without an upper bound.
pub const POSITIVE: (f64, f64) = (f64::MIN_POSITIVE, f64::INFINITY);

impl Parameter {
    /// A parameter with its type, name, range, default and meaning.
    pub const fn new(
        kind: Type,
        name: &'static str,
        range: (f64, f64),
        default: &'static str,
        doc: &'static str,
    ) -> Self {
        Self { name, kind, unit: "", range, outside: Outside::Held, condition: Condition::Always, default, doc }
    }

    /// Parameter with a unit.
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// Parameter whose values outside the range are errors.
    pub const fn refused(mut self) -> Self {
        self.outside = Outside::Refused;
        self
    }

    /// Parameter whose values below zero are errors.
    pub const fn not_negative(mut self) -> Self {
        self.outside = Outside::NegativeRefused;
        self
    }

    /// Parameter whose values up to and including zero are errors.
    pub const fn above_zero(mut self) -> Self {
        self.outside = Outside::NotPositiveRefused;
        self
    }

    /// Parameter that has an effect only where the parameter `name` is `word`.
    pub const fn with(mut self, name: &'static str, word: &'static str) -> Self {
        self.condition = Condition::Is(name, word);
        self
    }

    /// Parameter that has an effect only where the parameter `name` is given.
    pub const fn where_given(mut self, name: &'static str) -> Self {
        self.condition = Condition::Given(name);
        self
    }

    /// Meaning and condition as text.
    pub fn meaning(&self) -> String {
        match self.condition {
            Condition::Always => self.doc.into(),
            Condition::Given(name) => format!("{} (with {name})", self.doc),
            Condition::Is(name, word) => format!("{} (with {name} = {word})", self.doc),
        }
    }

    /// The range as text: `in [0, 1]`, `at least 0`, or nothing.
    pub fn range_text(&self) -> String {
        match self.range {
            ANY => String::new(),
            POSITIVE => "above 0".into(),
            (f64::MIN_POSITIVE, high) => format!("above 0 and at most {high}"),
            (low, f64::INFINITY) => format!("at least {low}"),
            (low, high) => format!("in [{low}, {high}]"),
        }
    }

    /// True if a list of `numbers` numbers for this parameter stands for a colour, which has three.
    pub fn takes_color(&self, numbers: usize) -> bool {
        match self.kind {
            Type::Texture | Type::Spectrum => true,
            Type::SpectrumOrList => numbers == 3,
            _ => false,
        }
    }

    /// Type, range and unit in one phrase.
    pub fn values(&self) -> String {
        let mut text = self.kind.text().to_owned();
        if let Type::WordOrNumber(_) = self.kind {
            text += ", or a number";
        }
        for part in [self.range_text(), self.unit.to_owned()].into_iter().filter(|p| !p.is_empty()) {
            let _ = write!(text, ", {part}");
        }
        text
    }

    /// The words that it may be; none where it is no word.
    pub fn words(&self) -> impl Iterator<Item = &'static str> + Clone + use<> {
        let words = if let Type::Word(words) | Type::WordOrNumber(words) = self.kind { words } else { "" };
        words.split(", ").filter(|w| !w.is_empty())
    }

    /// The value that a text, as on a command line, stands for: of the parameter's type and within its range. `None`
    /// for others, and for types that no text gives: textures, materials, lists.
    pub fn read(&self, text: &str) -> Option<OptionValue> {
        let value = match self.kind {
            Type::Flag => OptionValue::Flag(text.parse().ok()?),
            Type::Integer => OptionValue::Integer(text.parse().ok()?),
            Type::Number => OptionValue::Number(text.parse().ok()?),
            Type::Word(_) | Type::File | Type::Text => OptionValue::Text(text.to_owned()),
            _ => return None,
        };
        self.admit(value)
    }

    /// A value as one of the parameter's type and within its range; `None` where it is neither. Whole numbers serve as
    /// numbers and the reverse, and flags and whole numbers as the words that they are written with.
    pub fn admit(&self, value: OptionValue) -> Option<OptionValue> {
        let is_inside = |v: f64| v.is_finite() && (self.range.0..=self.range.1).contains(&v);
        match (self.kind, value) {
            (Type::Flag, value @ OptionValue::Flag(_)) => Some(value),
            (Type::Integer, value) => {
                let v = value.number().filter(|v| v.fract() == 0.0 && is_inside(*v))?;
                Some(OptionValue::Integer(v as i64))
            }
            (Type::Number, value) => value.number().filter(|v| is_inside(*v)).map(OptionValue::Number),
            (Type::Word(_), value) => {
                let text = value.to_string();
                self.words().find(|w| *w == text).map(OptionValue::Word)
            }
            (Type::File | Type::Text, OptionValue::Text(text)) => {
                Some(OptionValue::Text(text)).filter(|t| *t != OptionValue::Text(String::new()))
            }
            _ => None,
        }
    }

    /// True if a text is a value of the parameter.
    pub fn takes(&self, text: &str) -> bool {
        self.read(text).is_some()
    }

    /// The default without what is said of exceptions.
    pub fn usual_default(&self) -> &'static str {
        self.default.split(';').next().unwrap_or_default()
    }

    /// The number that counts where it is absent; `None` where that is no number.
    pub fn default_number(&self) -> Option<f64> {
        self.usual_default().parse().ok()
    }

    /// The truth value that counts where it is absent; `None` where that is none.
    pub fn default_flag(&self) -> Option<bool> {
        self.usual_default().parse().ok()
    }

    /// The numbers that count where it is absent; `None` where these are not `N` numbers.
    pub fn default_numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let mut numbers = self.usual_default().split(',').map(|v| v.trim().parse().ok());
        let found = [(); N].map(|()| numbers.next().flatten());
        if numbers.next().is_some() || found.contains(&None) {
            return None;
        }
        Some(found.map(Option::unwrap_or_default))
    }
}

macro_rules! shorthands {
    ($($(#[$doc:meta])* $name:ident $kind:ident;)*) => {
        $($(#[$doc])*
        pub(crate) const fn $name(
            name: &'static str,
            range: (f64, f64),
            default: &'static str,
            doc: &'static str,
        ) -> Parameter {
            Parameter::new(Type::$kind, name, range, default, doc)
        })*
    };
}

shorthands! {
    /// A number, spectrum or texture.
    tex Texture;
    /// A number or texture.
    scalar Scalar;
    /// A number.
    number Number;
    /// A whole number.
    integer Integer;
    /// A number or spectrum.
    spectrum Spectrum;
}

macro_rules! unbounded {
    ($($(#[$doc:meta])* $name:ident $kind:ident;)*) => {
        $($(#[$doc])*
        pub(crate) const fn $name(name: &'static str, default: &'static str, doc: &'static str) -> Parameter {
            Parameter::new(Type::$kind, name, ANY, default, doc)
        })*
    };
}

unbounded! {
    /// True or false.
    flag Flag;
    /// A texture.
    map Map;
    /// A material.
    material Material;
    /// A file.
    file File;
    /// Any text.
    text Text;
    /// Three numbers.
    vector Vector;
    /// Some numbers.
    list List;
    /// A transform.
    transform Transform;
}

/// One of some words.
pub(crate) const fn word(
    name: &'static str,
    words: &'static str,
    default: &'static str,
    doc: &'static str,
) -> Parameter {
    Parameter::new(Type::Word(words), name, ANY, default, doc)
}
