//! Goals that are reached by removals alone: all that has to be moved goes to places, as the target of a retrieval does,
//! and so does what stands in the way. No symbols are needed for that but to see that it is so.

use crate::necessity::{Known, Stands};
use crate::needs::Needs;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};
use clearway_retrieval::carry::Carried;
use clearway_retrieval::handling::Handling;
use std::collections::BTreeMap;
use std::time::Duration;

impl Needs<'_> {
    /// A plan of removals alone, if the goal is such a one and motions are found soon, and the time that motions took.
    pub fn by_removals(
        &self,
        handling: &mut Handling,
        budget: &Budget,
    ) -> Result<Option<(Vec<Carried>, Duration)>, Stop> {
        let Some(necessity) = &self.necessity else { return Ok(None) };
        let places: Vec<String> = handling.scene().places.iter().map(|place| place.id.clone()).collect();
        let on = |place: usize| Stands::On(vec![places[place].as_str()]);
        // Wherever the others are, it may not be on one of the others.
        let may_be_on = |object: ObjectId, place: usize| {
            let known = Known::from([(self.names[object.index()].as_str(), on(place))]);
            necessity.value(self.asked.goal, &known) != Some(false)
        };
        let allowed =
            |object: ObjectId| -> Vec<usize> { (0..places.len()).filter(|place| may_be_on(object, *place)).collect() };
        let allowed: BTreeMap<ObjectId, Vec<usize>> = self.needed.iter().map(|o| (o, allowed(o))).collect();
        let mut known: Known = self.names.iter().map(|name| (name.as_str(), Stands::AtFirst)).collect();
        for (object, allowed) in &allowed {
            let Some(first) = allowed.first() else { return Ok(None) };
            known.insert(&self.names[object.index()], on(*first));
        }
        if necessity.value(self.asked.goal, &known) != Some(true) {
            return Ok(None);
        }
        // What stands in the way may have to stay.
        let may_go = |objects: ObjectSet| {
            let mut known = known.clone();
            let others = objects.difference(self.needed);
            (0..places.len()).any(|place| {
                others.iter().for_each(|o| {
                    known.insert(&self.names[o.index()], on(place));
                });
                necessity.value(self.asked.goal, &known) == Some(true)
            })
        };
        let found = handling.put_on_places(self.needed, allowed, may_go, budget)?;
        let reached = found.filter(|(carried, _)| self.holds_after(carried, handling, known));
        if reached.is_none() {
            handling.hold_loosely();
        }
        Ok(reached)
    }

    /// Whether the goal holds where some objects were carried to, and the others are as known: places may overlap.
    fn holds_after<'k>(&'k self, carried: &[Carried], handling: &'k Handling, mut known: Known<'k>) -> bool {
        for Carried { step, after, .. } in carried {
            let Some(object) = handling.scene().object(&step.object) else { return false };
            let at = after.placed.iter().rev().find(|(placed, _)| *placed == object);
            let under = at.map_or(Vec::new(), |(_, at)| handling.places_under(object, at));
            let places = &handling.scene().places;
            let on = under.into_iter().map(|place| places[place].id.as_str()).collect();
            known.insert(&self.names[object.index()], Stands::On(on));
        }
        self.necessity.as_ref().is_some_and(|necessity| necessity.value(self.asked.goal, &known) == Some(true))
    }
}
