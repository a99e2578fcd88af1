//! pbrt's tokens: quoted strings, brackets and words, separated by white space; `#` starts a comment.
//!
//! Tokens are byte ranges of the file. Arrays of numbers, which make up nearly all bytes of large scenes, are read by
//! [`Lexer::numbers`] and [`Lexer::integers`] straight from the bytes.

use std::{borrow::Cow, ops::Range, sync::Arc};
use steradian_scene::{FileId, Span};

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A directive, a number or a bare truth value.
    Word,
    /// A quoted string; the range holds the quotes.
    Quoted,
    /// `[`
    Open,
    /// `]`
    Close,
    /// The file is over.
    End,
}

/// A token and where it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub kind: Kind,
    pub start: usize,
    pub end: usize,
}

/// A fault, with the bytes it is about.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub range: Range<usize>,
    pub message: String,
}

impl Fault {
    pub fn new(range: Range<usize>, message: impl Into<String>) -> Self {
        Self { range, message: message.into() }
    }
}

/// A position in one file.
#[derive(Clone, Debug)]
pub(super) struct Lexer {
    pub file: FileId,
    text: Arc<[u8]>,
    pos: usize,
}

fn is_space(b: u8) -> bool {
    matches!(b, b' ' | b'\n' | b'\t' | b'\r')
}

/// Tests for a byte that ends a word or a number.
fn is_delimiter(b: u8) -> bool {
    is_space(b) || matches!(b, b'"' | b'[' | b']')
}

impl Lexer {
    pub fn new(file: FileId, text: Arc<[u8]>) -> Self {
        // A byte order mark is not a token.
        let pos = if text.starts_with(&[0xef, 0xbb, 0xbf]) { 3 } else { 0 };
        Self { file, text, pos }
    }

