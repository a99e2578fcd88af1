//! Layers in text (.usda).

use super::{
    layer::{Fault, Layer, MOST_NESTED, Spec, Specifier, join, property},
    value::{Item, ListOp, Value, is_double},
};
use std::{collections::BTreeMap, sync::Arc};

type Result<T> = std::result::Result<T, Fault>;

/// Reads a layer.
pub(super) fn read(bytes: &[u8]) -> Result<Layer> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let skipped = bytes.len() - text.len();
    let mut parser = Parser { text, at: 0, layer: Layer::default() };
    parser.layer().map_err(|fault| Fault { at: fault.at.map(|at| at + skipped), ..fault })?;
    parser.layer.specs.values_mut().for_each(|spec| spec.at = spec.at.map(|(a, b)| (a + skipped, b + skipped)));
    Ok(parser.layer)
}

struct Parser<'t> {
    text: &'t [u8],
    at: usize,
    layer: Layer,
}

/// Edit that a word before a field asks for.
#[derive(Clone, Copy, PartialEq)]
enum Edit {
    Whole,
    Prepend,
    Append,
    Delete,
    Reorder,
}

impl Edit {
    fn of(word: &str) -> Option<Self> {
        match word {
            "prepend" => Some(Self::Prepend),
            "append" | "add" => Some(Self::Append),
            "delete" => Some(Self::Delete),
            "reorder" => Some(Self::Reorder),
            _ => None,
        }
    }
}

/// True for bytes of names; all of UTF-8 beyond ASCII is.
fn is_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte == b':' || byte >= 0x80
}

impl<'t> Parser<'t> {
    fn fault<T>(&self, message: impl Into<String>) -> Result<T> {
        Err(Fault { at: Some(self.at.min(self.text.len())), message: message.into() })
    }

    fn peek(&mut self) -> Option<u8> {
        loop {
            match self.text.get(self.at)? {
                b' ' | b'\t' | b'\r' | b'\n' | b';' => self.at += 1,
                b'#' => {
                    let line = self.text.get(self.at..).and_then(|rest| rest.iter().position(|b| *b == b'\n'));
                    self.at = line.map_or(self.text.len(), |n| self.at + n);
                }
                byte => return Some(*byte),
            }
        }
    }

    fn eat(&mut self, byte: u8) -> bool {
        let is_there = self.peek() == Some(byte);
        self.at += usize::from(is_there);
        is_there
    }

    fn expect(&mut self, byte: u8, after: &str) -> Result<()> {
        if self.eat(byte) {
            return Ok(());
        }
        let found = self.found();
        self.fault(format!("'{}' is expected {after}, not {found}", char::from(byte)))
    }

    /// Text that stands where something else is expected.
    fn found(&mut self) -> String {
        match self.peek() {
            None => "the end of the file".into(),
            Some(_) => {
                let rest = self.text.get(self.at..).unwrap_or_default();
                let end = rest.iter().position(|b| !is_name(*b)).unwrap_or(rest.len()).clamp(1, 40);
                format!("'{}'", String::from_utf8_lossy(rest.get(..end).unwrap_or(rest)))
            }
        }
    }

