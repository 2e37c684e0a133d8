//! What `verify` finds.

use clearway::{Budget, PlanFile, verify};
use std::path::Path;

/// The violations; everything could be judged.
pub fn found_wrong(plan: &PlanFile) -> Vec<String> {
    let report = verify(plan, Path::new("."), &Budget::unlimited()).expect("a judgement");
    assert!(report.not_checked.is_empty(), "{:?}", report.not_checked);
    report.violations.iter().map(|v| v.to_string()).collect()
}
