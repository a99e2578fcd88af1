//! Numbers and words in text files.

/// The text as UTF-8, where it has the byte order mark of UTF-16; else as it stands.
pub(crate) fn to_utf8(bytes: Vec<u8>) -> Vec<u8> {
    let unit = match bytes.get(..2) {
        Some(b"\xff\xfe") => u16::from_le_bytes,
        Some(b"\xfe\xff") => u16::from_be_bytes,
        _ => return bytes,
    };
    let units = bytes[2..].chunks_exact(2).map(|c| unit([c[0], c[1]]));
    let mut text = String::with_capacity(bytes.len() / 2);
    text.extend(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
    text.into_bytes()
}

/// Blank, tab and the other separators within a line.
#[inline]
pub(crate) fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}

/// White space between values where lines do not matter.
#[inline]
pub(crate) fn is_space(b: u8) -> bool {
    is_blank(b) || b == b'\n'
}

/// The text without blanks at either end.
pub(crate) fn trim(mut s: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = s
        && is_space(*first)
    {
        s = rest;
    }
    while let [rest @ .., last] = s
        && is_space(*last)
    {
        s = rest;
    }
    s
}

/// The parts between blanks.
pub(crate) fn words(s: &[u8]) -> impl Iterator<Item = &[u8]> {
    s.split(|&b| is_space(b)).filter(|w| !w.is_empty())
}

/// A whole word as a number. Exponents that lack their letter (`3.1+e2`) are understood.
#[inline]
pub(crate) fn float(word: &[u8]) -> Option<f32> {
    match fast_float2::parse_partial::<f32, _>(word) {
        Ok((v, n)) if n == word.len() => Some(v),
        Ok((_, n)) => swapped_exponent(word, n),
        Err(_) => None,
    }
}

/// A whole word as a number in double precision.
pub(crate) fn double(word: &[u8]) -> Option<f64> {
    match fast_float2::parse_partial::<f64, _>(word) {
        Ok((v, n)) if n == word.len() => Some(v),
        _ => None,
    }
}

/// `3.1+e2`, which some exporters write for `3.1e+2`.
#[cold]
fn swapped_exponent(word: &[u8], mantissa: usize) -> Option<f32> {
    let (head, tail) = word.split_at(mantissa);
    let (sign, digits) = match tail {
        [s @ (b'+' | b'-'), b'e' | b'E', digits @ ..] => (*s, digits),
        _ => return None,
    };
    let spelt = [head, b"e", &[sign], digits].concat();
    fast_float2::parse(spelt).ok()
}

/// A whole word as an integer with an optional sign; `None` for anything else and past 18 digits.
#[inline]
pub(crate) fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0i64;
    for &b in digits {
        let digit = b.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = value * 10 + i64::from(digit);
    }
    Some(if negative { -value } else { value })
}

/// At most `n` bytes of a word, for messages.
pub(crate) fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&word[..word.len().min(LONGEST)]).into_owned();
    if word.len() > LONGEST { text + "…" } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_all_their_spellings() {
        for (word, value) in
            [("1", 1.0), ("+2.", 2.0), ("-.5", -0.5), ("1e2", 100.0), ("3.1+e2", 310.0), ("31-E1", 3.1), ("2.E1", 20.0)]
        {
            assert_eq!(float(word.as_bytes()), Some(value), "{word}");
        }
        for word in ["", "x", "1x", "1e", "1+", "1+e", "--1", "1,5"] {
            assert_eq!(float(word.as_bytes()), None, "{word}");
        }
        assert_eq!(integer(b"-12"), Some(-12));
        assert_eq!(integer(b"+7"), Some(7));
        for word in ["", "-", "1.0", "9999999999999999999999", "1a"] {
            assert_eq!(integer(word.as_bytes()), None, "{word}");
        }
    }

    #[test]
    fn utf_16_becomes_utf_8() {
        let text = "v 1 2 3\nusemtl Weiß 𝄞\n";
        let encoded = |mark: [u8; 2], bytes: fn(u16) -> [u8; 2]| {
            mark.into_iter().chain(text.encode_utf16().flat_map(bytes)).collect::<Vec<u8>>()
        };
        assert_eq!(to_utf8(encoded([0xff, 0xfe], u16::to_le_bytes)), text.as_bytes());
        assert_eq!(to_utf8(encoded([0xfe, 0xff], u16::to_be_bytes)), text.as_bytes());
        assert_eq!(to_utf8(text.into()), text.as_bytes());
        // Half a pair, and half a unit.
        assert_eq!(to_utf8(vec![0xff, 0xfe, b'v', 0, 0x00, 0xd8, b'x']), "v\u{fffd}".as_bytes());
        assert_eq!(to_utf8(vec![0xff]), [0xff]);
    }

    #[test]
    fn blanks_are_trimmed() {
        assert_eq!(trim(b" \t a b \r\n"), b"a b");
        assert_eq!(trim(b"  "), b"");
        assert_eq!(words(b" a  b\t").collect::<Vec<_>>(), [b"a", b"b"]);
    }
}
