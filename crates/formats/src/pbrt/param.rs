//! Parameters as they are written: `"float fov" [ 45 ]`.

use super::{
    lexer::{Fault, Kind, Lexer},
    report::Report,
};
use std::{cell::Cell, collections::HashSet};
use steradian_scene::{ColorSpace, Span, names};

/// The types that a declaration can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Type {
    Bool,
    Integer,
    Float,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
    String,
    Texture,
    Spectrum,
    Rgb,
    Blackbody,
}

/// Every spelling that is read; the first of a type is its name in messages. `point`, `vector`, `normal3` and `color`
/// are older.
const SPELLINGS: [(&str, Type); 17] = [
    ("bool", Type::Bool),
    ("integer", Type::Integer),
    ("float", Type::Float),
    ("point2", Type::Point2),
    ("vector2", Type::Vector2),
    ("point3", Type::Point3),
    ("point", Type::Point3),
    ("vector3", Type::Vector3),
    ("vector", Type::Vector3),
    ("normal", Type::Normal),
    ("normal3", Type::Normal),
    ("string", Type::String),
    ("texture", Type::Texture),
    ("spectrum", Type::Spectrum),
    ("rgb", Type::Rgb),
    ("color", Type::Rgb),
    ("blackbody", Type::Blackbody),
];

impl Type {
    fn parse(name: &str) -> Option<Self> {
        SPELLINGS.iter().find(|(n, _)| *n == name).map(|&(_, t)| t)
    }

    /// As in declarations.
    pub fn name(self) -> &'static str {
        SPELLINGS.iter().find(|(_, t)| *t == self).map_or("", |(n, _)| n)
    }

    /// Numbers per value.
    pub fn arity(self) -> usize {
        match self {
            Self::Point2 | Self::Vector2 => 2,
            Self::Point3 | Self::Vector3 | Self::Normal | Self::Rgb => 3,
            _ => 1,
        }
    }
}

/// Values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Bools(Vec<bool>),
    Ints(Vec<i32>),
    Floats(Vec<f64>),
    Texts(Vec<String>),
}

impl Values {
    pub fn len(&self) -> usize {
        match self {
            Self::Bools(v) => v.len(),
            Self::Ints(v) => v.len(),
            Self::Floats(v) => v.len(),
            Self::Texts(v) => v.len(),
        }
    }
}

/// One parameter of a directive.
#[derive(Clone, Debug)]
pub(super) struct Param {
    pub name: Box<str>,
    pub ty: Type,
    pub values: Values,
    /// The declaration.
    pub span: Span,
    /// The values.
    pub value_span: Span,
    /// The space of its `rgb` values.
    pub space: ColorSpace,
    /// Set once a translator asks for it.
    pub used: Cell<bool>,
}

/// Reads the parameters that follow a directive. Faulty ones are reported and left out.
pub(super) fn read(lexer: &mut Lexer, space: ColorSpace, report: &mut Report) -> Vec<Param> {
    let mut params: Vec<Param> = Vec::new();
    let mut seen = HashSet::new();
    while !report.is_full() {
        match read_one(lexer, space) {
            Ok(None) => break,
            Ok(Some(param)) => {
                // The hash set is for the rare directives with very many parameters.
                let twice = if params.len() < 16 {
                    params.iter().any(|p| p.name == param.name && p.ty == param.ty)
                } else {
                    if seen.is_empty() {
                        seen.extend(params.iter().map(|p| (p.name.clone(), p.ty)));
                    }
                    !seen.insert((param.name.clone(), param.ty))
                };
                if twice {
                    let message = format!("parameter '{}' is given twice; the last one counts", param.name);
                    report.warn(param.span, message);
                }
                params.push(param);
            }
            Err(Failure { fault, help }) => report.error_help(lexer.span(fault.range), fault.message, help),
        }
    }
    params
}

/// A fault with advice.
struct Failure {
    fault: Fault,
    help: Option<String>,
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        Self { fault, help: None }
    }
}

