//! Words in the languages of generated files, such that no word breaks out of its place.

/// A word of a POSIX shell: all between single quotes stands for itself. Plain words need none.
pub fn shell(word: &str) -> String {
    let is_plain = |b: u8| b.is_ascii_alphanumeric() || b"/._,:+-".contains(&b);
    if !word.is_empty() && word.bytes().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// A command of a POSIX shell.
pub fn command<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(shell).collect::<Vec<_>>().join(" ")
}

/// A string of YAML, TOML, Python or JavaScript within double quotes, in printable ASCII: the escapes `\"`, `\\`,
/// `\uXXXX` and, for what lies beyond (not in JavaScript), `\UXXXXXXXX` mean the same in these.
pub fn double(word: &str) -> String {
    let mut text = String::from('"');
    for c in word.chars() {
        match c {
            '"' | '\\' => text.extend(['\\', c]),
            ' '..='~' => text.push(c),
            c if u32::from(c) < 0x10000 => text.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => text.push_str(&format!("\\U{:08x}", u32::from(c))),
        }
    }
    text.push('"');
    text
}

/// A list of such strings, as YAML, TOML and Python write it.
pub fn list<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    format!("[{}]", words.into_iter().map(double).collect::<Vec<_>>().join(", "))
}

/// An argument of a container, in which Kubernetes replaces `$(NAME)`: two `$` stand for one.
pub fn container(word: &str) -> String {
    word.replace('$', "$$")
}

/// Fills the `@NAME@` of a template with values, which are not looked through again.
pub fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut text = String::new();
    let mut parts = template.split('@');
    text.push_str(parts.next().unwrap_or_default());
    while let Some(name) = parts.next() {
        match values.iter().find(|value| value.0 == name) {
            Some((_, value)) => {
                text.push_str(value);
                text.push_str(parts.next().unwrap_or_default());
            }
            None => {
                text.push('@');
                text.push_str(name);
            }
        }
    }
    text
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use std::process::{Command, Stdio};

    /// Words that break careless quotes.
    pub const ODD: &str = "a b'c\"d\\e$HOME$(id)`id`\n%{x}@JOB@#é\u{85}\u{2028}\u{1f37a}\u{7f}\t{{ }}*";

    /// Output of a program; `None` where it is not there.
    pub fn said(program: &str, arguments: &[&str]) -> Option<String> {
        let output = Command::new(program).args(arguments).stdin(Stdio::null()).output().ok()?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(String::from_utf8(output.stdout).unwrap())
    }

    #[test]
    fn shells_read_the_word() {
        assert_eq!(shell("it's"), r"'it'\''s'");
        assert_eq!(command(["a/b.exr", "", "c d", "~"]), "a/b.exr '' 'c d' '~'");
        let read = said("sh", &["-c", &format!("printf %s {}", shell(ODD))]);
        assert!(read.is_none_or(|read| read == ODD));
    }

    /// JSON has the same escapes up to U+FFFF, so its reader decides there; Python, where it is, decides the rest.
    #[test]
    fn double_quotes_read_the_word() {
        let low: String = ODD.chars().filter(|c| u32::from(*c) < 0x10000).collect();
        assert_eq!(serde_json::from_str::<String>(&double(&low)).unwrap(), low);
        assert!(double(ODD).bytes().all(|b| (b' '..=b'~').contains(&b)));
        assert_eq!(double("\u{1f37a}"), r#""\U0001f37a""#);
        let code = format!("import sys; sys.stdout.buffer.write({}.encode())", double(ODD));
        assert!(said("python3", &["-c", &code]).is_none_or(|read| read == ODD));
        assert_eq!(list(["a", "b\""]), r#"["a", "b\""]"#);
    }

    #[test]
    fn containers_expand_nothing() {
        assert_eq!(container("$(JOB_COMPLETION_INDEX) $"), "$$(JOB_COMPLETION_INDEX) $$");
    }

    #[test]
    fn templates_are_filled_once() {
        assert_eq!(fill("a=@A@ b=@B@ me@home @A@", &[("A", "@B@"), ("B", "2")]), "a=@B@ b=2 me@home @B@");
    }
}
