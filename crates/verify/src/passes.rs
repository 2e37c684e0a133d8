//! Along every segment, in one pass each: touches ([`collisions`](crate::collisions)) and the least room
//! ([`clearance`](crate::clearance)). On as many threads as the budget has; what comes of it does not depend on them.

use crate::carry::Stage;
use crate::case::{Case, Track};
use crate::clearance::{self, Search};
use crate::collisions;
use crate::error::CannotJudge;
use crate::report::Report;
use crate::sweep::Sweep;
use crate::sweep::touch::Touches;
use crate::watch::Watch;
use clearway_plan::{Budget, PlanFile, parallel};

/// Rows between first looks.
const SAMPLE: usize = 24;

/// One segment.
struct Pass<'a, 'p> {
    watch: &'p Watch<'a>,
    sweep: Sweep<'p>,
    touches: Touches<'a, 'p>,
    room: Search<'a, 'p>,
}

/// A stage and a watch for each track.
pub(crate) fn check(
    plan: &PlanFile,
    case: &Case,
    tracks: &[Track],
    stages: &[Stage],
    watches: &[Watch],
    budget: &Budget,
    report: &mut Report,
) -> Result<(), CannotJudge> {
    let asked = clearance::asked(plan)?;
    let pass = |((track, stage), watch)| Pass {
        watch,
        sweep: Sweep::new(case, track, &watch.movers),
        touches: collisions::seek(case, stage, watch),
        room: clearance::seek(case, track, stage, watch, asked),
    };
    let mut passes: Vec<Pass> = tracks.iter().zip(stages).zip(watches).map(pass).collect();
    let threads = budget.threads().min(passes.len());
    // A first idea of the least room makes short work of the rest.
    parallel::each(threads, &mut passes, |pass| pass.sweep.sample(&pass.watch.pairs, SAMPLE, &mut pass.room, budget))?;
    let first = passes.iter().map(|pass| pass.room.best()).fold(f64::INFINITY, f64::min);
    let found = parallel::each(threads, &mut passes, |pass| {
        pass.room.nearer_than(first);
        pass.sweep.run(&pass.watch.pairs, &mut [&mut pass.touches, &mut pass.room], budget)?;
        Ok::<_, CannotJudge>(pass.touches.deepest(&mut pass.sweep))
    })?;
    for ((track, pass), touches) in tracks.iter().zip(&passes).zip(&found) {
        report.checked.pairs += pass.watch.pairs.len();
        report.checked.distances += pass.sweep.distances;
        collisions::tell(case, track, pass.watch, touches, report);
    }
    let searches: Vec<&Search> = passes.iter().map(|pass| &pass.room).collect();
    clearance::tell(plan, case, (tracks, watches), &searches, asked, report);
    Ok(())
}