fn read_one(lexer: &mut Lexer, space: ColorSpace) -> Result<Option<Param>, Failure> {
    let declaration = lexer.peek()?;
    if declaration.kind != Kind::Quoted {
        return Ok(None);
    }
    lexer.next()?;
    let range = declaration.start..declaration.end;
    let text = lexer.unquote(declaration)?.into_owned();
    let mut words = text.split([' ', '\t']).filter(|w| !w.is_empty());
    let (ty, name) = (words.next().unwrap_or(""), words.next());
    let Some(name) = name else {
        skip_value(lexer);
        let message = format!("expected a parameter declaration like \"float name\", found \"{text}\"");
        return Err(Fault { range, message }.into());
    };
    let Some(ty) = Type::parse(ty) else {
        skip_value(lexer);
        let help = names::did_you_mean(ty, SPELLINGS.iter().map(|s| s.0));
        return Err(Failure { fault: Fault { range, message: format!("unknown parameter type '{ty}'") }, help });
    };
    let first = lexer.peek()?;
    if first.kind == Kind::End || first.kind == Kind::Close || lexer.starts_statement(first) {
        return Err(Fault { range, message: format!("parameter '{name}' has no value") }.into());
    }
    let values = match read_values(lexer, ty) {
        Ok(values) => values,
        Err(mut fault) => {
            if first.kind == Kind::Open {
                let found = fault.range.start;
                let is_closed = lexer.skip_list();
                // Nothing is wrong but the bracket that lacks.
                if !is_closed && found >= lexer.position() {
                    fault = Fault::new(first.start..first.end, "this list is not closed by ']'");
                }
            }
            fault.message = format!("parameter '{name}': {}", fault.message);
            return Err(fault.into());
        }
    };
    let value_range = first.start..lexer.position();
    if values.len() == 0 {
        return Err(Fault { range: value_range, message: format!("parameter '{name}' has no value") }.into());
    }
    let (span, value_span) = (lexer.span(range), lexer.span(value_range));
    Ok(Some(Param { name: name.into(), ty, values, span, value_span, space, used: Cell::new(false) }))
}

fn read_values(lexer: &mut Lexer, ty: Type) -> Result<Values, Fault> {
    Ok(match ty {
        Type::Integer => Values::Ints(lexer.integers()?),
        Type::Bool => Values::Bools(read_bools(lexer)?),
        Type::String | Type::Texture => Values::Texts(read_texts(lexer)?),
        Type::Spectrum if holds_text(lexer)? => Values::Texts(read_texts(lexer)?),
        _ => Values::Floats(lexer.numbers()?),
    })
}

/// True if the value ahead is a string.
fn holds_text(lexer: &mut Lexer) -> Result<bool, Fault> {
    let first = lexer.next()?;
    let text = match first.kind {
        Kind::Open => lexer.peek()?.kind == Kind::Quoted,
        kind => kind == Kind::Quoted,
    };
    lexer.back(first);
    Ok(text)
}

fn read_texts(lexer: &mut Lexer) -> Result<Vec<String>, Fault> {
    read_tokens(lexer, |lexer, t| match t.kind {
        Kind::Quoted => lexer.unquote(t).map(std::borrow::Cow::into_owned),
        _ => Err(Fault {
            range: t.start..t.end,
            message: format!("expected a quoted string, found '{}'", lexer.excerpt(t)),
        }),
    })
}

fn read_bools(lexer: &mut Lexer) -> Result<Vec<bool>, Fault> {
    read_tokens(lexer, |lexer, t| match lexer.bytes(t) {
        b"true" | b"\"true\"" => Ok(true),
        b"false" | b"\"false\"" => Ok(false),
        _ => Err(Fault {
            range: t.start..t.end,
            message: format!("expected true or false, found '{}'", lexer.excerpt(t)),
        }),
    })
}

fn read_tokens<T>(
    lexer: &mut Lexer,
    item: impl Fn(&Lexer, super::lexer::Token) -> Result<T, Fault>,
) -> Result<Vec<T>, Fault> {
    let first = lexer.next()?;
    if first.kind != Kind::Open {
        return Ok(vec![item(lexer, first)?]);
    }
    let mut values = Vec::new();
    loop {
        let t = lexer.next()?;
        match t.kind {
            Kind::Close => return Ok(values),
            Kind::End => {
                return Err(Fault { range: first.start..first.end, message: "the bracket is not closed".into() });
            }
            _ if lexer.starts_statement(t) => {
                lexer.back(t);
                return Err(Fault { range: first.start..first.end, message: "the bracket is not closed".into() });
            }
            _ => values.push(item(lexer, t)?),
        }
    }
}

