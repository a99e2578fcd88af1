//! Starts of the lines of a text, found once so that each message is placed in logarithmic time.

/// Bytes between two counts of characters.
const BLOCK: usize = 4096;

/// The index of one text.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    /// Offset of the first byte of each line after the first.
    starts: Vec<u32>,
    /// For each block of [`BLOCK`] bytes, the characters that start before it.
    characters: Vec<u32>,
}

impl Lines {
    /// Scans a text. Lines past 4 GiB are not told apart: spans do not reach there.
    pub fn new(text: &[u8]) -> Self {
        let text = &text[..text.len().min(u32::MAX as usize)];
        let starts = text.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(i, _)| i as u32 + 1).collect();
        let mut sum = 0;
        let before = text.chunks(BLOCK).map(|block| {
            let before = sum;
            sum += characters(block);
            before
        });
        Self { characters: before.collect(), starts }
    }

    /// The line of an offset, from zero, and the offset where it starts.
    pub fn line(&self, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|&start| start as usize <= offset);
        (line, line.checked_sub(1).map_or(0, |before| self.starts[before] as usize))
    }

    /// The offset of the line feed that ends a line (from zero), or of the end of the text.
    pub fn end(&self, line: usize, text: &[u8]) -> usize {
        self.starts.get(line).map_or(text.len(), |&next| next as usize - 1)
    }

    /// Characters between two offsets of the indexed text. Bytes that continue a UTF-8 sequence do not count.
    pub fn characters(&self, text: &[u8], from: usize, to: usize) -> u32 {
        let before = |at: usize| {
            let block = (at / BLOCK).min(self.characters.len().saturating_sub(1));
            self.characters.get(block).map_or(0, |&n| n + characters(&text[block * BLOCK..at]))
        };
        before(to) - before(from)
    }
}

fn characters(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|&&b| b & 0xc0 != 0x80).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_have_the_lines_and_columns_of_a_scan() {
        let text = "aé\n\nmüß\n".repeat(3000);
        let bytes = text.as_bytes();
        let lines = Lines::new(bytes);
        for at in (0..=bytes.len()).filter(|&at| text.is_char_boundary(at)) {
            let start = text[..at].rfind('\n').map_or(0, |i| i + 1);
            assert_eq!(lines.line(at), (text[..at].matches('\n').count(), start), "{at}");
            assert_eq!(lines.characters(bytes, start, at), text[start..at].chars().count() as u32, "{at}");
        }
        assert_eq!(lines.end(0, bytes), 3);
        assert_eq!(lines.end(9000, bytes), bytes.len());
    }

    #[test]
    fn an_empty_text_has_one_line() {
        let lines = Lines::new(b"");
        assert_eq!((lines.line(0), lines.end(0, b""), lines.characters(b"", 0, 0)), ((0, 0), 0, 0));
    }
}
