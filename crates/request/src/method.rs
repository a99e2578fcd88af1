//! A method of rendering with its options, typed and checked by the schema.

use std::{fmt, path::PathBuf};
use steradian_scene::{Node, Span, Value, names::did_you_mean};
use steradian_schema::{Family, Kinds, Model, OptionValue, Parameter};

/// Slips in the text of a method request.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No integrator has that name.
    #[error("unknown integrator '{name}'{}; known are {known}", .hint.as_ref().map(|h| format!(" ({h})")).unwrap_or_default())]
    UnknownIntegrator {
        /// The name as written.
        name: String,
        /// "did you mean …?"
        hint: Option<String>,
        /// All names.
        known: String,
    },
    /// The integrator has no such option, or the option no such value.
    #[error(
        "option '{option}' of integrator '{integrator}' is not understood{hint}; options are written \
         NAME:key=value,key=value, and its keys are {keys}"
    )]
    Option {
        /// The option as written.
        option: String,
        /// The integrator.
        integrator: String,
        /// The values of the option, or the nearest key.
        hint: String,
        /// All options with their values.
        keys: String,
    },
}

/// An option of a scene's integrator with a value outside its type or range.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Place in the scene's file.
    pub span: Option<Span>,
    /// The fault in a sentence.
    pub message: String,
    /// "did you mean …?"
    pub hint: Option<String>,
}

/// A method with the options that are set. Later settings replace earlier ones.
#[derive(Clone, PartialEq)]
pub struct MethodRequest {
    model: &'static Model,
    options: Vec<(&'static Parameter, OptionValue)>,
}

impl MethodRequest {
    /// A method by its row in the schema, without options.
    pub const fn new(model: &'static Model) -> Self {
        Self { model, options: Vec::new() }
    }

    /// Reads `NAME` or `NAME:key=value,…`.
    ///
    /// # Errors
    /// [`Error`] for unknown names and options, and values outside the type or range of the schema.
    pub fn parse(text: &str) -> Result<Self, Error> {
        Self::parse_of(&Kinds::default(), text)
    }

    /// [`Self::parse`] where a program has methods of its own.
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub fn parse_of(kinds: &Kinds, text: &str) -> Result<Self, Error> {
        let (name, options) = text.split_once(':').unwrap_or((text, ""));
        let mut request = Self::named_of(kinds, name)?;
        for option in options.split(',').map(str::trim).filter(|o| !o.is_empty()) {
            let (key, value) = option.split_once('=').ok_or_else(|| request.unknown(option))?;
            let parameter = request.model.parameter(key.trim()).ok_or_else(|| request.unknown(option))?;
            let value = parameter.read(value).ok_or_else(|| request.unknown(option))?;
            request.set(parameter, value);
        }
        Ok(request)
    }

    /// A method by name, without options.
    ///
    /// # Errors
    /// [`Error::UnknownIntegrator`].
    pub fn named(name: &str) -> Result<Self, Error> {
        Self::named_of(&Kinds::default(), name)
    }

    fn named_of(kinds: &Kinds, name: &str) -> Result<Self, Error> {
        let known = kinds.names(Family::Integrator);
        kinds.model(Family::Integrator, name).map(Self::new).ok_or_else(|| Error::UnknownIntegrator {
            name: name.into(),
            hint: did_you_mean(name, known.clone()),
            known: known.collect::<Vec<_>>().join(", "),
        })
    }

