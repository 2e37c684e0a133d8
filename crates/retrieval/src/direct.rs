//! Sequences along the arm's own ways, without the roadmap: the fewest objects over what is known of
//! every object's ways, which is looked into as the answers ask for it.
//!
//! Objects not looked into count as free to go, so an answer without any of them stands. Where there are
//! too many sets to find the fewest at once, few will do.

use crate::feasibility::{Feasibility, NoMotion};
use crate::order::{self, Fewest, WaysIn, most_in_way};
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};

/// Sets looked at for the fewest before few will do: milliseconds.
const MOST_SETS: usize = 1000;

/// What a limit's search came to.
pub enum Directly {
    /// These can be picked one after the other.
    Objects(Vec<ObjectId>),
    /// There is nothing of so few; the next limit that may change that, if any does.
    Nothing { next: Option<usize> },
}

pub struct Direct {
    target: ObjectId,
    /// No more will do.
    most: Option<usize>,
    ways: WaysIn,
    /// By object: ways with so many objects in them were looked into, and the least that was not.
    looked: Vec<Option<(usize, Option<usize>)>>,
    failures: Vec<NoMotion>,
    /// There are too many sets to find the fewest.
    many: bool,
}

impl Direct {
    pub fn new(count: usize, target: ObjectId, most: Option<usize>) -> Self {
        let free = vec![ObjectSet::EMPTY];
        Self { target, most, ways: vec![free; count], looked: vec![None; count], failures: Vec::new(), many: false }
    }

    /// For all of some objects rather than for one: it has them when they are gone. It counts as one more in limits.
    pub fn for_all(count: usize, wanted: ObjectSet) -> Self {
        let mut new = Self::new(count + 1, ObjectId(count as u16), None);
        new.ways[count] = vec![wanted];
        new.looked[count] = Some((usize::MAX, None));
        new
    }

    /// The fewest objects, at most `limit` of them with the target; where that is too much to ask, few,
    /// and the limit is raised to as many.
    pub fn search(&mut self, arm: &mut Feasibility, limit: &mut usize, budget: &Budget) -> Result<Directly, Stop> {
        // Those that came up before; ways that more objects stand in may count now.
        for index in 0..self.looked.len() {
            let object = ObjectId(index as u16);
            if self.looked[index].is_some_and(|(_, next)| next.is_some_and(|next| next <= self.in_way(object, *limit)))
            {
                self.look(arm, object, *limit, budget)?;
            }
        }
        loop {
            budget.check()?;
            let will_do = |set: &ObjectSet| self.most.is_none_or(|most| set.len() <= most);
            let few = order::few(&self.ways, self.target, budget)?.filter(will_do);
            let sets = if self.most.is_some() { order::THOROUGH } else { MOST_SETS };
            let found = match few {
                Some(set) if set.len() <= *limit || self.many => {
                    *limit = set.len().max(*limit);
                    set
                }
                _ => match order::fewest(&self.ways, &[], self.target, *limit, sets, budget)? {
                    Fewest::Found(set) => set,
                    Fewest::None { at_least } => {
                        let more = (0..self.looked.len()).filter_map(|i| {
                            let more = self.looked[i]?.1?;
                            Some(more + if i == self.target.index() { 1 } else { 2 })
                        });
                        let next = more.chain(at_least).min().map(|n| n.max(*limit + 1));
                        return Ok(Directly::Nothing { next });
                    }
                    Fewest::TooMany => {
                        self.many = true;
                        let Some(set) = few else { return Ok(Directly::Nothing { next: Some(*limit + 1) }) };
                        *limit = set.len().max(*limit);
                        set
                    }
                },
            };
            let shallow = |o: &ObjectId| match self.looked[o.index()] {
                None => true,
                Some((most, more)) => more.is_some() && most < self.in_way(*o, *limit),
            };
            let Some(object) = Some(self.target).filter(shallow).or_else(|| found.iter().find(shallow)) else {
                return Ok(Directly::Objects(self.arrange(arm, &found, budget)?));
            };
            self.look(arm, object, *limit, budget)?;
        }
    }

    /// The objects that came up so far.
    pub fn looked_into(&self) -> impl Iterator<Item = ObjectId> {
        (0..self.looked.len()).filter(|&i| self.looked[i].is_some()).map(|i| ObjectId(i as u16))
    }

    /// Nearest first, the target last if it is one of the scene's objects; for a base that drives the order in which it
    /// drives least.
    fn arrange(&self, arm: &mut Feasibility, set: &ObjectSet, budget: &Budget) -> Result<Vec<ObjectId>, Stop> {
        if let Some(order) = arm.itinerary(&self.ways, set, budget)? {
            return Ok(order);
        }
        let at = |o: ObjectId| arm.scene.objects.get(o.index()).map_or(arm.base(), |o| o.pose.translation.truncate());
        let from = |last: Option<ObjectId>| last.map_or(arm.base(), at);
        let mut order = order::arrange(&self.ways, set, |last, o| (o == self.target, at(o).distance(from(last))));
        order.retain(|o| o.index() < arm.scene.objects.len());
        Ok(order)
    }

    /// How many objects may stand in the way of an object in a sequence of at most `limit`.
    fn in_way(&self, object: ObjectId, limit: usize) -> usize {
        most_in_way(limit, object == self.target)
    }

    fn look(&mut self, arm: &mut Feasibility, object: ObjectId, limit: usize, budget: &Budget) -> Result<(), Stop> {
        let most = self.in_way(object, limit);
        let mut sets = arm.minimal_sets(object, most, budget)?;
        // The target goes last.
        sets.retain(|s| !s.contains(self.target));
        self.ways[object.index()] = sets;
        self.looked[object.index()] = Some((most, arm.least_beyond(object, most)));
        for i in 0..self.failures.len() {
            if self.failures[i].object == object {
                self.forget_what_failed(i);
            }
        }
        Ok(())
    }

    /// Takes in that no motion was found.
    pub fn failed(&mut self, failure: NoMotion) {
        self.failures.push(failure);
        self.forget_what_failed(self.failures.len() - 1);
    }

    /// Ways that were free in vain are none without something else gone: what was blamed, or what came up
    /// elsewhere.
    fn forget_what_failed(&mut self, failure: usize) {
        let NoMotion { object, removed, blamed } = &self.failures[failure];
        let counts = |o: &ObjectId| o != object && *o != self.target && !removed.contains(*o);
        let others: Vec<ObjectId> = self.looked_into().filter(counts).collect();
        let (vain, mut ways): (Vec<ObjectSet>, Vec<ObjectSet>) =
            std::mem::take(&mut self.ways[object.index()]).into_iter().partition(|w| w.is_subset(removed));
        ways.extend(vain.iter().flat_map(|w| others.iter().map(|o| w.with(*o))));
        ways.extend(blamed.iter().filter(|b| !b.contains(self.target) && !b.is_subset(removed)));
        self.ways[object.index()] = ObjectSet::minimal(ways);
    }
}
