//! The parameters of one directive, asked for by name and type.

use super::{
    param::{Param, Type, Values},
    report::Report,
};
use std::{cell::RefCell, rc::Rc};
use steradian_scene::{ColorSpace, Span, names};

/// Parameters set for all directives of a block by `Attribute`.
pub(super) type Inherited = Rc<Vec<Rc<Param>>>;

/// Arguments of a directive: the name of a model and parameters.
///
/// Every question is remembered, so that parameters which nobody asked for can be reported with the nearest name that
/// would have been heard.
#[derive(Debug)]
pub(super) struct Dict {
    /// The model, such as `perspective`.
    pub kind: String,
    /// Source span of the model's name.
    pub span: Span,
    /// In force where the directive stands.
    pub space: ColorSpace,
    own: Vec<Param>,
    inherited: Inherited,
    asked: RefCell<Vec<&'static str>>,
}

impl Dict {
    pub fn new(kind: String, span: Span, own: Vec<Param>, inherited: Inherited, space: ColorSpace) -> Self {
        Self { kind, span, space, own, inherited, asked: RefCell::default() }
    }

    /// Replaces the model and the place where it is named.
    pub fn at(mut self, kind: &str, span: Span) -> Self {
        self.kind = kind.into();
        self.span = span;
        self
    }

    /// The directive's own parameters.
    pub fn into_params(self) -> impl Iterator<Item = Param> {
        self.own.into_iter()
    }

    /// A directive that the file leaves out.
    pub fn absent(kind: &str, span: Span) -> Self {
        Self::new(kind.into(), span, Vec::new(), Inherited::default(), ColorSpace::Srgb)
    }

    /// The parameter of that name with one of these types; the last one given counts, and inherited ones come after the
    /// directive's own. A parameter of that name with another type is an error.
    pub fn find(&self, report: &mut Report, name: &'static str, types: &[Type]) -> Option<&Param> {
        #[cfg(test)]
        crate::law::note(self.kind.clone(), name, types.iter().map(|t| t.name()).collect());
        self.asked.borrow_mut().push(name);
        let mut found = None;
        let mut mistyped = None;
        for p in self.own.iter().rev().filter(|p| &*p.name == name) {
            if types.contains(&p.ty) {
                p.used.set(true);
                found = found.or(Some(p));
            } else {
                mistyped = mistyped.or(Some(p));
            }
        }
        if found.is_none() {
            found = self.inherited.iter().rev().map(|p| &**p).find(|p| &*p.name == name && types.contains(&p.ty));
        }
        if let (None, Some(p)) = (found, mistyped)
            && !p.used.replace(true)
        {
            let wanted: Vec<&str> = types.iter().map(|t| t.name()).collect();
            let message = format!("parameter '{name}' must be {}, not {}", wanted.join(" or "), p.ty.name());
            report.error(p.span, message);
        }
        found
    }

    /// Tests for a parameter of that name with one of these types.
    pub fn has(&self, name: &str, types: &[Type]) -> bool {
        let is = |p: &Param| &*p.name == name && types.contains(&p.ty);
        self.own.iter().any(is) || self.inherited.iter().any(|p| is(p))
    }

    /// Source span of a parameter's value, or of the directive.
    pub fn span_of(&self, name: &str) -> Span {
        self.own.iter().rev().find(|p| &*p.name == name).map_or(self.span, |p| p.value_span)
    }

    /// One number.
    pub fn float(&self, report: &mut Report, name: &'static str) -> Option<f64> {
        let p = self.find(report, name, &[Type::Float])?;
        match &p.values {
            Values::Floats(v) if single(report, p, v.len(), 1) => Some(v[0]),
            _ => None,
        }
    }

    /// One number, or the default.
    pub fn float_or(&self, report: &mut Report, name: &'static str, default: f64) -> f64 {
        self.float(report, name).unwrap_or(default)
    }

    /// One integer.
    pub fn int(&self, report: &mut Report, name: &'static str) -> Option<i32> {
        let p = self.find(report, name, &[Type::Integer])?;
        match &p.values {
            Values::Ints(v) if single(report, p, v.len(), 1) => Some(v[0]),
            _ => None,
        }
    }

    /// One truth value.
    pub fn bool(&self, report: &mut Report, name: &'static str) -> Option<bool> {
        let p = self.find(report, name, &[Type::Bool])?;
        match &p.values {
            Values::Bools(v) if single(report, p, v.len(), 1) => Some(v[0]),
            _ => None,
        }
    }

    /// One string, with its place.
    pub fn text(&self, report: &mut Report, name: &'static str) -> Option<(&str, Span)> {
        self.one_text(report, name, Type::String)
    }

    /// The name of a texture, with its place.
    pub fn texture(&self, report: &mut Report, name: &'static str) -> Option<(&str, Span)> {
        self.one_text(report, name, Type::Texture)
    }

    fn one_text(&self, report: &mut Report, name: &'static str, ty: Type) -> Option<(&str, Span)> {
        let p = self.find(report, name, &[ty])?;
        match &p.values {
            Values::Texts(v) if single(report, p, v.len(), 1) => Some((&v[0], p.value_span)),
            _ => None,
        }
    }

    /// All strings of a parameter.
    pub fn texts(&self, report: &mut Report, name: &'static str) -> Option<(&[String], Span)> {
        let p = self.find(report, name, &[Type::String])?;
        match &p.values {
            Values::Texts(v) => Some((v, p.value_span)),
            _ => None,
        }
    }