    /// The method and options of a scene's integrator node, without those in `except`, and the options at fault. The
    /// model is that of the node's kind.
    pub fn of_node(node: &Node, model: &'static Model, except: &[&str]) -> (Self, Vec<Fault>) {
        let mut request = Self::new(model);
        let mut faults = Vec::new();
        for parameter in request.model.all().filter(|p| !except.contains(&p.name)) {
            let Some(given) = node.param(parameter.name) else { continue };
            match typed(parameter, &given.value) {
                Some(value) => request.set(parameter, value),
                None => {
                    let wanted = if parameter.words().next().is_some() { "one of " } else { "" };
                    let (name, kind, values) = (parameter.name, &node.kind, parameter.values());
                    let hint = match &given.value {
                        Value::String(text) => did_you_mean(text, parameter.words()),
                        _ => None,
                    };
                    let message = format!("parameter '{name}' of integrator '{kind}' must be {wanted}{values}");
                    faults.push(Fault { span: given.span.or(node.span), message, hint });
                }
            }
        }
        (request, faults)
    }

    /// This request with the options of another one of the same method beneath its own; others do not count.
    #[must_use]
    pub fn over(&self, beneath: Option<&Self>) -> Self {
        let Some(beneath) = beneath.filter(|b| b.name() == self.name()) else { return self.clone() };
        let mut both = beneath.clone();
        for (parameter, value) in &self.options {
            both.set(parameter, value.clone());
        }
        both
    }

    /// Sets an option of the model.
    pub fn set(&mut self, parameter: &'static Parameter, value: OptionValue) {
        self.options.retain(|(p, _)| p.name != parameter.name);
        self.options.push((parameter, value));
    }

    /// Row of the schema.
    pub fn model(&self) -> &'static Model {
        self.model
    }

    /// Name of the method.
    pub fn name(&self) -> &'static str {
        self.model.kind
    }

    /// True if no option is set, apart from those in `names`.
    pub fn sets_nothing_but(&self, names: &[&str]) -> bool {
        self.options.iter().all(|(p, _)| names.contains(&p.name))
    }

    /// The value that an option is set to.
    pub fn given(&self, name: &str) -> Option<&OptionValue> {
        self.options.iter().find(|(p, _)| p.name == name).map(|(_, value)| value)
    }

    /// The one of some options that was set last, with its value: for options that exclude each other.
    pub fn last_of(&self, names: &[&str]) -> Option<(&'static str, &OptionValue)> {
        self.options.iter().rev().find(|(p, _)| names.contains(&p.name)).map(|(p, value)| (p.name, value))
    }

    /// The value of an option: as set, or the schema's default where that is a value of its type.
    fn value(&self, name: &str) -> Option<OptionValue> {
        let default = || self.model.parameter(name).and_then(|p| p.read(p.usual_default()));
        self.given(name).cloned().or_else(default)
    }

    /// A flag; `false` where neither request nor schema has a value.
    pub fn flag(&self, name: &str) -> bool {
        matches!(self.value(name), Some(OptionValue::Flag(true)))
    }

    /// A number, whole or not; `None` where neither request nor schema has a value.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.value(name).and_then(|v| v.number())
    }

    /// A whole number from 0 to 2³² − 1; 0 where neither request nor schema has a value.
    pub fn count(&self, name: &str) -> u32 {
        self.number(name).unwrap_or(0.0) as u32
    }

    /// A word of the option's list; empty where neither request nor schema has a value.
    pub fn word(&self, name: &str) -> &'static str {
        match self.value(name) {
            Some(OptionValue::Word(word)) => word,
            _ => "",
        }
    }

    /// The file that an option names.
    pub fn file(&self, name: &str) -> Option<PathBuf> {
        match self.given(name) {
            Some(OptionValue::Text(path)) => Some(path.into()),
            _ => None,
        }
    }

    /// The error of an option that the method does not have, or not with that value.
    fn unknown(&self, option: &str) -> Error {
        let known = || self.model.all();
        let keys: Vec<String> = known().map(|o| format!("{} ({})", o.name, o.values())).collect();
        let keys = if keys.is_empty() { "none".to_owned() } else { keys.join("; ") };
        let key = option.split('=').next().unwrap_or(option).trim();
        let hint = match self.model.parameter(key) {
            Some(o) => format!(" ('{key}' takes {})", o.values()),
            None => did_you_mean(key, known().map(|o| o.name)).map(|h| format!(" ({h})")).unwrap_or_default(),
        };
        Error::Option { option: option.into(), integrator: self.name().into(), hint, keys }
    }
}

