//! The least room between what moves and what stands still, over the whole plan, and whether it is what
//! the scene asks and the plan claims.
//!
//! What moves: links, what is held, what is pushed; what stands still: fixtures and standing objects;
//! links besides, for what is held or pushed. Left out is all that may touch (see
//! [`watch`](crate::watch)), and an object near what carries it. A neighbour that is nearer to where an
//! object is taken or put than the scene asks limits what is asked of that pair: it must keep that
//! distance; it is left out of the least.
//!
//! Continuous, by the sweep's leases, which last until a pair can be nearer than the nearest found so
//! far: branch and bound. Exact to 0.1 mm, which is let pass, too. Costs about as much as looking for
//! touches. Metres, world frame.

use crate::carry::Stage;
use crate::case::{Case, Track};
use crate::error::CannotJudge;
use crate::gap::Gap;
use crate::report::{Place, Report, ViolationKind};
use crate::shapes::body_gap;
use crate::sweep::{self, Pair, Seek, When};
use crate::watch::{Owner, Watch};
use clearway_plan::PlanFile;
use clearway_plan::clearance::{Clearance, Least};
use clearway_plan::plan_file::SegmentKind;
use parry3d_f64::math::{Pose, Vector};

/// Larger distances are not looked for, unless the scene asks for more.
const UP_TO: f64 = 0.05;
/// So much less than asked is let pass; how exactly the least is found.
const TOLERANCE: f64 = 1e-4;
/// Within this of where it stood or is put, an object may be near what carries it.
const NEAR_REST: f64 = 0.03;
/// So much more than measured may be claimed.
const CLAIM: f64 = 2e-4;

/// What the scene asks for, metres.
pub(crate) fn asked(plan: &PlanFile) -> Result<f64, CannotJudge> {
    let asked = plan.scene.clearance.unwrap_or(0.0);
    if !asked.is_finite() || asked < 0.0 {
        let what = format!("{asked} m; expected a length, or 0");
        return Err(CannotJudge::Scene { place: "clearance".to_owned(), what });
    }
    Ok(asked)
}

/// What a segment's sweep is to look for.
pub(crate) fn seek<'a, 'p>(
    case: &Case,
    track: &Track,
    stage: &Stage,
    watch: &'p Watch<'a>,
    asked: f64,
) -> Search<'a, 'p> {
    let rooms = watch.subjects.iter().map(|subject| room(case, track, stage, *subject, asked)).collect();
    Search { pairs: &watch.pairs, rooms, best: asked.max(UP_TO), found: None, limited: Vec::new() }
}

/// Judges what was found, and leaves the measure in the report. A watch and a search for each track.
pub(crate) fn tell(
    plan: &PlanFile,
    case: &Case,
    (tracks, watches): (&[Track], &[Watch]),
    searches: &[&Search],
    asked: f64,
    report: &mut Report,
) {
    let mut nearest: Option<(Least, Place)> = None;
    let mut limited: Vec<(Place, String)> = Vec::new();
    for ((track, watch), search) in tracks.iter().zip(watches).zip(searches) {
        let nearer = |distance: f64| nearest.as_ref().is_none_or(|(least, _)| distance < least.distance);
        if let Some((subject, gap, when)) = search.found.filter(|(_, gap, _)| nearer(gap.distance)) {
            let (first, second) = watch.subjects[subject];
            let place = track.when(when);
            let least = Least {
                distance: gap.distance,
                step: track.step,
                segment: track.index,
                time: place.time,
                between: [first.says(case), second.says(case)],
                at: gap.point.to_array(),
            };
            nearest = Some((least, place));
        }
        for (subject, gap, when) in &search.limited {
            let (first, second) = watch.subjects[*subject];
            let keep = search.rooms[*subject].as_ref().and_then(|r| r.keep).unwrap_or(asked);
            let what = format!(
                "{} comes within {:.2} mm of {} at {}; where it is taken or put they are {:.2} mm apart",
                first.says(case),
                gap.distance * 1e3,
                second.says(case),
                sweep::point(gap.point),
                keep * 1e3
            );
            limited.push((track.when(*when), what));
        }
    }
    if let Some((least, place)) = &nearest
        && asked > 0.0
        && least.distance < asked - TOLERANCE
    {
        let what = format!(
            "{} comes within {:.2} mm of {} at {}; the scene asks for {:.2} mm",
            least.between[0],
            least.distance * 1e3,
            least.between[1],
            sweep::point(least.at.into()),
            asked * 1e3
        );
        report.at(ViolationKind::Clearance, *place, what);
    }
    for (place, what) in limited {
        report.at(ViolationKind::Clearance, place, what);
    }
    let measured = Clearance { asked, least: nearest.map(|(least, _)| least), up_to: asked.max(UP_TO) };
    check_claim(plan, &measured, report);
    report.clearance = Some(measured);
}

