//! The robot at one place: the scene as it is from there, and what was found out about reaching the
//! objects. A robot that does not drive has one stand, a mobile one several.

use crate::floor::Floor;
use crate::ways::{self, Explorer, Ways};
use clearway_collision::{Scratch, World};
use clearway_plan::{Budget, ObjectId, Stop};
use clearway_robot::{InverseKinematics, Placement};

/// What reaching is found out with, wherever the robot stands.
pub(crate) struct Tools<'a> {
    pub inverse: &'a InverseKinematics,
    pub floor: &'a Floor,
    pub settings: &'a ways::Settings,
    pub scratch: &'a mut Scratch,
}

#[derive(Clone, Debug)]
pub(crate) struct Stand {
    /// The values of a mobile base's joints; 0 for one that does not drive.
    pub placement: Placement,
    pub world: World,
    /// By object; what was found out about reaching it.
    pub ways: Vec<Option<Ways>>,
    /// Of a mobile base: how many spots to put things down are in reach, as far as was sampled.
    pub spots: f64,
}

impl Stand {
    pub fn new(placement: Placement, world: World) -> Self {
        let ways = vec![None; world.objects.len()];
        Self { placement, world, ways, spots: 0.0 }
    }

    /// Looks into an object's ways, which are found first if they were not.
    pub fn look<T>(
        &mut self,
        object: ObjectId,
        tools: Tools,
        budget: &Budget,
        into: impl FnOnce(&Explorer, &mut Ways, &mut Scratch) -> Result<T, Stop>,
    ) -> Result<T, Stop> {
        let explorer = Explorer {
            world: &self.world,
            inverse: tools.inverse,
            floor: tools.floor,
            settings: tools.settings,
            moved_to: None,
            empty: false,
        };
        let ways = match &mut self.ways[object.index()] {
            Some(ways) => ways,
            none => none.insert(explorer.explore(object, budget)?),
        };
        into(&explorer, ways, tools.scratch)
    }
}
