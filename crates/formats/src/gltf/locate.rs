//! Position of a JSON pointer's value in the text. The text has been parsed before, so only its structure is followed.

/// First byte and end of the value that `pointer` leads to; `None` where it leads nowhere.
pub(super) fn value(text: &[u8], pointer: &str) -> Option<(usize, usize)> {
    let mut at = space(text, 0);
    for token in pointer.split('/').skip(1) {
        at = match text.get(at)? {
            b'{' => member(text, at + 1, &token.replace("~1", "/").replace("~0", "~"))?,
            b'[' => item(text, at + 1, token.parse().ok()?)?,
            _ => return None,
        };
    }
    let end = skip(text, at)?;
    // Of objects and arrays only the first line is marked.
    let line = text[at..end].iter().position(|b| *b == b'\n').map_or(end, |k| at + k);
    Some((at, line))
}

/// The byte at a line and column, both from 1.
pub(super) fn line(text: &[u8], line: usize, column: usize) -> usize {
    let start = match line.checked_sub(2) {
        None => 0,
        Some(before) => {
            text.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(before).map_or(text.len(), |(k, _)| k + 1)
        }
    };
    (start + column.saturating_sub(1)).min(text.len().saturating_sub(1))
}

fn space(text: &[u8], mut at: usize) -> usize {
    while text.get(at).is_some_and(|b| b.is_ascii_whitespace() || matches!(b, 0xef | 0xbb | 0xbf)) {
        at += 1;
    }
    at
}

/// After the string that begins at `at`.
fn string(text: &[u8], mut at: usize) -> Option<usize> {
    at += 1;
    loop {
        match text.get(at)? {
            b'"' => return Some(at + 1),
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
}

/// After the value that begins at `at`.
fn skip(text: &[u8], at: usize) -> Option<usize> {
    match text.get(at)? {
        b'"' => string(text, at),
        b'{' | b'[' => {
            let (mut depth, mut at) = (0usize, at);
            loop {
                match text.get(at)? {
                    b'"' => {
                        at = string(text, at)?;
                        continue;
                    }
                    b'{' | b'[' => depth += 1,
                    b'}' | b']' => depth -= 1,
                    _ => {}
                }
                at += 1;
                if depth == 0 {
                    return Some(at);
                }
            }
        }
        _ => {
            let rest = &text[at..];
            let length = rest.iter().position(|b| b",]}".contains(b) || b.is_ascii_whitespace()).unwrap_or(rest.len());
            Some(at + length)
        }
    }
}

/// The value of a member of the object whose inside begins at `at`; of several with one name the last, as the parser
/// has it.
fn member(text: &[u8], at: usize, name: &str) -> Option<usize> {
    let (mut at, mut found) = (space(text, at), None);
    while *text.get(at)? == b'"' {
        let end = string(text, at)?;
        let is_it = serde_json::from_slice::<String>(&text[at..end]).is_ok_and(|key| key == name);
        let value = space(text, space(text, end) + 1);
        if is_it {
            found = Some(value);
        }
        at = space(text, skip(text, value)?);
        if *text.get(at)? != b',' {
            break;
        }
        at = space(text, at + 1);
    }
    found
}

/// The item with a number of the array whose inside begins at `at`.
fn item(text: &[u8], at: usize, number: usize) -> Option<usize> {
    let mut at = space(text, at);
    for _ in 0..number {
        at = space(text, skip(text, at)?);
        if *text.get(at)? != b',' {
            return None;
        }
        at = space(text, at + 1);
    }
    (*text.get(at)? != b']').then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pointers_lead_to_their_values() {
        let text = br#"{ "a": [1, {"b\"]": "x,}", "c/d": [ ] }, null], "a~": -2.5e3 , "s":"q" }"#;
        let find = |p: &str| value(text, p).map(|(a, b)| std::str::from_utf8(&text[a..b]).unwrap());
        assert_eq!(find("/a/0"), Some("1"));
        assert_eq!(find("/a/1/b\"]"), Some(r#""x,}""#));
        assert_eq!(find("/a/1/c~1d"), Some("[ ]"));
        assert_eq!(find("/a/2"), Some("null"));
        assert_eq!(find("/a~0"), Some("-2.5e3"));
        assert_eq!(find("/s"), Some("\"q\""));
        for nowhere in ["/b", "/a/3", "/a/x", "/s/0", "/a/1/c~1d/0"] {
            assert_eq!(find(nowhere), None, "{nowhere}");
        }
        assert_eq!(line(b"ab\ncd\nef", 2, 2), 4);
        assert_eq!(line(b"ab", 9, 9), 1);
    }
}
