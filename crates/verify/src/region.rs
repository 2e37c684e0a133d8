//! Where a mobile base may drive.

use crate::case::{Case, Track};
use crate::names::Names;
use crate::report::{Report, ViolationKind};
use clearway_plan::PlanFile;

/// Metres that the base may leave its region by: rounding.
const SAME: f64 = 1e-6;

/// The first link with a shape stays inside `scene.robot.region`, at every row.
pub(crate) fn check(plan: &PlanFile, case: &Case, names: &Names, tracks: &[Track], report: &mut Report) {
    let Some(region) = plan.scene.robot.region else { return };
    let Some(base) = case.model.links.iter().position(|l| !l.pieces.is_empty()) else { return };
    let above = case.model.moving_joints_above(base);
    if !above.iter().any(|j| names.columns.contains(j)) {
        return;
    }
    for track in tracks {
        let outside = |posture: &Vec<f64>| {
            let at = case.link_poses(posture)[base].translation;
            let out = |v: f64, i: usize| v < region.min[i] - SAME || v > region.max[i] + SAME;
            (out(at.x, 0) || out(at.y, 1)).then_some(at)
        };
        if let Some((row, at)) = track.postures.iter().enumerate().find_map(|(row, p)| Some((row, outside(p)?))) {
            let name = &case.model.links[base].name;
            report.at(
                ViolationKind::Region,
                track.at(row),
                format!("{name} is at ({:.3}, {:.3}), outside the region", at.x, at.y),
            );
        }
    }
}