/// As it is written on a command line: `NAME:key=value,…`.
impl fmt::Display for MethodRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        for (k, (parameter, value)) in self.options.iter().enumerate() {
            write!(f, "{}{}={value}", if k == 0 { ':' } else { ',' }, parameter.name)?;
        }
        Ok(())
    }
}

impl fmt::Debug for MethodRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The value of a scene's node as one of a parameter's type and range.
fn typed(parameter: &Parameter, value: &Value) -> Option<OptionValue> {
    let value = match value {
        Value::Bool(v) => OptionValue::Flag(*v),
        Value::Int(v) => OptionValue::Integer(*v),
        Value::Float(v) => OptionValue::Number(*v),
        Value::String(v) => return parameter.read(v),
        Value::Path(v) => OptionValue::Text(v.to_str()?.to_owned()),
        _ => return None,
    };
    parameter.admit(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(node: &Node) -> &'static Model {
        Family::Integrator.model(&node.kind).unwrap()
    }

    #[test]
    fn texts_and_nodes_make_the_same_request() {
        let text = MethodRequest::parse("photon: radius=0.5 , photons=700,gather=false").unwrap();
        let node = Node::new(Family::Integrator, "photon", None)
            .with("radius", 0.5)
            .with("photons", 700i64)
            .with("gather", false);
        let (of_node, faults) = MethodRequest::of_node(&node, model(&node), &[]);
        assert!(faults.is_empty());
        assert_eq!((text.number("radius"), text.count("photons"), text.flag("gather")), (Some(0.5), 700, false));
        for name in ["radius", "photons", "gather", "nearest"] {
            assert_eq!(of_node.given(name), text.given(name), "{name}");
        }
        assert_eq!(MethodRequest::parse(&text.to_string()).unwrap(), text);
        // What is not set has the schema's default.
        assert_eq!((text.count("nearest"), text.given("nearest")), (0, None));
        assert_eq!(MethodRequest::parse("pssmlt").unwrap().number("large_step"), Some(0.3));
    }

    #[test]
    fn faults_name_what_is_wanted() {
        let said = |text: &str| MethodRequest::parse(text).unwrap_err().to_string();
        assert!(said("pahts").contains("did you mean 'path'?"));
        assert!(said("sppm:photon=3").contains("did you mean 'photons'?"));
        assert!(said("sppm:photons=-3").contains("'photons' takes whole number, in [0, 4294967295]"));
        assert!(said("raster:shadows=magic").contains("'shadows' takes ray, none, map"));
        assert!(said("path:reuse").contains("'reuse' takes auto, 1, 4, 16"));
        let node = Node::new(Family::Integrator, "pssmlt", None).with("large_step", 2.0).with("samples", "many");
        let (request, faults) = MethodRequest::of_node(&node, model(&node), &["samples"]);
        assert!(request.sets_nothing_but(&[]) && faults.len() == 1, "{faults:?}");
        assert!(
            faults[0].message.contains("'large_step' of integrator 'pssmlt' must be number, above 0 and at most 1")
        );
    }

    /// Later settings win, of options that exclude each other, too; those of other methods do not count.
    #[test]
    fn later_settings_replace_earlier_ones() {
        let of = |text: &str| MethodRequest::parse(text).unwrap();
        let file = of("vcm:radius=2,max_depth=4");
        let both = of("vcm:pixels=3,max_depth=5").over(Some(&file));
        assert_eq!(both.to_string(), "vcm:radius=2,pixels=3,max_depth=5");
        assert_eq!(both.last_of(&["radius", "pixels"]).map(|v| v.0), Some("pixels"));
        assert_eq!(of("bdpt").over(Some(&file)).to_string(), "bdpt");
        assert_eq!(of("vcm:radius=1,radius=3").number("radius"), Some(3.0));
    }
}
