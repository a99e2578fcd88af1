//! Letters of 5 × 7 pixels, those of numbers and of photometric units.

/// Columns and rows of a letter; a column is left between two.
pub(super) const SIZE: [usize; 2] = [5, 7];

/// The letters, row by row.
const LETTERS: [(char, [&str; 7]); 20] = [
    ('0', [" ### ", "#   #", "#  ##", "# # #", "##  #", "#   #", " ### "]),
    ('1', ["  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "]),
    ('2', [" ### ", "#   #", "    #", "   # ", "  #  ", " #   ", "#####"]),
    ('3', ["#####", "   # ", "  #  ", "   # ", "    #", "#   #", " ### "]),
    ('4', ["   # ", "  ## ", " # # ", "#  # ", "#####", "   # ", "   # "]),
    ('5', ["#####", "#    ", "#### ", "    #", "    #", "#   #", " ### "]),
    ('6', ["  ## ", " #   ", "#    ", "#### ", "#   #", "#   #", " ### "]),
    ('7', ["#####", "    #", "   # ", "  #  ", " #   ", " #   ", " #   "]),
    ('8', [" ### ", "#   #", "#   #", " ### ", "#   #", "#   #", " ### "]),
    ('9', [" ### ", "#   #", "#   #", " ####", "    #", "   # ", " ##  "]),
    ('.', ["     ", "     ", "     ", "     ", "     ", " ##  ", " ##  "]),
    ('-', ["     ", "     ", "     ", "#####", "     ", "     ", "     "]),
    ('/', ["    #", "    #", "   # ", "  #  ", " #   ", "#    ", "#    "]),
    ('²', [" ##  ", "#  # ", "  #  ", " #   ", "#### ", "     ", "     "]),
    ('c', ["     ", "     ", " ### ", "#    ", "#    ", "#   #", " ### "]),
    ('d', ["    #", "    #", " ## #", "#  ##", "#   #", "#   #", " ####"]),
    ('e', ["     ", "     ", " ### ", "#   #", "#####", "#    ", " ### "]),
    ('l', [" ##  ", "  #  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "]),
    ('m', ["     ", "     ", "## # ", "# # #", "# # #", "#   #", "#   #"]),
    ('x', ["     ", "     ", "#   #", " # # ", "  #  ", " # # ", "#   #"]),
];

/// Pixels of a text, from its left top; letters that are not there are blank.
pub(super) fn pixels(text: &str) -> impl Iterator<Item = [usize; 2]> {
    text.chars().enumerate().flat_map(|(at, letter)| {
        let rows = LETTERS.iter().find(|l| l.0 == letter).map_or(&[""; 7], |l| &l.1);
        rows.iter().enumerate().flat_map(move |(y, row)| {
            let dots = row.bytes().enumerate().filter(|d| d.1 == b'#');
            dots.map(move |(x, _)| [at * (SIZE[0] + 1) + x, y])
        })
    })
}

/// Columns of a text.
pub(super) fn width(text: &str) -> usize {
    (text.chars().count() * (SIZE[0] + 1)).saturating_sub(1)
}