/// Moves over the value of a declaration that could not be understood.
fn skip_value(lexer: &mut Lexer) {
    match lexer.next() {
        Ok(t) if t.kind == Kind::Open => {
            lexer.skip_list();
        }
        Ok(t) if lexer.starts_statement(t) => lexer.back(t),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn parse(text: &str) -> (Vec<Param>, Report) {
        let mut report = Report::default();
        let text: Arc<[u8]> = text.as_bytes().into();
        let file = report.sources.add("t", text.clone());
        let params = read(&mut Lexer::new(file, text), ColorSpace::Srgb, &mut report);
        (params, report)
    }

    #[test]
    fn every_type_and_spelling() {
        let (params, report) = parse(
            r#""integer a" 3 "float b" [1 2] "point2 c" [1 2] "vector2 d" [1 2] "point e" [1 2 3] "point3 f" [1 2 3]
            "vector g" [0 0 1] "vector3 h" [0 0 1] "normal i" [0 0 1] "normal3 j" [0 0 1] "spectrum k" "metal-Ag-k"
            "spectrum l" [400 1 500 2] "rgb m" [1 1 1] "color n" [1 1 1] "blackbody o" 6500 "bool p" true "bool q" ["false"]
            "string r" ["a" "b"] "texture s" "t"  "bool t" "true" Shape"#,
        );
        assert!(report.diagnostics.is_empty(), "{:?}", report.diagnostics);
        assert_eq!(params.len(), 20);
        let get = |n: &str| params.iter().find(|p| &*p.name == n).unwrap();
        assert_eq!(get("a").values, Values::Ints(vec![3]));
        assert_eq!((get("e").ty, get("f").ty), (Type::Point3, Type::Point3));
        assert_eq!(get("i").ty, get("j").ty);
        assert_eq!(get("k").values, Values::Texts(vec!["metal-Ag-k".into()]));
        assert_eq!(get("l").values, Values::Floats(vec![400.0, 1.0, 500.0, 2.0]));
        assert_eq!((get("m").ty, get("n").ty), (Type::Rgb, Type::Rgb));
        assert_eq!(get("q").values, Values::Bools(vec![false]));
        assert_eq!(get("r").values.len(), 2);
    }

    #[test]
    fn faults_are_located_and_reading_goes_on() {
        for (text, column, message, left) in [
            (r#""float" 1 "float b" 2"#, 1, "declaration", 1),
            (r#""flot a" [1 2] "float b" 2"#, 1, "unknown parameter type 'flot'", 1),
            (r#""float a" ["x"] "float b" 2"#, 12, "parameter 'a': expected a number, found '\"x\"'", 1),
            (r#""integer a" [1.5] "float b" 2"#, 14, "expected an integer, found '1.5'", 1),
            (r#""string a" [1] "float b" 2"#, 13, "expected a quoted string", 1),
            (r#""bool a" "yes" "float b" 2"#, 10, "expected true or false", 1),
            (r#""float a" [] "float b" 2"#, 11, "has no value", 1),
            (r#""float a" Shape"#, 1, "has no value", 0),
            (r#""float a" [ 1 2 Shape"#, 11, "this list is not closed by ']'", 0),
            (r#""string a" [ "b" Shape"#, 12, "not closed", 0),
            (r#""string a" [ "b""#, 12, "not closed", 0),
            (r#""float a" 1 "float a" 2"#, 13, "given twice", 2),
            (r#""float a" nan"#, 11, "", 0),
        ] {
            let (params, report) = parse(text);
            let d = report.diagnostics.iter().next().unwrap_or_else(|| panic!("{text}"));
            assert!(d.message.contains(message), "{text}: {}", d.message);
            assert_eq!((d.location.as_ref().unwrap().column, params.len()), (column, left), "{text}");
            assert_eq!(report.diagnostics.iter().count(), 1, "{text}");
        }
    }

    #[test]
    fn very_many_parameters_are_quick() {
        let text: String = (0..200_000).map(|i| format!("\"float a{i}\" 1 ")).collect();
        let (params, report) = parse(&(text + "\"float a7\" 2"));
        assert_eq!(params.len(), 200_001);
        assert_eq!(report.diagnostics.iter().count(), 1);
    }
}
