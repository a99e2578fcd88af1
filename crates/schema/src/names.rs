//! "Did you mean …?"

/// The optimal-string-alignment distance (insertions, deletions, substitutions, swaps of neighbours), case folded.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().flat_map(char::to_lowercase).take(64).collect();
    let b: Vec<char> = b.chars().flat_map(char::to_lowercase).take(64).collect();
    let mut rows = [vec![0; b.len() + 1], (0..=b.len()).collect::<Vec<_>>(), vec![0; b.len() + 1]];
    for i in 1..=a.len() {
        let (two_back, one_back) = (rows[0].clone(), rows[1].clone());
        let row = &mut rows[2];
        row[0] = i;
        for j in 1..=b.len() {
            let cost = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (one_back[j] + 1).min(row[j - 1] + 1).min(one_back[j - 1] + cost);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(two_back[j - 2] + 1);
            }
        }
        rows.rotate_left(1);
    }
    rows[1][b.len()]
}

/// Most names that a misspelt one is compared with: what comes after them is not offered.
const COMPARED: usize = 10_000;

/// The known name nearest to a misspelt one, if any is near enough to be worth offering; else the shortest that begins
/// with it.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let limit = (length / 3).max(1) + 1;
    let folded = name.to_lowercase();
    let mut begun: Option<&str> = None;
    let near = known
        .into_iter()
        .inspect(|k| {
            let is_begun = length >= 3 && k.len() > name.len() && k.to_lowercase().starts_with(&folded);
            if is_begun && begun.is_none_or(|b| (k.len(), *k) < (b.len(), b)) {
                begun = Some(k);
            }
        })
        // Each character more or less is an edit of its own.
        .filter(|k| k.chars().count().abs_diff(length) <= limit)
        .take(COMPARED)
        .map(|k| (distance(name, k), k))
        .filter(|&(d, _)| d <= limit)
        .min_by_key(|&(d, k)| (d, k))
        .map(|(_, k)| k);
    near.or(begun)
}

/// `did you mean 'x'?` for the nearest known name.
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(name, known).map(|k| format!("did you mean '{k}'?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let known = ["diffuse", "conductor", "dielectric", "coateddiffuse"];
        assert_eq!(nearest("difuse", known), Some("diffuse"));
        assert_eq!(nearest("dielctric", known), Some("dielectric"));
        assert_eq!(nearest("Conducter", known), Some("conductor"));
        assert_eq!(nearest("banana", known), None);
        assert_eq!((nearest("Coated", known), nearest("co", known)), (Some("coateddiffuse"), None));
        assert_eq!(distance("ab", "ba"), 1);
        assert_eq!(distance("", "abc"), 3);
    }
}
