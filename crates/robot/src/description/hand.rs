//! The hand: which links may touch what is gripped, and how far it opens.

use super::load::Context;
use clearway_files::{FileError, quoted};
use clearway_plan::robot_file::HandKind;

/// How far apart the pads of any hand may be, metres: more is a slip of the units.
const WIDEST: f64 = 2.0;

#[derive(Clone, Debug)]
pub struct Hand {
    pub kind: HandKind,
    /// The link whose frame is the tool: midway between the pads, z towards the object, x the way
    /// the fingers close; or the cup's centre, z out of the cup.
    pub frame: usize,
    /// What opens a parallel hand, as an index into the robot's joints.
    pub joint: Option<usize>,
    /// `(joint value, gap between the pads in metres)`, by rising joint value, straight between;
    /// empty for a suction cup.
    pub opening: Vec<(f64, f64)>,
    /// The only links that may touch what is gripped.
    pub links: Vec<usize>,
    /// Metres; r_base and r_f of the paper's Appendix B.
    pub base_radius: f64,
    pub finger_thickness: f64,
}

impl Hand {
    /// The widest gap between the pads, metres.
    pub fn widest(&self) -> f64 {
        self.opening.iter().map(|&(_, gap)| gap).fold(0.0, f64::max)
    }

    /// The joint value at which the hand is widest open.
    pub fn open(&self) -> f64 {
        self.joint_at(self.widest())
    }

    /// The joint values at which the hand is widest open, and closed.
    pub fn ends(&self) -> [f64; 2] {
        [self.open(), self.joint_at(0.0)]
    }

    /// The gap at a joint value; beyond the table's ends, that of the end.
    pub fn gap_at(&self, joint: f64) -> f64 {
        between(self.opening.iter().copied(), joint)
    }

    /// The joint value for a gap; beyond the table's ends, that of the end.
    pub fn joint_at(&self, gap: f64) -> f64 {
        let rising = self.opening.first().zip(self.opening.last()).is_none_or(|(a, b)| a.1 < b.1);
        let swapped = self.opening.iter().map(|&(joint, gap)| (gap, joint));
        if rising { between(swapped, gap) } else { between(swapped.rev(), gap) }
    }
}

/// Linear interpolation in a table with rising first entries.
fn between(table: impl Iterator<Item = (f64, f64)>, at: f64) -> f64 {
    let mut last: Option<(f64, f64)> = None;
    for (x, y) in table {
        match last {
            Some((x0, y0)) if at < x => return y0 + (y - y0) * ((at - x0) / (x - x0)).max(0.0),
            None if at <= x => return y,
            _ => last = Some((x, y)),
        }
    }
    last.map_or(0.0, |(_, y)| y)
}

/// Checks the robot file's `hand`; `arm` are the joints planned for.
pub fn check(context: &Context, arm: &[usize]) -> Result<Hand, FileError> {
    let file = context.file;
    let given = &file.value.hand;
    let frame = context.link(&["hand", "frame"], &given.frame)?;
    // What the arm's last joint carries: the hand must be part of it.
    let carried = |link: usize| {
        arm.last().is_some_and(|&last| context.joints_between(context.model.joints[last].child, link).is_some())
    };
    let not_carried = |keys: &[&str], name: &str| {
        file.error(keys, format!("link {} is not carried by the arm's last joint", quoted(name)))
            .help("the hand hangs from the arm's tip: check `arm.tip`, and where the URDF mounts the hand")
    };
    if !carried(frame) {
        return Err(not_carried(&["hand", "frame"], &given.frame));
    }
    if given.links.is_empty() {
        return Err(file.error(&["hand", "links"], "no links").expected("the links that may touch what is gripped"));
    }
    let mut links = Vec::with_capacity(given.links.len());
    for (i, name) in given.links.iter().enumerate() {
        let index = i.to_string();
        let keys = ["hand", "links", index.as_str()];
        let link = context.link(&keys, name)?;
        if !carried(link) {
            return Err(not_carried(&keys, name));
        }
        if links.contains(&link) {
            return Err(file
                .error(&keys, format!("link {} is listed twice", quoted(name)))
                .help("delete one of the two"));
        }
        links.push(link);
    }
    for (key, value) in [("base_radius", given.base_radius), ("finger_thickness", given.finger_thickness)] {
        if !(0.0..=WIDEST).contains(&value) {
            return Err(file.error(&["hand", key], format!("{value}")).expected(format!("metres, from 0 to {WIDEST}")));
        }
    }
    let (joint, opening) = match &given.kind {
        HandKind::Parallel => {
            let (joint, opening) = parallel(context, arm, frame)?;
            (Some(joint), opening)
        }
        HandKind::Suction { radius } => {
            suction(context, *radius)?;
            (None, Vec::new())
        }
    };
    Ok(Hand {
        kind: given.kind.clone(),
        frame,
        joint,
        opening,
        links,
        base_radius: given.base_radius,
        finger_thickness: given.finger_thickness,
    })
}

