//! Goals that are proved to be out of reach: something has to be moved for them that never can be.

use crate::needs::Needs;
use crate::search::NoPlan;
use clearway_plan::{Budget, ObjectSet, Stop};
use clearway_retrieval::handling::Handling;

impl Needs<'_> {
    /// What has to be moved, and no way to it was found.
    pub fn without_way(&self, handling: &mut Handling, budget: &Budget) -> Result<ObjectSet, Stop> {
        let mut without = ObjectSet::EMPTY;
        for object in self.needed.iter() {
            if handling.has_no_way(object, budget)? {
                without.insert(object);
            }
        }
        Ok(without)
    }

    /// Ends with an error where one of some objects has to be moved and is proved never to be.
    pub fn prove_of(&self, some: ObjectSet, handling: &mut Handling, budget: &Budget) -> Result<(), NoPlan> {
        for object in some.intersection(self.needed).iter() {
            let stuck = handling.proved_stuck(object, budget)?;
            if !stuck.is_empty() {
                let needed = ObjectSet::of(object);
                return Err(NoPlan::Stuck { needed, others: stuck.difference(needed) });
            }
        }
        Ok(())
    }

    /// The same of whatever cannot be moved, be it one thing or several of which one has to be.
    pub fn prove(&self, handling: &mut Handling, budget: &Budget) -> Result<(), NoPlan> {
        if self.necessity.is_none() {
            return Ok(());
        }
        let suspects = handling.seem_stuck(budget)?;
        self.prove_of(suspects, handling, budget)?;
        let mut stuck = ObjectSet::EMPTY;
        for object in suspects.difference(self.needed).iter() {
            if !handling.proved_stuck(object, budget)?.is_empty() {
                stuck.insert(object);
            }
        }
        if !self.forbidden_by(stuck) {
            return Ok(());
        }
        // Those that do not matter for it are not told.
        let needed = stuck.iter().fold(stuck, |needed, object| {
            let fewer = needed.difference(ObjectSet::of(object));
            if self.forbidden_by(fewer) { fewer } else { needed }
        });
        Err(NoPlan::Stuck { needed, others: ObjectSet::EMPTY })
    }
}
