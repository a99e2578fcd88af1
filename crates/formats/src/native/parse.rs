//! The notation: JSON, and what makes it comfortable by hand. Comments (`//` to the end of the line, `/*
//! */`), commas that may be left
//! out or trail, names and words without quotes, `@name` for `{ref: "name"}`, and no braces around the whole.

use steradian_scene::{FileId, Span};

/// Deepest nesting of lists and maps.
const MAX_DEPTH: usize = 64;

/// A value and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Item {
    pub kind: Kind,
    pub span: Span,
}

/// A name and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Key {
    pub text: String,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(super) enum Kind {
    Null,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    List(Vec<Item>),
    Map(Vec<(Key, Item)>),
}

impl Kind {
    /// The word for it in messages.
    pub fn noun(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a truth value",
            Self::Int(_) | Self::Float(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Map(_) => "a map",
        }
    }
}

/// Fault of a document: message and source span.
pub(super) struct Fault {
    pub message: String,
    pub span: Span,
}

/// The sections of a document.
pub(super) fn document(text: &[u8], file: FileId) -> Result<Vec<(Key, Item)>, Fault> {
    let start = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut p = Parser { text, file, at: start };
    p.space()?;
    let braced = p.peek() == Some(b'{');
    if braced {
        p.at += 1;
    }
    let sections = p.pairs(if braced { Some(b'}') } else { None }, 0)?;
    p.space()?;
    match p.peek() {
        None => Ok(sections),
        Some(_) => Err(p.fault("nothing may follow the closing brace")),
    }
}

/// One value by itself.
pub(super) fn value(text: &[u8], file: FileId) -> Result<Item, Fault> {
    let mut p = Parser { text, file, at: 0 };
    p.space()?;
    let item = p.item(0)?;
    p.space()?;
    if p.peek().is_some() { Err(p.fault("nothing may follow the value")) } else { Ok(item) }
}

/// True if a word of these bytes needs no quotes.
pub(super) fn is_word(bytes: &[u8]) -> bool {
    bytes.first().is_some_and(|b| starts_word(*b)) && bytes.iter().all(|b| goes_on(*b))
}

fn starts_word(b: u8) -> bool {
    b.is_ascii_alphabetic() || matches!(b, b'_' | b'#' | b'$') || b >= 0x80
}

fn goes_on(b: u8) -> bool {
    starts_word(b) || b.is_ascii_digit() || matches!(b, b'.' | b'-')
}

