//! Draws scenes after the paper's recipes (section VI-B), and rejects the easy ones.
//!
//! A draw is rejected when the target can be had with fewer removals than asked for; without asking,
//! when it can be had directly. That is decided by the planner itself, with the arm. Large scenes are
//! also rejected when it takes more than twice as many, as far as can be told. Everything comes from the seed.

mod cabinet;
mod occluded;
mod stacked;
mod table;

pub use cabinet::ROBOT;

use cabinet::Recipe;
use clearway_collision::CollisionModel;
use clearway_plan::event::Silent;
use clearway_plan::plan_file::Status;
use clearway_plan::{Budget, ObjectId, ObjectSet, SceneFile};
use clearway_retrieval::{Planner, Request, Settings, Unfit, mobile, order};
use clearway_robot::Robot;
use clearway_scene::Scene;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Wanted {
    pub objects: usize,
    pub seed: u64,
    /// The target included. Default: 2 where there are at least two objects.
    pub least_removals: Option<usize>,
}

/// A scene drawn.
#[derive(Clone, Debug)]
pub struct Drawn {
    pub file: SceneFile,
    /// Draws rejected before it.
    pub rejected: usize,
    /// False when the draws allowed were spent and an easier scene was kept.
    pub as_wanted: bool,
}

/// Why there is no scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoScene {
    /// So many objects do not fit; about this many did.
    DoesNotFit {
        fitted: usize,
    },
    /// More removals asked for than there are objects.
    TooManyRemovals,
    NoObjects,
    /// The scene drawn was refused: an internal error.
    Unsound(String),
}

impl std::fmt::Display for NoScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::DoesNotFit { fitted } => {
                write!(f, "so many objects do not fit into the largest cabinet: {fitted} did; ask for fewer")
            }
            Self::TooManyRemovals => write!(f, "the least number of removals is larger than the number of objects"),
            Self::NoObjects => write!(f, "a scene needs at least one object, the target"),
            Self::Unsound(why) => write!(f, "the scene drawn is not sound: {why}"),
        }
    }
}

/// Draws before an easier scene is kept.
const MOST_DRAWS: usize = 400;

/// A cluttered shelf with a UR10 in front (section VI-B).
pub fn shelf(wanted: &Wanted) -> Result<Drawn, NoScene> {
    draw(&cabinet::shelf(wanted.objects), wanted)
}

/// A shelf with up to 100 objects and more (section VI-F).
pub fn large(wanted: &Wanted) -> Result<Drawn, NoScene> {
    draw(&cabinet::large(), wanted)
}

/// A shelf in which most objects are hidden behind others, the target too unless it is alone, before a camera; it can
/// be had by who knows them all. `least_removals` is not looked at.
pub fn occluded(wanted: &Wanted) -> Result<Drawn, NoScene> {
    let draw = |random: &mut Xoshiro256PlusPlus| occluded::draw(wanted.objects, random);
    draw_until(wanted, occluded::ROBOT, "occluded", draw, |scene, model| {
        let mut planner = Planner::with_model(scene, model, Settings::default()).map_err(unsound)?;
        Ok(planner.plan(&Request::new(1, guarded()), &mut Silent).plan.status == Status::Solved)
    })
}

/// A table with a PR2 at one of its sides (section VI-D), objects drawn uniformly: scenes in which fewer than
/// `least_removals` suffice are rejected, without it none. `contrast`: only those are kept in which two or more have to
/// be removed besides the target as long as the base stands where it is, and one if it drives.
pub fn table(wanted: &Wanted, contrast: bool) -> Result<Drawn, NoScene> {
    let least = wanted.least_removals.unwrap_or(1);
    if wanted.objects > 0 && least > wanted.objects {
        return Err(NoScene::TooManyRemovals);
    }
    let draw = |random: &mut Xoshiro256PlusPlus| table::draw(wanted.objects, random);
    draw_until(wanted, table::ROBOT, "table", draw, |scene, model| {
        if contrast {
            let fixed = mobile::Settings { drives: false, ..mobile::Settings::default() };
            let has =
                |most: usize, mobile: &mobile::Settings| can_be_planned(scene.clone(), model.clone(), most, mobile);
            let driving = mobile::Settings::default();
            return Ok(!has(2, &fixed)? && has(2, &driving)? && !has(1, &driving)? && has(wanted.objects, &fixed)?);
        }
        Ok(least <= 1 || !fewer_suffice(scene, model, least)?)
    })
}

