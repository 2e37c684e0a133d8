//! Did you mean …?

/// The candidate nearest to `name`, if one is near enough to be what was meant: at most a third of
/// the letters wrong. Case does not count.
pub fn closest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = letters(name);
    candidates
        .into_iter()
        .map(|candidate| (edits(&wanted, &letters(candidate)), candidate))
        .filter(|(edits, candidate)| *edits <= candidate.chars().count().max(wanted.len()).div_ceil(3))
        .min_by_key(|(edits, _)| *edits)
        .map(|(_, candidate)| candidate)
}

/// Names longer than this are cut: what is compared stays small whatever the file holds.
fn letters(name: &str) -> Vec<char> {
    name.chars().take(64).flat_map(char::to_lowercase).collect()
}

/// Letters to insert, delete, replace, or swap with the next one, to get from `a` to `b`.
fn edits(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = Vec::with_capacity(b.len() + 1);
        row.push(i + 1);
        for j in 0..b.len() {
            let mut least = (above[j] + usize::from(a[i] != b[j])).min(above[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_only() {
        let keys = ["radius", "height", "position"];
        assert_eq!(closest("raduis", keys), Some("radius"));
        assert_eq!(closest("Height", keys), Some("height"));
        assert_eq!(closest("hight", keys), Some("height"));
        assert_eq!(closest("colour", keys), None);
        assert_eq!(closest("o17", ["o1", "o3", "x"]), Some("o1"));
        assert_eq!(closest("x", []), None);
    }

    #[test]
    fn a_swap_is_one_edit() {
        let letters = |s: &str| s.chars().collect::<Vec<_>>();
        assert_eq!(edits(&letters("ab"), &letters("ba")), 1);
        assert_eq!(edits(&letters("kitten"), &letters("sitting")), 3);
        assert_eq!(edits(&[], &letters("abc")), 3);
    }
}