/// A plan may not claim more than there is.
fn check_claim(plan: &PlanFile, measured: &Clearance, report: &mut Report) {
    let Some(claim) = &plan.clearance else { return };
    let distance = |c: &Clearance| c.least.as_ref().map_or(c.up_to, |least| least.distance);
    let (claimed, found) = (distance(claim), distance(measured));
    if measured.least.is_some() && (claimed > found + CLAIM || claimed.is_nan()) {
        let what = format!("clearance.least claims {:.2} mm; there are {:.2} mm", claimed * 1e3, found * 1e3);
        report.plan(ViolationKind::Clearance, what);
    }
    if (claim.asked - measured.asked).abs() > TOLERANCE || claim.asked.is_nan() {
        let (claimed, asked) = (claim.asked * 1e3, measured.asked * 1e3);
        report.plan(
            ViolationKind::Clearance,
            format!("clearance.asked is {claimed:.2} mm; the scene asks for {asked:.2} mm"),
        );
    }
}

/// What is asked of a pair.
#[derive(Default)]
struct Room {
    /// As near as they are where the object is taken or put; else the pair counts to the least.
    keep: Option<f64>,
    /// With the object near one of these, the pair is left out: there the other carries it.
    carried_at: Vec<Vector>,
}

/// `None`: nothing is.
fn room(case: &Case, track: &Track, stage: &Stage, (first, second): (Owner, Owner), asked: f64) -> Option<Room> {
    match first {
        Owner::Link(_) if matches!(second, Owner::Link(_)) => None,
        Owner::Held(object) if second.stands() => {
            let held = stage.held.as_ref()?;
            let drawn = track.segment.kind == SegmentKind::Push;
            let ends = [&held.lifted_from, &held.put_on].map(|(pose, carriers)| (pose, &carriers[..]));
            object_room(case, stage, object, second, ends, drawn, asked)
        }
        Owner::Pushed(object) if second.stands() => {
            let pushed = stage.pushed.as_ref()?;
            let [from, to] = &pushed.ends;
            let ends = [(from, &pushed.carriers[..]), (to, &pushed.carriers[..])];
            object_room(case, stage, object, second, ends, true, asked)
        }
        _ => Some(Room::default()),
    }
}

/// Of an object against what stands; `ends` are where it is taken and put, and what carries it there.
/// `slides`: on what carries it, all along.
fn object_room(
    case: &Case,
    stage: &Stage,
    object: usize,
    other: Owner,
    ends: [(&Pose, &[String]); 2],
    slides: bool,
    asked: f64,
) -> Option<Room> {
    let (thing, at) = match other {
        Owner::Fixture(i) => (&case.fixtures[i], case.fixtures[i].pose),
        Owner::Object(i) => (&case.objects[i], stage.standing[i]?),
        Owner::Link(_) | Owner::Held(_) | Owner::Pushed(_) => return None,
    };
    let mut room = Room::default();
    for (end, carriers) in ends {
        if carriers.contains(&thing.id) {
            if slides {
                return None;
            }
            room.carried_at.push(end.translation);
        } else if asked > 0.0
            && let Some(gap) = body_gap(&case.objects[object].pieces, end, &thing.pieces, &at, asked)
            && gap.distance < asked
        {
            room.keep = Some(room.keep.unwrap_or(asked).min(gap.distance));
        }
    }
    Some(room)
}

/// The least room along one segment, looked for.
pub(crate) struct Search<'a, 'p> {
    pairs: &'p [Pair<'a>],
    /// By subject.
    rooms: Vec<Option<Room>>,
    /// The least distance so far.
    best: f64,
    /// Where it is, by subject, if in this segment.
    found: Option<(usize, Gap, When)>,
    /// Subjects that are nearer than they keep, once each, the nearest.
    limited: Vec<(usize, Gap, When)>,
}

impl Search<'_, '_> {
    /// The least distance known.
    pub fn best(&self) -> f64 {
        self.best
    }

    /// Only what is nearer than this matters from here on.
    pub fn nearer_than(&mut self, best: f64) {
        self.best = self.best.min(best);
    }

    fn keep(&self, pair: usize) -> Option<f64> {
        self.rooms[self.pairs[pair].subject].as_ref()?.keep
    }
}

impl Seek for Search<'_, '_> {
    fn below(&self, pair: usize) -> f64 {
        match &self.rooms[self.pairs[pair].subject] {
            None => f64::NEG_INFINITY,
            Some(room) => room.keep.map_or(self.best - TOLERANCE, |keep| keep - 0.5 * TOLERANCE),
        }
    }

    fn met(&mut self, pair: usize, gap: Gap, when: When, owner: &Pose) {
        if !self.counts(pair, owner) {
            return;
        }
        let subject = self.pairs[pair].subject;
        match self.keep(pair) {
            None if gap.distance < self.best => {
                self.best = gap.distance;
                self.found = Some((subject, gap, when));
            }
            Some(keep) if gap.distance < keep - TOLERANCE => {
                match self.limited.iter_mut().find(|(s, ..)| *s == subject) {
                    Some(known) if gap.distance < known.1.distance => *known = (subject, gap, when),
                    Some(_) => {}
                    None => self.limited.push((subject, gap, when)),
                }
            }
            _ => {}
        }
    }

    fn done(&self, pair: usize) -> bool {
        let subject = self.pairs[pair].subject;
        self.limited.iter().any(|(s, ..)| *s == subject)
    }

    fn counts(&self, pair: usize, owner: &Pose) -> bool {
        let room = self.rooms[self.pairs[pair].subject].as_ref();
        room.is_some_and(|r| r.carried_at.iter().all(|p| (*p - owner.translation).length() > NEAR_REST))
    }
}