    fn word(&mut self) -> Option<&'t str> {
        self.peek()?;
        let rest = self.text.get(self.at..)?;
        let length = rest.iter().position(|b| !is_name(*b)).unwrap_or(rest.len());
        let word = std::str::from_utf8(rest.get(..length)?).ok().filter(|w| !w.is_empty())?;
        self.at += length;
        Some(word)
    }

    fn name(&mut self, of: &str) -> Result<&'t str> {
        match self.word() {
            Some(word) => Ok(word),
            None => {
                let found = self.found();
                self.fault(format!("{of} is expected, not {found}"))
            }
        }
    }

    fn between(&mut self, close: &[u8], what: &str) -> Result<String> {
        let start = self.at;
        let rest = self.text.get(start..).unwrap_or_default();
        let Some(length) = rest.windows(close.len()).position(|w| w == close) else {
            return self.fault(format!("{what} has no end"));
        };
        self.at = start + length + close.len();
        Ok(String::from_utf8_lossy(rest.get(..length).unwrap_or_default()).into_owned())
    }

    /// A text in quotes of either kind, once or three times.
    fn string(&mut self) -> Result<String> {
        let Some(quote @ (b'"' | b'\'')) = self.peek() else {
            let found = self.found();
            return self.fault(format!("a text in quotes is expected, not {found}"));
        };
        let start = self.at;
        let is_long = self.text.get(start..start + 3).is_some_and(|t| t.iter().all(|b| *b == quote));
        self.at += if is_long { 3 } else { 1 };
        let mut out = Vec::new();
        loop {
            let Some(&byte) = self.text.get(self.at) else {
                self.at = start;
                return self.fault("this text has no end");
            };
            match byte {
                b'\\' => {
                    let next = self.text.get(self.at + 1).copied().unwrap_or(b'\\');
                    out.push(match next {
                        b'n' => b'\n',
                        b't' => b'\t',
                        b'r' => b'\r',
                        other => other,
                    });
                    self.at += 2;
                }
                b if b == quote && !is_long => {
                    self.at += 1;
                    break;
                }
                b if b == quote && self.text.get(self.at..self.at + 3).is_some_and(|t| t == [quote; 3]) => {
                    self.at += 3;
                    break;
                }
                b'\n' if !is_long => {
                    self.at = start;
                    return self.fault("this text does not end on its line");
                }
                b => {
                    out.push(b);
                    self.at += 1;
                }
            }
        }
        Ok(String::from_utf8_lossy(&out).into_owned())
    }

    fn asset(&mut self) -> Result<String> {
        self.expect(b'@', "before the name of a file")?;
        if self.text.get(self.at..self.at + 2) == Some(b"@@") {
            self.at += 2;
            return self.between(b"@@@", "the name of a file");
        }
        self.between(b"@", "the name of a file")
    }

    fn path(&mut self) -> Result<String> {
        self.expect(b'<', "before a path")?;
        self.between(b">", "a path")
    }

    fn number(&mut self) -> Result<f64> {
        self.peek();
        let rest = self.text.get(self.at..).unwrap_or_default();
        match fast_float2::parse_partial::<f64, _>(rest) {
            Ok((value, length)) if length > 0 => {
                self.at += length;
                Ok(value)
            }
            _ => {
                let found = self.found();
                self.fault(format!("a number is expected, not {found}"))
            }
        }
    }

    // Values.

    /// A value; numbers of lists are kept in single precision where `single` says so.
    fn value(&mut self, single: bool, depth: usize) -> Result<Value> {
        if depth > MOST_NESTED {
            return self.fault(format!("dictionaries are nested deeper than {MOST_NESTED}"));
        }
        Ok(match self.peek() {
            Some(b'"' | b'\'') => Value::Text(self.string()?),
            Some(b'@') => Value::Asset(self.asset()?),
            Some(b'<') => Value::Text(self.path()?),
            Some(b'{') => Value::Dictionary(Arc::new(self.dictionary(depth + 1)?)),
            Some(b'[' | b'(') => self.sequence(single)?,
            Some(b) if b.is_ascii_digit() || matches!(b, b'-' | b'+' | b'.') => {
                let number = self.number()?;
                Value::Number(if single { f64::from(number as f32) } else { number })
            }
            _ => match self.name("a value")? {
                "true" | "True" => Value::Bool(true),
                "false" | "False" => Value::Bool(false),
                "None" => Value::Block,
                "inf" => Value::Number(f64::INFINITY),
                "nan" => Value::Number(f64::NAN),
                word => Value::Text(word.into()),
            },
        })
    }

    /// A list or tuple, and all that are inside of it, one after the other.
    fn sequence(&mut self, single: bool) -> Result<Value> {
        let (mut open, mut singles, mut doubles, mut texts) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        loop {
            match self.peek() {
                Some(b @ (b'[' | b'(')) if open.len() < MOST_NESTED => {
                    open.push(if b == b'[' { b']' } else { b')' });
                    self.at += 1;
                }
                Some(b',') => self.at += 1,
                Some(b @ (b']' | b')')) if open.last() == Some(&b) => {
                    self.at += 1;
                    open.pop();
                    if open.is_empty() {
                        break;
                    }
                }
                Some(b'"' | b'\'') => texts.push(self.string()?),
                Some(b'@') => texts.push(self.asset()?),
                Some(b'<') => texts.push(self.path()?),
                Some(b) if b.is_ascii_alphabetic() && b != b'i' && b != b'n' => match self.name("a value")? {
                    "true" | "True" => doubles.push(1.0),
                    "false" | "False" => doubles.push(0.0),
                    "None" => texts.push(String::new()),
                    word => return self.fault(format!("a number or a text in quotes is expected, not '{word}'")),
                },
                _ if single => singles.push(self.number()? as f32),
                _ => doubles.push(self.number()?),
            }
        }
        match (singles.is_empty() && doubles.is_empty(), texts.is_empty()) {
            (true, _) => Ok(Value::Texts(texts.into())),
            (false, false) => self.fault("this list holds both numbers and texts"),
            _ if doubles.is_empty() => Ok(Value::Floats(singles.into())),
            _ => Ok(Value::Numbers(singles.into_iter().map(f64::from).chain(doubles).collect())),
        }
    }

    fn dictionary(&mut self, depth: usize) -> Result<BTreeMap<String, Value>> {
        self.expect(b'{', "before a dictionary")?;
        let mut entries = BTreeMap::new();
        while !self.eat(b'}') {
            if self.eat(b',') {
                continue;
            }
            let mut key = match self.peek() {
                Some(b'"' | b'\'') => self.string()?,
                _ => self.name("a name or '}'")?.to_owned(),
            };
            let is_list = self.eat(b'[');
            if is_list {
                self.expect(b']', "after '['")?;
            }
            let mut single = false;
            if self.peek() != Some(b'=') {
                single = !is_double(&key);
                key = match self.peek() {
                    Some(b'"' | b'\'') => self.string()?,
                    _ => self.name("a name")?.to_owned(),
                };
            }
            self.expect(b'=', "after a name")?;
            entries.insert(key, self.value(single, depth)?);
        }
        Ok(entries)
    }

    /// One item or a list of items.
    fn items(&mut self, mut item: impl FnMut(&mut Self) -> Result<Item>) -> Result<Vec<Item>> {
        let start = self.at;
        if self.word() == Some("None") {
            return Ok(Vec::new());
        }
        self.at = start;
        if !self.eat(b'[') {
            return Ok(vec![item(self)?]);
        }
        let mut items = Vec::new();
        while !self.eat(b']') {
            if !self.eat(b',') {
                items.push(item(self)?);
            }
        }
        Ok(items)
    }

    /// The target of a reference, a payload, an inheritance, or the file of a sublayer.
    fn arc(&mut self) -> Result<Item> {
        let mut item = Item::default();
        if self.peek() == Some(b'@') {
            item.asset = self.asset()?;
        }
        if self.peek() == Some(b'<') {
            item.path = self.path()?;
        }
        if item == Item::default() && self.text.get(self.at.saturating_sub(1)) != Some(&b'>') {
            let found = self.found();
            return self.fault(format!("a file between '@' or a path between '<' and '>' is expected, not {found}"));
        }
        if self.eat(b'(') {
            while !self.eat(b')') {
                if self.eat(b',') {
                    continue;
                }
                let key = self.name("the name of an option or ')'")?;
                self.expect(b'=', "after the name of an option")?;
                match (key, self.value(false, 0)?.number()) {
                    ("offset", Some(offset)) => item.retime.offset = offset,
                    ("scale", Some(scale)) => item.retime.scale = scale,
                    _ => {}
                }
            }
        }
        Ok(item)
    }

    fn named(&mut self) -> Result<Item> {
        let path = if self.peek() == Some(b'<') { self.path()? } else { self.string()? };
        Ok(Item { path, ..Item::default() })
    }

    // Metadata.

    /// Entries up to the closing parenthesis, the opening one being read.
    fn metadata(&mut self, spec: &mut Spec) -> Result<()> {
        while !self.eat(b')') {
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b'"' | b'\'') => {
                    self.string()?;
                }
                _ => self.field(spec)?,
            }
        }
        Ok(())
    }

    fn field(&mut self, spec: &mut Spec) -> Result<()> {
        let mut key = self.name("the name of a field or ')'")?;
        let edit = Edit::of(key).unwrap_or(Edit::Whole);
        if edit != Edit::Whole {
            key = self.name("the name of a field")?;
        }
        self.expect(b'=', "after the name of a field")?;
        let items = match key {
            "references" | "payload" | "inherits" | "specializes" => self.items(Self::arc)?,
            "subLayers" => {
                let items = self.items(Self::arc)?;
                set_list(spec, key, Edit::Whole, items);
                return Ok(());
            }
            "variantSets" | "apiSchemas" => self.items(Self::named)?,
            "relocates" => {
                self.skip_braces()?;
                spec.fields.insert(key.into(), Value::Block);
                return Ok(());
            }
            _ => {
                let value = self.value(false, 0)?;
                if edit == Edit::Whole {
                    spec.fields.insert(key.into(), value);
                }
                return Ok(());
            }
        };
        set_list(spec, key, edit, items);
        Ok(())
    }

    fn skip_braces(&mut self) -> Result<()> {
        self.expect(b'{', "here")?;
        self.between(b"}", "this dictionary").map(|_| ())
    }

    // Prims.

    fn layer(&mut self) -> Result<()> {
        if !self.text.starts_with(b"#usda ") {
            return self.fault("a layer in text begins with '#usda 1.0'");
        }
        let mut head = Spec { specifier: Specifier::Def, ..Spec::default() };
        if self.eat(b'(') {
            self.metadata(&mut head)?;
        }
        while self.peek().is_some() {
            let word = self.name("'def', 'over' or 'class'")?;
            match word {
                "def" | "over" | "class" => self.prim(word, "/", &mut head, 0)?,
                "reorder" => self.reorder()?,
                _ => {
                    self.at -= word.len();
                    return self.fault(format!("'def', 'over' or 'class' is expected, not '{word}'"));
                }
            }
        }
        self.layer.specs.insert("/".into(), head);
        Ok(())
    }

    fn reorder(&mut self) -> Result<()> {
        self.name("'nameChildren' or 'properties'")?;
        self.expect(b'=', "here")?;
        self.value(false, 0).map(|_| ())
    }

    fn prim(&mut self, word: &str, parent: &str, above: &mut Spec, depth: usize) -> Result<()> {
        if depth >= MOST_NESTED {
            return self.fault(format!("prims are nested deeper than {MOST_NESTED}"));
        }
        let specifier = match word {
            "def" => Specifier::Def,
            "class" => Specifier::Class,
            _ => Specifier::Over,
        };
        let mut spec = Spec { specifier, ..Spec::default() };
        if !matches!(self.peek(), Some(b'"' | b'\'')) {
            let type_name = self.name("the type or the name of a prim")?;
            spec.fields.insert("typeName".into(), Value::Text(type_name.into()));
        }
        self.peek();
        let start = self.at;
        let name = self.string()?;
        if name.is_empty() || !name.bytes().all(is_name) {
            self.at = start;
            return self.fault(format!("'{name}' cannot name a prim: names are of letters, digits and '_'"));
        }
        spec.at = Some((start, self.at));
        let path = join(parent, &name);
        if self.eat(b'(') {
            self.metadata(&mut spec)?;
        }
        self.body(&path, &mut spec, depth)?;
        above.children.push(name);
        self.layer.specs.insert(path, spec);
        Ok(())
    }

    /// Properties, children and variants between braces.
    fn body(&mut self, path: &str, spec: &mut Spec, depth: usize) -> Result<()> {
        self.expect(b'{', "before what a prim has")?;
        while !self.eat(b'}') {
            let word = self.name("a property, a prim or '}'")?;
            match word {
                "def" | "over" | "class" => self.prim(word, path, spec, depth + 1)?,
                "variantSet" => self.variants(path, spec, depth + 1)?,
                "reorder" if matches!(self.lookahead(), Some("nameChildren" | "properties")) => self.reorder()?,
                _ => self.property(word, path, spec)?,
            }
        }
        Ok(())
    }

    fn lookahead(&mut self) -> Option<&'t str> {
        let start = self.at;
        let word = self.word();
        self.at = start;
        word
    }

    fn variants(&mut self, path: &str, above: &mut Spec, depth: usize) -> Result<()> {
        if depth >= MOST_NESTED {
            return self.fault(format!("variants are nested deeper than {MOST_NESTED}"));
        }
        let set = self.string()?;
        self.expect(b'=', "after the name of a set of variants")?;
        self.expect(b'{', "before variants")?;
        while !self.eat(b'}') {
            let start = self.at;
            let name = self.string()?;
            let mut spec = Spec { at: Some((start, self.at)), ..Spec::default() };
            if self.eat(b'(') {
                self.metadata(&mut spec)?;
            }
            let path = format!("{path}{{{set}={name}}}");
            self.body(&path, &mut spec, depth)?;
            self.layer.specs.insert(path, spec);
        }
        if !above.fields.contains_key("variantSets") {
            set_list(above, "variantSets", Edit::Prepend, vec![Item { path: set, ..Item::default() }]);
        }
        Ok(())
    }

    /// An attribute or a relationship whose first word is read.
    fn property(&mut self, first: &'t str, path: &str, above: &mut Spec) -> Result<()> {
        let (mut word, mut edit) = (first, Edit::Whole);
        loop {
            match (word, Edit::of(word)) {
                ("custom" | "uniform" | "varying" | "config", _) => {}
                (_, Some(asked)) => edit = asked,
                _ => break,
            }
            word = self.name("the type of a property")?;
        }
        let is_list = word != "rel" && self.eat(b'[');
        if is_list {
            self.expect(b']', "after '['")?;
        }
        self.peek();
        let start = self.at;
        let name = self.name("the name of a property")?;
        let full = property(path, name);
        let mut spec = self.layer.specs.remove(&full).unwrap_or_else(|| {
            above.properties.push(name.to_owned());
            Spec::default()
        });
        spec.at = spec.at.or(Some((start, self.at)));
        if word == "rel" {
            if self.eat(b'=') {
                let items = self.items(Self::named)?;
                set_list(&mut spec, "targets", edit, items);
            }
        } else {
            let type_name = if is_list { format!("{word}[]") } else { word.to_owned() };
            let single = !is_double(&type_name);
            spec.fields.insert("typeName".into(), Value::Text(type_name));
            self.attribute(&mut spec, edit, single)?;
        }
        if self.eat(b'(') {
            self.metadata(&mut spec)?;
        }
        self.layer.specs.insert(full, spec);
        Ok(())
    }

    fn attribute(&mut self, spec: &mut Spec, edit: Edit, single: bool) -> Result<()> {
        if !self.eat(b'.') {
            if self.eat(b'=') {
                let value = self.value(single, 0)?;
                spec.fields.insert("default".into(), value);
            }
            return Ok(());
        }
        match self.name("'timeSamples' or 'connect'")? {
            "connect" => {
                self.expect(b'=', "after 'connect'")?;
                let items = self.items(Self::named)?;
                set_list(spec, "connect", edit, items);
            }
            "timeSamples" => {
                self.expect(b'=', "after 'timeSamples'")?;
                self.expect(b'{', "before time samples")?;
                let mut samples = Vec::new();
                while !self.eat(b'}') {
                    if self.eat(b',') {
                        continue;
                    }
                    let time = self.number()?;
                    self.expect(b':', "after a time")?;
                    samples.push((time, self.value(single, 0)?));
                }
                samples.sort_by(|a, b| a.0.total_cmp(&b.0));
                spec.fields.insert("samples".into(), Value::Samples(samples.into()));
            }
            "spline" => {
                self.expect(b'=', "after 'spline'")?;
                self.skip_braces()?;
                spec.fields.insert("spline".into(), Value::Block);
            }
            other => {
                return self.fault(format!("'.{other}' of an attribute is not read; 'timeSamples' and 'connect' are"));
            }
        }
        Ok(())
    }
}

fn set_list(spec: &mut Spec, key: &str, edit: Edit, items: Vec<Item>) {
    let mut list = match spec.fields.get(key) {
        Some(Value::List(list)) => ListOp::clone(list),
        _ => ListOp::default(),
    };
    match edit {
        Edit::Whole => list.explicit = Some(items),
        Edit::Prepend => list.prepended.extend(items),
        Edit::Append => list.appended.extend(items),
        Edit::Delete => list.deleted.extend(items),
        Edit::Reorder => {}
    }
    spec.fields.insert(key.into(), Value::List(Arc::new(list)));
}