    pub fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range.start, range.end)
    }

    pub fn token_span(&self, t: Token) -> Span {
        self.span(t.start..t.end)
    }

    /// Sets the position back to the start of a token, so that it is read again.
    pub fn back(&mut self, t: Token) {
        self.pos = t.start;
    }

    /// The bytes of a token.
    pub fn bytes(&self, t: Token) -> &[u8] {
        &self.text[t.start..t.end]
    }

    /// A token's text for a message, shortened.
    pub fn excerpt(&self, t: Token) -> String {
        let text = String::from_utf8_lossy(&self.text[t.start..t.end.min(t.start + 160)]);
        let mut short: String = text.chars().take(40).collect();
        if short.len() < t.end - t.start && text.chars().count() > 40 {
            short.push('…');
        }
        short
    }

    /// Moves over white space and comments.
    fn skip(&mut self) {
        let text = &*self.text;
        while let Some(&b) = text.get(self.pos) {
            if is_space(b) {
                self.pos += 1;
            } else if b == b'#' {
                let rest = &text[self.pos..];
                self.pos += rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
            } else {
                break;
            }
        }
    }

    /// The next token. After an unterminated string reading goes on with the next line.
    pub fn next(&mut self) -> Result<Token, Fault> {
        self.skip();
        let start = self.pos;
        let text = &*self.text;
        let Some(&first) = text.get(start) else {
            return Ok(Token { kind: Kind::End, start, end: start });
        };
        let (kind, end) = match first {
            b'[' => (Kind::Open, start + 1),
            b']' => (Kind::Close, start + 1),
            b'"' => {
                let mut at = start + 1;
                loop {
                    match text.get(at) {
                        Some(b'"') => break,
                        Some(b'\\') if text.get(at + 1).is_some_and(|&b| b != b'\n') => at += 2,
                        Some(b'\n') | None => {
                            self.pos = at;
                            return Err(Fault::new(start..at, "the string is not closed on its line"));
                        }
                        Some(_) => at += 1,
                    }
                }
                (Kind::Quoted, at + 1)
            }
            _ => {
                (Kind::Word, start + text[start..].iter().position(|&b| is_delimiter(b)).unwrap_or(text.len() - start))
            }
        };
        self.pos = end;
        Ok(Token { kind, start, end })
    }

    /// The next token without moving.
    pub fn peek(&mut self) -> Result<Token, Fault> {
        let token = self.next()?;
        self.back(token);
        Ok(token)
    }

    /// The contents of a quoted token with escapes resolved.
    pub fn unquote(&self, t: Token) -> Result<Cow<'_, str>, Fault> {
        let inner = &self.text[t.start + 1..t.end - 1];
        if !inner.contains(&b'\\') {
            return Ok(String::from_utf8_lossy(inner));
        }
        let mut out = Vec::with_capacity(inner.len());
        let mut bytes = inner.iter().enumerate();
        while let Some((_, &b)) = bytes.next() {
            if b != b'\\' {
                out.push(b);
                continue;
            }
            let (at, &escaped) = bytes.next().unwrap_or((inner.len(), &b'\\'));
            out.push(match escaped {
                b'b' => 8,
                b'f' => 12,
                b'n' => b'\n',
                b'r' => b'\r',
                b't' => b'\t',
                b'\\' | b'\'' | b'"' => escaped,
                _ => {
                    let range = t.start + at..t.start + at + 2;
                    return Err(Fault::new(range, "unknown escape in a string; write \\\\ for a backslash"));
                }
            });
        }
        Ok(Cow::Owned(String::from_utf8_lossy(&out).into_owned()))
    }

    /// One number at the position, which must not be white space.
    fn number(&mut self) -> Result<f64, Fault> {
        let start = self.pos;
        let rest = &self.text[start..];
        let plus = usize::from(rest.first() == Some(&b'+') && rest.get(1).is_some_and(|&b| b != b'-' && b != b'+'));
        if let Ok((value, length)) = fast_float2::parse_partial::<f64, _>(&rest[plus..]) {
            let end = start + plus + length;
            if self.text.get(end).is_none_or(|&b| is_delimiter(b)) {
                self.pos = end;
                if value.is_finite() {
                    return Ok(value);
                }
                return Err(Fault::new(start..end, "not a finite number"));
            }
        }
        Err(self.not_a("number"))
    }

    /// One integer at the position. pbrt's integers have 32 bits.
    fn integer(&mut self) -> Result<i32, Fault> {
        let start = self.pos;
        let text = &*self.text;
        let negative = text.get(start) == Some(&b'-');
        let mut at = start + usize::from(negative || text.get(start) == Some(&b'+'));
        let digits = at;
        let mut value = 0i64;
        while let Some(digit) = text.get(at).map(|b| b.wrapping_sub(b'0')).filter(|&d| d < 10) {
            value = value.saturating_mul(10).saturating_add(i64::from(digit));
            at += 1;
        }
        if at == digits || text.get(at).is_some_and(|&b| !is_delimiter(b)) {
            return Err(self.not_a("integer"));
        }
        self.pos = at;
        i32::try_from(if negative { -value } else { value })
            .map_err(|_| Fault::new(start..at, "the integer does not fit 32 bits"))
    }

    /// Moves over the token at the position and says that it is not what was wanted.
    fn not_a(&mut self, wanted: &str) -> Fault {
        let article = if wanted.starts_with('i') { "an" } else { "a" };
        match self.next() {
            Ok(t) if t.kind == Kind::End => {
                Fault::new(t.start..t.end, format!("the file ends where {article} {wanted} is expected"))
            }
            Ok(t) => {
                if self.starts_statement(t) {
                    self.back(t);
                }
                Fault::new(t.start..t.end, format!("expected {article} {wanted}, found '{}'", self.excerpt(t)))
            }
            Err(fault) => fault,
        }
    }

    /// True if a token can only be a directive: a capitalised word.
    pub fn starts_statement(&self, t: Token) -> bool {
        t.kind == Kind::Word && self.text[t.start].is_ascii_uppercase()
    }

    /// One number after white space.
    pub fn next_number(&mut self) -> Result<f64, Fault> {
        self.skip();
        self.number()
    }

    /// A bracketed list of numbers, or one number without brackets.
    pub fn numbers(&mut self) -> Result<Vec<f64>, Fault> {
        self.list(Self::number)
    }

    /// A bracketed list of integers, or one integer without brackets.
    pub fn integers(&mut self) -> Result<Vec<i32>, Fault> {
        self.list(Self::integer)
    }

    fn list<T>(&mut self, item: impl Fn(&mut Self) -> Result<T, Fault>) -> Result<Vec<T>, Fault> {
        self.skip();
        let open = self.pos;
        if self.text.get(open) != Some(&b'[') {
            return Ok(vec![item(self)?]);
        }
        self.pos += 1;
        let mut values = Vec::new();
        loop {
            // The common separator is one blank.
            if self.text.get(self.pos) == Some(&b' ') {
                self.pos += 1;
            }
            match self.text.get(self.pos) {
                Some(b']') => {
                    self.pos += 1;
                    return Ok(values);
                }
                Some(&b) if !is_space(b) && b != b'#' => values.push(item(self)?),
                Some(_) => self.skip(),
                None => return Err(Fault::new(open..open + 1, "the bracket is not closed")),
            }
        }
    }

    /// After a fault inside a bracketed list: moves behind its end, or to where a statement seems to start. Whether the
    /// list has an end.
    pub fn skip_list(&mut self) -> bool {
        loop {
            match self.next() {
                Ok(t) if t.kind == Kind::Close => return true,
                Ok(t) if t.kind == Kind::End => return false,
                // A directive cannot stand in a list: the bracket was forgotten.
                Ok(t) if self.starts_statement(t) => {
                    self.back(t);
                    return false;
                }
                _ => {}
            }
        }
    }

    /// The position, one past the last byte that was read.
    pub fn position(&self) -> usize {
        self.pos
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_scene::Sources;

    fn lexer(text: &str) -> Lexer {
        let id = Sources::default().add("t", text.as_bytes().to_vec());
        Lexer::new(id, text.as_bytes().into())
    }

    #[test]
    fn tokens_of_every_kind() {
        let mut l = lexer("\u{feff}Shape \"a \\\"b\\\"\"[1]# ]\n\t\"\"x");
        let mut seen = Vec::new();
        loop {
            let t = l.next().unwrap();
            if t.kind == Kind::End {
                break;
            }
            seen.push((t.kind, l.excerpt(t)));
        }
        let kinds: Vec<Kind> = seen.iter().map(|s| s.0).collect();
        assert_eq!(kinds, [Kind::Word, Kind::Quoted, Kind::Open, Kind::Word, Kind::Close, Kind::Quoted, Kind::Word]);
        assert_eq!((seen[0].1.as_str(), seen[6].1.as_str()), ("Shape", "x"));
    }

    #[test]
    fn strings_and_escapes() {
        let text = |s: &str| {
            let mut l = lexer(s);
            let t = l.next()?;
            l.unquote(t).map(Cow::into_owned)
        };
        assert_eq!(text(r#""a\\b\"c\t\n\'""#).unwrap(), "a\\b\"c\t\n'");
        assert_eq!(text(r#""plain""#).unwrap(), "plain");
        assert_eq!(text(r#""C:\dir""#).unwrap_err().range, 3..5);
        assert_eq!(text("\"open\nx").unwrap_err().range, 0..5);
        assert_eq!(text("\"open\\").unwrap_err().range, 0..6);
        assert_eq!(text("\"open\\\n\"").unwrap_err().range, 0..6);
        assert_eq!(text("\"").unwrap_err().range, 0..1);
    }

    #[test]
    fn number_lists() {
        assert_eq!(lexer("[ 1 -2.5e3 +.5 0x ]").numbers().unwrap_err().range, 15..17);
        assert_eq!(lexer("[1 -2.5e3\n+.5 # c ]\n4.]").numbers().unwrap(), [1.0, -2500.0, 0.5, 4.0]);
        assert_eq!(lexer(" 7 8").numbers().unwrap(), [7.0]);
        assert_eq!(lexer("[]").numbers().unwrap(), [0.0; 0]);
        assert_eq!(lexer("[1 2").numbers().unwrap_err().message, "the bracket is not closed");
        for bad in ["nan", "inf", "-inf", "1e999", "1,", "--1", "+-1", "1.2.3", "\"1\"", "true", "1e"] {
            let fault = lexer(&format!("[ 0 {bad} ]")).numbers().unwrap_err();
            assert_eq!(fault.range, 4..4 + bad.len(), "{bad}");
        }
    }

    #[test]
    fn integer_lists() {
        assert_eq!(lexer("[ 0 -1 +2 2147483647 -2147483648]").integers().unwrap(), [0, -1, 2, i32::MAX, i32::MIN]);
        for bad in ["1.5", "2147483648", "4000000000", "-", "+", "1e3", "x", "99999999999999999999999"] {
            let fault = lexer(&format!("[ 0 {bad} ]")).integers().unwrap_err();
            assert_eq!(fault.range, 4..4 + bad.len(), "{bad}");
        }
    }
}