    /// One point or vector.
    pub fn vec3(&self, report: &mut Report, name: &'static str, ty: Type) -> Option<[f64; 3]> {
        let p = self.find(report, name, &[ty])?;
        match &p.values {
            Values::Floats(v) if single(report, p, v.len(), 3) => Some([v[0], v[1], v[2]]),
            _ => None,
        }
    }

    /// All numbers of a parameter whose values have [`Type::arity`] numbers each.
    pub fn floats(&self, report: &mut Report, name: &'static str, ty: Type) -> Option<&[f64]> {
        let p = self.find(report, name, &[ty])?;
        match &p.values {
            Values::Floats(v) if whole(report, p, v.len()) => Some(v),
            _ => None,
        }
    }

    /// All integers of a parameter.
    pub fn ints(&self, report: &mut Report, name: &'static str) -> Option<&[i32]> {
        match &self.find(report, name, &[Type::Integer])?.values {
            Values::Ints(v) => Some(v),
            _ => None,
        }
    }

    /// Reports the parameters that nobody asked for.
    pub fn report_unused(&self, report: &mut Report, what: &str) {
        for p in self.own.iter().filter(|p| !p.used.get()) {
            let message = format!("{what} '{}' has no parameter '{}'", self.kind, p.name);
            report.unused(p.span, message, || names::did_you_mean(&p.name, self.asked.borrow().iter().copied()));
        }
    }

    /// Takes a parameter that has no effect on the picture, and notes why.
    pub fn no_effect(&self, report: &mut Report, family: &str, name: &'static str, ty: Type, why: &str) {
        if self.find(report, name, &[ty]).is_some() {
            report.no_effect(self.span_of(name), &format!("'{name}' of {family} '{}'", self.kind), why);
        }
    }

    /// Takes every parameter as read, for directives of which a message says that they are left out.
    pub fn ignore_all(&self) {
        self.own.iter().for_each(|p| p.used.set(true));
    }
}

/// True if a parameter holds as many numbers as one value takes; an error if not.
fn single(report: &mut Report, p: &Param, found: usize, wanted: usize) -> bool {
    if found != wanted {
        let s = if wanted == 1 { "" } else { "s" };
        report.error(p.value_span, format!("parameter '{}' takes {wanted} value{s}, found {found}", p.name));
    }
    found == wanted
}

/// True if a parameter holds whole values, a multiple of its type's arity; an error if not.
fn whole(report: &mut Report, p: &Param, found: usize) -> bool {
    let n = p.ty.arity();
    if !found.is_multiple_of(n) {
        let message = format!("parameter '{}' holds {found} numbers, which is not a multiple of {n}", p.name);
        report.error(p.value_span, message);
    }
    found.is_multiple_of(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pbrt::{lexer::Lexer, param};

    fn dict(text: &str, inherited: &str) -> (Dict, Report) {
        let mut report = Report::default();
        let mut read = |text: &str| {
            let bytes: std::sync::Arc<[u8]> = text.as_bytes().into();
            let mut lexer = Lexer::new(report.sources.add("t", bytes.clone()), bytes);
            param::read(&mut lexer, ColorSpace::Srgb, &mut report)
        };
        let own = read(text);
        let inherited = Rc::new(read(inherited).into_iter().map(Rc::new).collect());
        let span = Span::new(steradian_scene::FileId(0), 0, 0);
        (Dict::new("test".into(), span, own, inherited, ColorSpace::Srgb), report)
    }

    #[test]
    fn the_last_value_counts_and_own_ones_hide_inherited_ones() {
        let (d, mut r) = dict("\"float a\" 1 \"float a\" 2", "\"float a\" 7 \"float b\" 8 \"integer a\" 9");
        assert_eq!(d.float(&mut r, "a"), Some(2.0));
        assert_eq!(d.float(&mut r, "b"), Some(8.0));
        assert_eq!(d.int(&mut r, "c"), None);
        assert!(!r.diagnostics.has_errors());
    }

    #[test]
    fn wrong_types_and_counts_are_errors() {
        let (d, mut r) = dict("\"string a\" \"x\" \"float b\" [1 2] \"point3 c\" [1 2 3 4]", "");
        assert_eq!((d.float(&mut r, "a"), d.float(&mut r, "b")), (None, None));
        assert_eq!(d.floats(&mut r, "c", Type::Point3), None);
        let messages: Vec<&str> = r.diagnostics.iter().map(|d| d.message.as_str()).collect();
        assert_eq!(
            messages,
            [
                "parameter 'a' must be float, not string",
                "parameter 'b' takes 1 value, found 2",
                "parameter 'c' holds 4 numbers, which is not a multiple of 3",
            ]
        );
        assert_eq!(d.float(&mut r, "a"), None);
        assert_eq!(r.diagnostics.error_count(), 3, "said once");
    }

    #[test]
    fn unused_parameters_are_reported_with_the_nearest_name() {
        let (d, mut r) = dict("\"float fof\" 1", "\"float inherited\" 1");
        d.float(&mut r, "fov");
        d.report_unused(&mut r, "camera");
        let all: Vec<_> = r.diagnostics.iter().collect();
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].message, "camera 'test' has no parameter 'fof'");
        assert_eq!(all[0].help.as_deref(), Some("did you mean 'fov'?"));
    }
}
