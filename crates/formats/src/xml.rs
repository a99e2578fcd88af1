//! From bytes to an XML tree: the checks that come before parsing, and the places of what is wrong.

use std::ops::Range;

/// Fault of an XML text: byte range and message.
#[derive(Debug, PartialEq)]
pub(crate) struct Fault {
    pub at: Range<usize>,
    pub message: String,
}

/// The text of an XML file: UTF-8, perhaps with a byte order mark, which is kept so that offsets stay those of the
/// file.
pub(crate) fn decode(bytes: &[u8]) -> Result<&str, Fault> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(Fault { at: 0..2, message: "the file is encoded in UTF-16; only UTF-8 is read".into() });
    }
    std::str::from_utf8(bytes).map_err(|e| {
        let at = e.valid_up_to();
        Fault { at: at..at + e.error_len().unwrap_or(1), message: "the file is not valid UTF-8".into() }
    })
}

/// Most attributes of one element. Real ones have five; the parser's time grows with the square of their number.
const MOST_ATTRIBUTES: usize = 1000;

/// Finds elements that are not closed, and refuses what would make parsing costly: elements nested deeper than `limit`
/// or with attributes without end, and document type declarations (whose entities can grow without bound). One pass
/// over the bytes; anything else that is malformed is left to the parser.
pub(crate) fn precheck(text: &str, limit: usize) -> Result<(), Fault> {
    let bytes = text.as_bytes();
    let find = |from: usize, what: &str| text.get(from..).and_then(|t| t.find(what)).map(|i| from + i + what.len());
    let mut at = 0;
    // The tags of the elements that are open.
    let mut elements: Vec<Range<usize>> = Vec::new();
    while let Some(open) = bytes[at..].iter().position(|&b| b == b'<').map(|i| at + i) {
        let rest = &bytes[open + 1..];
        let end = if rest.starts_with(b"!--") {
            find(open + 4, "-->")
        } else if rest.starts_with(b"![CDATA[") {
            find(open + 9, "]]>")
        } else if rest.starts_with(b"?") {
            find(open + 2, "?>")
        } else if rest.starts_with(b"!") {
            let message = "document type declarations are not read".into();
            return Err(Fault { at: open..(open + 9).min(bytes.len()), message });
        } else {
            let Some((end, attributes)) = tag_end(bytes, open + 1) else { return Ok(()) };
            if attributes > MOST_ATTRIBUTES {
                let message =
                    format!("an element with {attributes} attributes is not read; at most {MOST_ATTRIBUTES} are");
                return Err(Fault { at: open..open + 1, message });
            }
            if rest.starts_with(b"/") {
                if let Some(element) = elements.pop() {
                    let name = |tag: &Range<usize>, skip: usize| {
                        let text = text.get(tag.start + skip..tag.end).unwrap_or_default();
                        text.split(|c: char| c.is_whitespace() || c == '>').next().unwrap_or_default().to_owned()
                    };
                    let (opened, closed) = (name(&element, 1), name(&(open..end), 2));
                    if opened != closed {
                        let message = format!("<{opened}> is not closed: </{closed}> is found first");
                        return Err(Fault { at: element, message });
                    }
                }
            } else if bytes[end - 2] != b'/' {
                elements.push(open..end);
            }
            Some(end)
        };
        if elements.len() > limit {
            return Err(Fault { at: open..open + 1, message: format!("elements nest deeper than {limit} levels") });
        }
        let Some(end) = end else { return Ok(()) };
        at = end;
    }
    match elements.pop() {
        Some(element) => Err(Fault { at: element, message: "this element is not closed".into() }),
        None => Ok(()),
    }
}

/// One past the `>` that closes a tag, skipping quoted attribute values, and how many of these there are.
fn tag_end(bytes: &[u8], from: usize) -> Option<(usize, usize)> {
    let (mut quote, mut values) = (None, 0);
    for (i, &b) in bytes.iter().enumerate().skip(from) {
        match quote {
            Some(q) if b == q => {
                quote = None;
                values += 1;
            }
            Some(_) => {}
            None if b == b'"' || b == b'\'' => quote = Some(b),
            None if b == b'>' => return Some((i + 1, values)),
            None => {}
        }
    }
    None
}

/// Parses a text that passed [`precheck`].
pub(crate) fn parse(text: &str) -> Result<roxmltree::Document<'_>, Fault> {
    roxmltree::Document::parse(text).map_err(|e| {
        let pos = e.pos();
        let at = offset(text, pos.row, pos.col);
        let mut message = e.to_string();
        if let Some(i) = message.rfind(" at ") {
            message.truncate(i);
        }
        Fault { at: at..at + 1, message: format!("this is not well-formed XML: {message}") }
    })
}

/// The byte at a line and column, both counted from 1, columns in characters.
fn offset(text: &str, row: u32, column: u32) -> usize {
    let line_start: usize = text.split_inclusive('\n').take(row.saturating_sub(1) as usize).map(str::len).sum();
    let line = &text[line_start..];
    let in_line = line.char_indices().nth(column.saturating_sub(1) as usize).map_or(line.len(), |(i, _)| i);
    (line_start + in_line).min(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nesting_is_counted_and_bounded() {
        assert_eq!(precheck("<a><b/><!-- <c> --><c x='>'><d y=\"/>\"></d></c></a>", 3), Ok(()));
        let fault = precheck("<a><b/><c x='>'><d></d></c></a>", 2).unwrap_err();
        assert_eq!(fault.at, 16..17);
        let deep = "<a>".repeat(200_000);
        assert!(precheck(&deep, 10_000).unwrap_err().message.contains("10000"));
    }

    #[test]
    fn attributes_are_counted_and_bounded() {
        let with = |n: usize| format!("<a {}>", (0..n).map(|i| format!("b{i}='>' ")).collect::<String>()) + "</a>";
        assert_eq!(precheck(&with(MOST_ATTRIBUTES), 9), Ok(()));
        assert!(precheck(&with(MOST_ATTRIBUTES + 1), 9).unwrap_err().message.contains("1001 attributes"));
    }

    #[test]
    fn document_types_are_refused() {
        let bomb = "<!DOCTYPE x [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;\">]><scene>&b;</scene>";
        assert_eq!(precheck(bomb, 10).unwrap_err().at, 0..9);
    }

    #[test]
    fn malformed_text_is_located() {
        assert_eq!(parse("<a>\n  <b>\n</a>").unwrap_err().at, 10..11);
        assert!(parse("<a>").is_err());
        assert_eq!(decode(b"<a>\xff</a>").unwrap_err().at, 3..4);
        assert_eq!(offset("é\nßx", 2, 2), 5);
    }
}
