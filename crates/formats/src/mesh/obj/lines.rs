//! Lines of OBJ and MTL files, with `\` at the end of a line continuing it on the next.

use crate::mesh::text::is_blank;
use std::borrow::Cow;

/// Goes through the statements of a text.
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        // A byte order mark is no part of the first statement.
        Self { bytes, at: if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 } }
    }

    /// The end of the line that starts at `at`, and where the next starts. CR alone ends a line too.
    #[inline]
    fn end(&self, at: usize) -> (usize, usize) {
        match self.bytes[at..].iter().position(|&b| matches!(b, b'\n' | b'\r')) {
            None => (self.bytes.len(), self.bytes.len()),
            Some(n) => {
                let end = at + n;
                let crlf = self.bytes[end] == b'\r' && self.bytes.get(end + 1) == Some(&b'\n');
                (end, end + 1 + usize::from(crlf))
            }
        }
    }
}

impl<'a> Iterator for Lines<'a> {
    /// Offset and text, without blanks in front; comments and empty lines are left out.
    type Item = (usize, Cow<'a, [u8]>);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        while self.at < self.bytes.len() {
            let start = self.at + self.bytes[self.at..].iter().position(|&b| !is_blank(b))?;
            let (end, next) = self.end(self.at.max(start.min(self.bytes.len())));
            self.at = next;
            let text = &self.bytes[start.min(end)..end];
            match text {
                [] | [b'#', ..] => {}
                [.., b'\\'] => return Some((start, Cow::Owned(self.join(text)))),
                _ => return Some((start, Cow::Borrowed(text))),
            }
        }
        None
    }
}

impl Lines<'_> {
    #[cold]
    fn join(&mut self, first: &[u8]) -> Vec<u8> {
        let mut joined = first[..first.len() - 1].to_vec();
        while self.at < self.bytes.len() {
            let (end, next) = self.end(self.at);
            let text = &self.bytes[self.at..end];
            self.at = next;
            joined.push(b' ');
            if let [more @ .., b'\\'] = text {
                joined.extend_from_slice(more);
            } else {
                joined.extend_from_slice(text);
                break;
            }
        }
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_joined_and_comments_left_out() {
        let text = b"  a 1\r\n# no\n\n\t\nb \\\n 2 \\\r\n 3\n \r c\\";
        let found: Vec<_> = Lines::new(text).map(|(at, l)| (at, String::from_utf8(l.into_owned()).unwrap())).collect();
        assert_eq!(found, [(2, "a 1".into()), (15, "b   2   3".into()), (text.len() - 2, "c".into())]);
        assert_eq!(Lines::new(b"").count() + Lines::new(b"\\").count(), 1);
    }
}