/// A shelf with two objects before the target and a third on both (section VI-E, Fig. 10), and others aside. Without
/// `least_removals` only scenes are kept in which the one on top goes, one of the two, and the target; with it, those
/// in which fewer do not suffice.
pub fn stacked(wanted: &Wanted) -> Result<Drawn, NoScene> {
    let least = wanted.least_removals.unwrap_or(3.min(wanted.objects));
    if wanted.objects > 0 && least > wanted.objects {
        return Err(NoScene::TooManyRemovals);
    }
    let figure = RefCell::new((None, Vec::new()));
    let draw = |random: &mut Xoshiro256PlusPlus| {
        let stacked::Figure { file, top, below } = stacked::draw(wanted.objects, random)?;
        *figure.borrow_mut() = (top, below);
        Ok(file)
    };
    let as_wanted = |scene: Scene, model: Arc<CollisionModel>| {
        if wanted.least_removals.is_some() || wanted.objects < 4 {
            return Ok(least <= 1 || !fewer_suffice(scene, model, least)?);
        }
        let target = scene.target;
        let name = |o: ObjectId| scene.names[o.index()].clone();
        let mut planner = Planner::with_model(scene.clone(), model, Settings::default()).map_err(unsound)?;
        let (top, below) = &*figure.borrow();
        // Nothing else helps than one of the two, and one of them does.
        let ways = planner.feasibility().minimal_sets(target, ObjectSet::CAPACITY, &Budget::unlimited());
        let of_the_two = |set: &ObjectSet| set.iter().any(|o| below.contains(&name(o)));
        let ways = ways.unwrap_or_default();
        let figure = |o: ObjectId| below.contains(&name(o)) || top.as_ref() == Some(&name(o));
        let one_does =
            |set: &ObjectSet| set.iter().all(figure) && set.iter().filter(|o| below.contains(&name(*o))).count() == 1;
        if !ways.iter().all(of_the_two) || !ways.iter().any(one_does) {
            return Ok(false);
        }
        let removed = planner
            .plan(&Request { most_removals: Some(least), ..Request::new(1, guarded()) }, &mut Silent)
            .plan
            .removed;
        Ok(matches!(removed.as_slice(), [first, second, _] if Some(first) == top.as_ref() && below.contains(second)))
    };
    draw_until(wanted, ROBOT, "stacked", draw, as_wanted)
}

/// Whether there is a plan with at most so many removals, as far as the planner can tell.
fn can_be_planned(
    scene: Scene,
    model: Arc<CollisionModel>,
    most: usize,
    mobile: &mobile::Settings,
) -> Result<bool, NoScene> {
    let settings = Settings { mobile: mobile.clone(), ..Settings::default() };
    let mut planner = Planner::with_model(scene, model, settings).map_err(unsound)?;
    let request = Request { most_removals: Some(most), ..Request::new(1, guarded()) };
    Ok(planner.plan(&request, &mut Silent).plan.status == Status::Solved)
}

fn draw(recipe: &Recipe, wanted: &Wanted) -> Result<Drawn, NoScene> {
    let least = wanted.least_removals.unwrap_or(2.min(wanted.objects));
    if wanted.objects > 0 && least > wanted.objects {
        return Err(NoScene::TooManyRemovals);
    }
    let draw = |random: &mut Xoshiro256PlusPlus| cabinet::draw(recipe, wanted.objects, random);
    draw_until(wanted, cabinet::ROBOT, recipe.name, draw, |scene, model| {
        Ok((!recipe.solvable || can_be_had(scene.clone(), model.clone(), 2 * least)?)
            && (least <= 1 || !fewer_suffice(scene, model, least)?))
    })
}

/// Draws until a scene is as wanted, or the draws allowed are spent.
fn draw_until(
    wanted: &Wanted,
    robot: &str,
    kind: &str,
    mut draw: impl FnMut(&mut Xoshiro256PlusPlus) -> Result<SceneFile, NoScene>,
    is_as_wanted: impl Fn(Scene, Arc<CollisionModel>) -> Result<bool, NoScene>,
) -> Result<Drawn, NoScene> {
    if wanted.objects == 0 {
        return Err(NoScene::NoObjects);
    }
    let mut random = Xoshiro256PlusPlus::seed_from_u64(wanted.seed);
    let robot = Robot::load(robot, Path::new("."), &[]).map_err(|e| NoScene::Unsound(e.to_string()))?;
    let model = Arc::new(CollisionModel::new(Arc::new(robot)));
    let mut rejected = 0;
    loop {
        let mut file = draw(&mut random)?;
        file.name = format!("{kind}-{}-{}", wanted.objects, wanted.seed);
        let scene =
            Scene::from_file_struct(file.clone(), Path::new(".")).map_err(|e| NoScene::Unsound(e.to_string()))?;
        // As it was read, on what carries it; defaults are left to whoever reads it next.
        for (drawn, read) in file.objects.iter_mut().zip(&scene.file.objects) {
            drawn.position = read.position;
        }
        let as_wanted = is_as_wanted(scene, model.clone())?;
        if as_wanted || rejected + 1 == MOST_DRAWS {
            return Ok(Drawn { file, rejected, as_wanted });
        }
        rejected += 1;
    }
}