struct Parser<'a> {
    text: &'a [u8],
    file: FileId,
    at: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    fn span(&self, start: usize) -> Span {
        Span::new(self.file, start, self.at.max(start + 1))
    }

    fn fault(&self, message: impl Into<String>) -> Fault {
        Fault { message: message.into(), span: Span::new(self.file, self.at, self.at + 1) }
    }

    /// Passes white space, commas and comments.
    fn space(&mut self) -> Result<(), Fault> {
        loop {
            match self.peek() {
                Some(b' ' | b'\t' | b'\r' | b'\n' | b',') => self.at += 1,
                Some(b'/') if self.text[self.at..].starts_with(b"//") => {
                    self.at +=
                        self.text[self.at..].iter().position(|b| *b == b'\n').unwrap_or(self.text.len() - self.at);
                }
                Some(b'/') if self.text[self.at..].starts_with(b"/*") => {
                    match self.text[self.at + 2..].windows(2).position(|w| w == b"*/") {
                        Some(end) => self.at += end + 4,
                        None => return Err(self.fault("this comment is not closed by '*/'")),
                    }
                }
                _ => return Ok(()),
            }
        }
    }

    fn pairs(&mut self, end: Option<u8>, depth: usize) -> Result<Vec<(Key, Item)>, Fault> {
        let mut pairs = Vec::new();
        loop {
            self.space()?;
            if self.peek() == end {
                self.at += usize::from(end.is_some());
                return Ok(pairs);
            }
            let key = self.key()?;
            self.space()?;
            if !matches!(self.peek(), Some(b':' | b'=')) {
                return Err(self.fault(format!("a ':' is expected after '{}'", key.text)));
            }
            self.at += 1;
            self.space()?;
            pairs.push((key, self.item(depth + 1)?));
        }
    }

    fn key(&mut self) -> Result<Key, Fault> {
        let start = self.at;
        let text = match self.peek() {
            None => return Err(self.fault("the text ends where a name or a closing brace is expected")),
            Some(b'"') => self.quoted()?,
            Some(b) if starts_word(b) => self.word()?,
            Some(b) => return Err(self.fault(format!("a name is expected here, not '{}'", char::from(b)))),
        };
        Ok(Key { text, span: self.span(start) })
    }

    fn item(&mut self, depth: usize) -> Result<Item, Fault> {
        if depth > MAX_DEPTH {
            return Err(self.fault(format!("lists and maps are nested more than {MAX_DEPTH} deep")));
        }
        let start = self.at;
        let kind = match self.peek() {
            None => return Err(self.fault("the text ends where a value is expected")),
            Some(b'{') => {
                self.at += 1;
                Kind::Map(self.pairs(Some(b'}'), depth)?)
            }
            Some(b'[') => {
                self.at += 1;
                Kind::List(self.list(depth)?)
            }
            Some(b'"') => Kind::Text(self.quoted()?),
            Some(b'@') => {
                self.at += 1;
                let name = self.key()?;
                let key = Key { text: "ref".into(), span: name.span };
                Kind::Map(vec![(key, Item { kind: Kind::Text(name.text), span: name.span })])
            }
            Some(b'-' | b'+' | b'.' | b'0'..=b'9') => self.number()?,
            Some(b) if starts_word(b) => match self.word()?.as_str() {
                "true" => Kind::Bool(true),
                "false" => Kind::Bool(false),
                "null" => Kind::Null,
                word => Kind::Text(word.into()),
            },
            Some(b) => return Err(self.fault(format!("a value is expected here, not '{}'", char::from(b)))),
        };
        Ok(Item { kind, span: self.span(start) })
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Item>, Fault> {
        let mut items = Vec::new();
        loop {
            self.space()?;
            if self.peek() == Some(b']') {
                self.at += 1;
                return Ok(items);
            }
            items.push(self.item(depth + 1)?);
        }
    }

    fn word(&mut self) -> Result<String, Fault> {
        let start = self.at;
        while self.peek().is_some_and(goes_on) {
            self.at += 1;
        }
        self.utf8(&self.text[start..self.at], start)
    }

    fn utf8(&self, bytes: &[u8], start: usize) -> Result<String, Fault> {
        String::from_utf8(bytes.to_vec())
            .map_err(|_| Fault { message: "this is not UTF-8".into(), span: self.span(start) })
    }

    fn number(&mut self) -> Result<Kind, Fault> {
        let start = self.at;
        let part = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'.' | b'-' | b'+');
        while self.peek().is_some_and(part) {
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.text[start..self.at]).unwrap_or_default();
        let whole = !text.contains(['.', 'e', 'E']);
        if let Some(v) = text.parse().ok().filter(|_| whole) {
            return Ok(Kind::Int(v));
        }
        let is_plain = text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e' | b'E'));
        match text.parse() {
            Ok(v) if is_plain => Ok(Kind::Float(v)),
            _ => Err(Fault { message: format!("'{text}' is not a number"), span: self.span(start) }),
        }
    }

    fn quoted(&mut self) -> Result<String, Fault> {
        let start = self.at;
        self.at += 1;
        let mut bytes = Vec::new();
        loop {
            match self.peek() {
                None | Some(b'\n') => {
                    return Err(Fault { message: "this text lacks its closing '\"'".into(), span: self.span(start) });
                }
                Some(b'"') => {
                    self.at += 1;
                    return self.utf8(&bytes, start);
                }
                Some(b'\\') => self.escaped(&mut bytes)?,
                Some(b) => {
                    bytes.push(b);
                    self.at += 1;
                }
            }
        }
    }

    /// An escape, as in JSON.
    fn escaped(&mut self, bytes: &mut Vec<u8>) -> Result<(), Fault> {
        self.at += 1;
        let b = self.peek();
        self.at += 1;
        let plain = match b {
            Some(b @ (b'"' | b'\\' | b'/')) => b,
            Some(b'n') => b'\n',
            Some(b't') => b'\t',
            Some(b'r') => b'\r',
            Some(b'b') => 8,
            Some(b'f') => 12,
            Some(b'u') => {
                let mut code = self.code()?;
                if (0xd800..0xdc00).contains(&code) && self.text[self.at.min(self.text.len())..].starts_with(b"\\u") {
                    self.at += 2;
                    let low = self.code()?;
                    code = 0x10000 + ((code - 0xd800) << 10) + (low.wrapping_sub(0xdc00) & 0x3ff);
                }
                let c = char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER);
                bytes.extend(c.encode_utf8(&mut [0; 4]).as_bytes());
                return Ok(());
            }
            _ => {
                self.at -= 1;
                return Err(self.fault("there is no such escape; known are \\\" \\\\ \\/ \\n \\t \\r \\b \\f \\uXXXX"));
            }
        };
        bytes.push(plain);
        Ok(())
    }

    fn code(&mut self) -> Result<u32, Fault> {
        let digits = self.text.get(self.at..self.at + 4).and_then(|d| std::str::from_utf8(d).ok());
        let code = digits.and_then(|d| u32::from_str_radix(d, 16).ok());
        let code = code.ok_or_else(|| self.fault("four hexadecimal digits are expected after \\u"))?;
        self.at += 4;
        Ok(code)
    }
}