fn suction(context: &Context, radius: f64) -> Result<(), FileError> {
    let file = context.file;
    if !(radius > 0.0 && radius <= WIDEST) {
        return Err(file
            .error(&["hand", "kind"], format!("a cup of radius {radius}"))
            .expected("metres, greater than 0"));
    }
    let hand = &file.value.hand;
    for (key, given) in [("joint", hand.joint.is_some()), ("opening", !hand.opening.is_empty())] {
        if given {
            return Err(file
                .error(&["hand", key], format!("`{key}` for a suction cup"))
                .help("delete the key: a cup does not open"));
        }
    }
    Ok(())
}

fn parallel(context: &Context, arm: &[usize], frame: usize) -> Result<(usize, Vec<(f64, f64)>), FileError> {
    let file = context.file;
    let given = &file.value.hand;
    let Some(name) = &given.joint else {
        return Err(file
            .error(&["hand"], "a parallel hand without `joint`")
            .expected("the joint that opens it")
            .help("add `joint: NAME`; other joints follow it by <mimic> in the URDF"));
    };
    let keys = ["hand", "joint"];
    let joint = context.joint(&keys, name)?;
    let model = context.model;
    let wrong = |why: &str, help: &str| Err(file.error(&keys, format!("joint {} {why}", quoted(name))).help(help));
    if !model.joints[joint].moves() {
        return wrong("does not move", "name the joint that opens the hand");
    }
    if model.joints[joint].mimic.is_some() {
        return wrong("follows another by <mimic>", "name the joint that leads");
    }
    if arm.contains(&joint) {
        return wrong("is one of the arm's", "end the arm before the hand: check `arm.tip`");
    }
    let leader = |mut j: usize| {
        while let Some(mimic) = &model.joints[j].mimic {
            j = mimic.joint;
        }
        j
    };
    if context.joints_between(0, frame).unwrap_or_default().into_iter().any(|j| leader(j) == joint) {
        return Err(file
            .error(&["hand", "frame"], format!("link {} moves as the hand opens", quoted(&given.frame)))
            .expected("a link midway between the pads that stands still")
            .help("add such a link to the URDF, fixed to the hand's base"));
    }
    Ok((joint, opening(context, joint)?))
}

fn opening(context: &Context, joint: usize) -> Result<Vec<(f64, f64)>, FileError> {
    let file = context.file;
    let given = &file.value.hand.opening;
    let mut table = Vec::with_capacity(given.len());
    for (key, &gap) in given {
        let keys = ["hand", "opening", key.as_str()];
        let value: f64 = key.trim().parse().map_err(|_| {
            file.error(&keys, format!("the key {}", quoted(key))).expected("a joint value, such as `\"0.0\"`")
        })?;
        context.within(&keys, joint, value)?;
        if !(0.0..=WIDEST).contains(&gap) {
            return Err(file.error(&keys, format!("a gap of {gap}")).expected(format!("metres, from 0 to {WIDEST}")));
        }
        table.push((value, gap));
    }
    let whole = |found: String| file.error(&["hand", "opening"], found);
    if table.len() < 2 {
        return Err(whole(format!("{} entries", table.len()))
            .expected("two or more: joint value → gap between the pads")
            .help("give the gap at both ends of the joint's range: `opening: {\"0.0\": 0.08, \"0.7\": 0.0}`"));
    }
    table.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some([a, b]) = table.array_windows().find(|[a, b]| a.0 == b.0) {
        return Err(
            whole(format!("two gaps, {} and {}, at the joint value {}", a.1, b.1, a.0)).help("keep one of the two")
        );
    }
    let rises = table[1].1 > table[0].1;
    if let Some([a, b]) = table.array_windows().find(|[a, b]| if rises { a.1 >= b.1 } else { a.1 <= b.1 }) {
        return Err(whole(format!("the gap goes from {} at {} to {} at {}", a.1, a.0, b.1, b.0))
            .expected("a gap that only rises, or only falls, with the joint value"));
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hand(opening: &[(f64, f64)]) -> Hand {
        Hand {
            kind: HandKind::Parallel,
            frame: 0,
            joint: Some(0),
            opening: opening.to_vec(),
            links: vec![0],
            base_radius: 0.0,
            finger_thickness: 0.0,
        }
    }

    #[test]
    fn opening_is_straight_between_and_flat_beyond() {
        for table in [[(0.0, 0.1), (0.4, 0.06), (0.8, 0.0)], [(0.0, 0.0), (0.4, 0.04), (0.8, 0.1)]] {
            let hand = hand(&table);
            for (joint, gap) in table {
                assert_eq!(hand.gap_at(joint), gap);
                assert_eq!(hand.joint_at(gap), joint);
            }
            let middle = hand.gap_at(0.2);
            assert!((middle - (table[0].1 + table[1].1) / 2.0).abs() < 1e-12);
            assert!((hand.joint_at(middle) - 0.2).abs() < 1e-12);
            assert_eq!(hand.gap_at(-1.0), table[0].1);
            assert_eq!(hand.gap_at(9.0), table[2].1);
            assert_eq!(hand.joint_at(9.0), hand.open());
            assert_eq!(hand.widest(), 0.1);
        }
    }
}