/// The deadline only guards against a scene that never ends.
fn guarded() -> Budget {
    Budget::unlimited().with_time(Duration::from_secs(20))
}

/// Whether the target can be had with fewer than `least` removals, as far as the planner can tell
/// with its exploration limit held below. Out of time the draw is kept.
fn fewer_suffice(scene: Scene, model: Arc<CollisionModel>, least: usize) -> Result<bool, NoScene> {
    can_be_planned(scene, model, least - 1, &mobile::Settings::default())
}

/// Whether the target can be had with so few removals, as far as the arm's own ways tell.
fn can_be_had(scene: Scene, model: Arc<CollisionModel>, most: usize) -> Result<bool, NoScene> {
    let target = scene.target;
    let mut planner = Planner::with_model(scene, model, Settings::default()).map_err(unsound)?;
    let budget = Budget::unlimited();
    // Nothing stops it.
    let few = planner.feasibility().frozen(&budget).and_then(|ways| order::few(&ways, target, &budget));
    Ok(few.is_ok_and(|set| set.is_some_and(|set| set.len() <= most)))
}

fn unsound(unfit: Unfit) -> NoScene {
    NoScene::Unsound(format!("{unfit:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_sound_repeatable_and_not_easy() {
        for (objects, seed) in [(12, 3), (20, 1)] {
            let wanted = Wanted { objects, seed, least_removals: None };
            let drawn = shelf(&wanted).unwrap();
            assert_eq!(drawn.file.objects.len(), objects);
            assert!(drawn.as_wanted);
            assert_eq!(drawn.file, shelf(&wanted).unwrap().file);
            let scene = Scene::from_file_struct(drawn.file, Path::new(".")).unwrap();
            let robot = Arc::new(Robot::load(cabinet::ROBOT, Path::new("."), &[]).unwrap());
            assert!(!fewer_suffice(scene, Arc::new(CollisionModel::new(robot)), 2).unwrap());
        }
    }

    /// At first only the large ones in front are in view; the same seed draws the same.
    #[test]
    fn most_are_hidden_and_the_target_too() {
        for (objects, in_front) in [(4, 1), (12, 3), (20, 5)] {
            let wanted = Wanted { objects, seed: 2, least_removals: None };
            let drawn = occluded(&wanted).unwrap();
            assert_eq!(drawn.file, occluded(&wanted).unwrap().file);
            assert!(drawn.as_wanted);
            let scene = Scene::from_file_struct(drawn.file, Path::new(".")).unwrap();
            let view = clearway_sight::View::new(scene.file.camera.as_ref().unwrap());
            let mut camera = clearway_retrieval::occlusion::simulated::SimulatedCamera::new(scene.clone(), view);
            let seen: Vec<String> = camera.look().objects.into_iter().map(|o| o.id).collect();
            assert_eq!(seen.len(), in_front, "{seen:?}");
            assert!(!seen.contains(&scene.file.target));
        }
    }

    #[test]
    fn what_cannot_be_is_told() {
        let wanted = |objects, least_removals| Wanted { objects, seed: 1, least_removals };
        assert_eq!(shelf(&wanted(0, None)).unwrap_err(), NoScene::NoObjects);
        assert_eq!(shelf(&wanted(3, Some(4))).unwrap_err(), NoScene::TooManyRemovals);
        assert!(matches!(shelf(&wanted(250, None)), Err(NoScene::DoesNotFit { .. })));
        assert_eq!(shelf(&wanted(1, None)).unwrap().file.objects.len(), 1);
        assert_eq!(occluded(&wanted(0, None)).unwrap_err(), NoScene::NoObjects);
        assert_eq!(occluded(&wanted(1, None)).unwrap().file.objects.len(), 1);
    }
}
