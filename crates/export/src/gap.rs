//! How far apart the pads of the hand are, by its table of openings.

use clearway_plan::plan_file::PlannedHand;

/// Metres, straight between the table's entries, and the nearest entry's beyond them; `None` for a joint that
/// is not the hand's, or without a table.
pub(crate) fn gap(hand: &PlannedHand, joint: &str, value: f64) -> Option<f64> {
    if hand.joint.as_deref() != Some(joint) {
        return None;
    }
    let entries = hand.opening.iter().map(|(at, gap)| Some((at.parse::<f64>().ok()?, *gap)));
    let mut table: Vec<(f64, f64)> = entries.collect::<Option<_>>()?;
    table.sort_by(|a, b| a.0.total_cmp(&b.0));
    let after = table.partition_point(|&(at, _)| at < value);
    let (before, after) = (after.checked_sub(1).and_then(|i| table.get(i)), table.get(after));
    match (before, after) {
        (Some((a, from)), Some((b, to))) => Some(from + (to - from) * (value - a) / (b - a)),
        (end, other) => end.or(other).map(|&(_, gap)| gap),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_lie_between_the_tables_entries() {
        let opening = [("0.0", 0.095), ("0.10", 0.08), ("0.65", 0.0)].map(|(at, gap)| (at.to_owned(), gap)).into();
        let hand = PlannedHand { joint: Some("finger".into()), opening, ..PlannedHand::default() };
        let close = |value, expected: f64| gap(&hand, "finger", value).is_some_and(|g| (g - expected).abs() < 1e-12);
        assert!(close(0.0, 0.095) && close(0.05, 0.0875) && close(0.1, 0.08) && close(0.65, 0.0));
        assert!(close(-1.0, 0.095) && close(1.0, 0.0));
        assert_eq!(gap(&hand, "thumb", 0.0), None);
        assert_eq!(gap(&PlannedHand { opening: [].into(), ..hand }, "finger", 0.0), None);
    }
}
