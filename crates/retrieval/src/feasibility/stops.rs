//! Which of a mobile base's stops what is taken from.

use super::{Feasibility, Journey, stand_at};
use crate::mobile::itinerary::{Errand, Visit};
use crate::mobile::{self, Served};
use crate::order::WaysIn;
use crate::stand::Stand;
use clearway_plan::plan_file::SideWhy;
use clearway_plan::{Budget, ObjectId, ObjectSet, Stop};

impl Feasibility {
    /// Where a mobile base could stand round the target, where stops were chosen.
    pub(crate) fn sides(&self) -> Vec<SideWhy> {
        let chosen = self.base.as_ref().filter(|base| base.chosen);
        let Some((base, standing)) = chosen.and_then(|base| Some((base, base.model.standing.as_ref()?))) else {
            return Vec::new();
        };
        let served = Served::of(&self.scene, &self.stands[0].world, self.settings.loosely);
        base.sides(&standing.model.robot.home, &served, &standing.reachability)
    }

    /// Chooses the stops of a mobile base, if it has not been done.
    pub(crate) fn choose_stops(&mut self) {
        let Some(base) = self.base.as_mut().filter(|base| !base.chosen && base.settings.drives) else { return };
        let Some(standing) = base.model.standing.clone() else { return };
        base.chosen = true;
        let served = Served::of(&self.scene, &self.stands[0].world, self.settings.loosely);
        let home = &standing.model.robot.home;
        let (stops, sides) = mobile::choose(base, &self.scene, &served, &standing.reachability, home);
        base.sides = sides;
        for placement in stops {
            self.stands.push(stand_at(&self.scene, &standing.model, base, placement));
        }
        for stand in &mut self.stands {
            stand.spots = served.spots(&standing.reachability, &stand.world.world_from_root);
        }
    }

    /// From which stands the rest of a sequence is best taken, in that order: with the fewest moves of the
    /// base, and then the least driving.
    pub(super) fn stops_for(
        &mut self,
        objects: &[ObjectId],
        journey: &Journey,
        budget: &Budget,
    ) -> Result<Vec<usize>, Stop> {
        let kept = journey.carried.len();
        let left = &objects[kept..];
        if self.stands.len() == 1 {
            return Ok(vec![0; left.len()]);
        }
        let mut ways: Vec<WaysIn> = vec![vec![Vec::new(); self.scene.objects.len()]; self.stands.len()];
        let mut removed: ObjectSet = objects[..kept].iter().copied().collect();
        for &object in left {
            for (stand, ways) in ways.iter_mut().enumerate() {
                if !self.free_ways_from(stand, object, &removed, 1, budget)?.is_empty() {
                    ways[object.index()].push(removed);
                }
            }
            removed.insert(object);
        }
        let allowed = vec![vec![ObjectSet::EMPTY]; self.scene.objects.len()];
        let gone = objects[..kept].iter().copied().collect();
        let visits = self.errand(
            &ways,
            &allowed,
            left.iter().copied().collect(),
            gone,
            self.situation(journey).stand,
            left.last().copied(),
            budget,
        )?;
        let stop = |object: &ObjectId| visits.iter().flatten().find(|v| v.object == *object).map_or(0, |v| v.stop);
        Ok(left.iter().map(stop).collect())
    }

    /// The cheapest order of some objects, from several stands.
    #[allow(clippy::too_many_arguments)]
    fn errand(
        &self,
        ways: &[WaysIn],
        allowed: &WaysIn,
        objects: ObjectSet,
        gone: ObjectSet,
        start: usize,
        target: Option<ObjectId>,
        budget: &Budget,
    ) -> Result<Option<Vec<Visit>>, Stop> {
        let (Some(base), Some(target)) = (&self.base, target) else { return Ok(None) };
        let seconds = |a: &Stand, b: &Stand| base.seconds(&a.placement, &b.placement);
        let drives: Vec<Vec<f64>> =
            self.stands.iter().map(|a| self.stands.iter().map(|b| seconds(a, b)).collect()).collect();
        let puts: Vec<usize> =
            (0..self.stands.len()).map(|s| self.put_down_at(s).first().copied().unwrap_or(s)).collect();
        let weights = base.weights;
        Errand { ways, allowed, drives: &drives, puts: &puts, target, objects, gone, start, weights }.cheapest(budget)
    }

    /// Where what is taken at a stand may be put down: there if it has a place in reach, then the nearest ones.
    pub(super) fn put_down_at(&self, stand: usize) -> Vec<usize> {
        let Some(base) = &self.base else { return vec![stand] };
        let from = &self.stands[stand];
        let mut order: Vec<usize> = (0..self.stands.len()).filter(|&s| self.stands[s].spots > 0.0).collect();
        order.sort_by(|&a, &b| {
            let seconds =
                |s: usize| if s == stand { -1.0 } else { base.seconds(&from.placement, &self.stands[s].placement) };
            seconds(a).total_cmp(&seconds(b))
        });
        order
    }

    /// The cheapest order in which the objects of a set, or others known as well, lead to the target.
    pub(crate) fn itinerary(
        &mut self,
        allowed: &WaysIn,
        set: &ObjectSet,
        budget: &Budget,
    ) -> Result<Option<Vec<ObjectId>>, Stop> {
        if self.stands.len() == 1 {
            return Ok(None);
        }
        let mut ways: Vec<WaysIn> = vec![vec![Vec::new(); self.scene.objects.len()]; self.stands.len()];
        for object in set.iter() {
            for (stand, ways) in ways.iter_mut().enumerate() {
                let sets = self.minimal_sets_from(stand, object, set.len(), budget)?;
                ways[object.index()] = sets;
            }
        }
        let visits = self.errand(&ways, allowed, *set, ObjectSet::EMPTY, 0, Some(self.scene.target), budget)?;
        Ok(visits.map(|visits| visits.into_iter().map(|v| v.object).collect()))
    }
}
