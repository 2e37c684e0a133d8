//! Candidate removal sequences O_r, one after the other, for a planner that makes the motions itself
//! (section V-C): fewest objects first; what it finds impossible comes back.

use crate::direct::{Direct, Directly};
use crate::feasibility::{Feasibility, NoMotion};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};

/// The sequences by which one object can be had.
pub struct Candidates {
    direct: Direct,
    limit: usize,
    most: usize,
}

impl Candidates {
    pub fn new(arm: &Feasibility, target: ObjectId) -> Self {
        let count = arm.scene().objects.len();
        Self { direct: Direct::new(count, target, None), limit: 1, most: count }
    }

    /// The best that nothing speaks against, the target last; `None`: there is none left.
    pub fn best(&mut self, arm: &mut Feasibility, budget: &Budget) -> Result<Option<Vec<ObjectId>>, Stop> {
        loop {
            match self.direct.search(arm, &mut self.limit, budget)? {
                Directly::Objects(objects) => return Ok(Some(objects)),
                Directly::Nothing { next: Some(next) } if next <= self.most => self.limit = next.max(self.limit + 1),
                Directly::Nothing { .. } => return Ok(None),
            }
        }
    }

    /// An object could not be had with only these removed; rid of one of the blamed sets it may be.
    pub fn failed(&mut self, object: ObjectId, removed: ObjectSet, blamed: &[ObjectSet]) {
        let blamed = blamed.iter().map(|b| b.union(removed)).collect();
        self.direct.failed(NoMotion { object, removed, blamed });
    }
}
