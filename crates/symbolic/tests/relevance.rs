//! Fewer actions, the same plans: with those alone that seem to matter, what can be done at all can be done.
#![allow(clippy::unwrap_used)]

mod tasks;

use clearway_symbolic::facts::{Fact, Facts, Value, Values};
use clearway_symbolic::ground::{Grounder, Known, Task};
use clearway_symbolic::pddl::{Constant, Domain, Goal, PredicateId};
use clearway_symbolic::relevance::{relevant, with_only};
use std::path::Path;
use tasks::{Draw, does, shortest, told};

/// A plan of the actions that matter, told in those of the whole task.
fn plan_of_relevant(task: &Task) -> Option<Vec<usize>> {
    let (few, kept) = with_only(task, &relevant(task));
    assert_eq!((&few.atoms, &few.init, &few.goal), (&task.atoms, &task.init, &task.goal));
    let plan = shortest(&few).0?;
    Some(plan.into_iter().map(|a| kept[a]).collect())
}

#[test]
fn plans_of_relevant_actions_do_in_the_whole_task() {
    let mut draw = Draw::new(1);
    let (mut found, mut fewer) = (0, 0);
    for _ in 0..2000 {
        let task = draw.task(8);
        if let Some(plan) = plan_of_relevant(&task) {
            assert!(does(&task, &plan), "{plan:?} in {}", told(&task));
            found += 1;
            fewer += usize::from(!relevant(&task).into_iter().all(|m| m));
        }
    }
    assert!(found > 500 && fewer > 300, "{found} {fewer}");
}

#[test]
fn where_nothing_can_be_undone_no_plan_is_missed() {
    let mut draw = Draw::new(2);
    let mut found = 0;
    for _ in 0..2000 {
        let mut task = draw.task(8);
        for action in &mut task.actions {
            action.deletes.clear();
            action.precondition.retain(|(_, holds)| *holds);
        }
        task.goal.iter_mut().for_each(|g| g.retain(|(_, holds)| *holds));
        let (all, few) = (shortest(&task).0, plan_of_relevant(&task));
        assert_eq!(all.map(|p| p.len()), few.as_ref().map(Vec::len), "{}", told(&task));
        found += usize::from(few.is_some_and(|p| p.len() > 1));
    }
    assert!(found > 100, "{found}");
}

/// Facts, all of them given.
struct Given(Facts);

impl Known for Given {
    fn facts(&self) -> &Facts {
        &self.0
    }

    fn is_tested(&self, _: PredicateId) -> bool {
        false
    }

    fn test(&mut self, fact: &Fact, _: &Values) -> bool {
        self.0.contains(fact)
    }
}

/// A table of the built-in domain, without any geometry.
struct Table<'a> {
    domain: &'a Domain,
    values: Values,
    facts: Given,
    state: Vec<Fact>,
    ways: usize,
}

impl Table<'_> {
    fn add(&mut self, name: &str, of: &str) -> Value {
        self.values.add(name, self.domain.types.named(of).unwrap())
    }

    fn fact(&self, name: &str, values: &[Value]) -> Fact {
        Fact { predicate: self.domain.predicate(name).unwrap(), values: values.to_vec() }
    }

    fn know(&mut self, name: &str, values: &[Value]) {
        self.facts.0.insert(self.fact(name, values));
    }

    /// A new pose of an item, with a way to it.
    fn pose(&mut self, item: Value, grasp: Value) -> Value {
        self.ways += 1;
        let (pose, way) = (self.add(&format!("p{}", self.ways), "pose"), self.add(&format!("w{}", self.ways), "way"));
        self.know("Pose", &[item, pose]);
        self.know("Kin", &[item, pose, grasp, way]);
        pose
    }
}

/// Items on a shelf, in each other's way; some stand, or may be put, on others. With `tight`, a shelf full enough
/// that little can be done.
fn table<'a>(domain: &'a Domain, draw: &mut Draw, tight: usize) -> Table<'a> {
    let mut table =
        Table { domain, values: Values::default(), facts: Given(Facts::default()), state: Vec::new(), ways: 0 };
    let (tray, shelf, motion) = (table.add("tray", "place"), table.add("board", "shelf"), table.add("m", "motion"));
    table.state.push(table.fact("HandEmpty", &[]));
    table.know("Surface", &[tray]);
    table.know("Surface", &[shelf]);
    // Every item, its grasp, and its poses, that at home first.
    let mut items: Vec<(Value, Value, Vec<Value>)> = Vec::new();
    for index in 0..2 + draw.below(3) {
        let (item, grasp) = (table.add(&format!("o{index}"), "item"), table.add(&format!("g{index}"), "grasp"));
        table.know("Grasp", &[item, grasp]);
        let home = table.pose(item, grasp);
        table.know("Home", &[item, home]);
        table.state.push(table.fact("AtPose", &[item, home]));
        let mut poses = vec![home];
        let below = Some(draw.below(index + 3)).filter(|b| *b < index).map(|b| (items[b].0, items[b].2[0]));
        let (under, at) = below.map_or((shelf, None), |(below, at)| (below, Some(at)));
        table.know("Supported", &[item, home, under]);
        table.state.push(table.fact("On", &[item, under]));
        if let Some(at) = at {
            table.know("Rests", &[item, home, under, at]);
        }
        for surface in [tray, shelf] {
            if draw.in_ten(7) {
                let pose = table.pose(item, grasp);
                table.know("Supported", &[item, pose, surface]);
                poses.push(pose);
            }
        }
        if let Some((below, at)) =
            items.get(draw.below(4)).map(|(below, _, poses)| (*below, poses[draw.below(poses.len())]))
        {
            let pose = table.pose(item, grasp);
            table.know("Supported", &[item, pose, below]);
            table.know("Rests", &[item, pose, below, at]);
            poses.push(pose);
        }
        items.push((item, grasp, poses));
    }
    let way = |table: &Table, pose: Value| table.values.named(&table.values.name(pose).replace('p', "w")).unwrap();
    for (item, grasp, poses) in &items {
        for pose in poses {
            let to = way(&table, *pose);
            for from in poses.iter().map(|p| way(&table, *p)).filter(|from| *from != to).collect::<Vec<_>>() {
                table.know("Motion", &[*item, *grasp, from, motion, to]);
            }
            for (other, _, others) in &items {
                for at in others {
                    if other == item || !draw.in_ten(tight) {
                        table.know("CFreeWay", &[to, *other, *at]);
                    }
                    if other == item || !draw.in_ten(tight / 2) {
                        table.know("CFreePose", &[*item, *pose, *other, *at]);
                    }
                }
            }
        }
    }
    table
}

#[test]
fn pick_and_place_can_be_done_with_relevant_actions_whenever_it_can_be_done() {
    let goals = [
        "(On o0 tray)",
        "(On o1 tray)",
        "(and (On o0 tray) (InPlace o1))",
        "(or (On o0 tray) (On o1 tray))",
        "(and (On o0 tray) (On o1 tray))",
        "(exists (?o - item) (On ?o tray))",
        "(forall (?o - item) (On ?o tray))",
        "(or (On o0 o1) (On o1 o0))",
        "(and (On o0 o1) (Clear o0))",
        "(not (InPlace o0))",
        "(and (Clear o0) (Clear o1))",
        "(and (On o0 tray) (imply (On o1 board) (InPlace o1)))",
    ];
    let domain = clearway_symbolic::domain();
    let named = |name: &str, of: &str| Constant { name: name.to_owned(), of: domain.types.named(of).unwrap() };
    let known = [named("o0", "item"), named("o1", "item"), named("tray", "place"), named("board", "shelf")];
    let mut draw = Draw::new(3);
    let (mut found, mut long, mut fewer) = (0, 0, 0);
    for round in 0..3000 {
        let goal = format!("(and {} (HandEmpty))", goals[round % goals.len()]);
        let goal = Goal::read(Path::new("goal"), &goal, &domain, &known).unwrap();
        let mut table = table(&domain, &mut draw, 2 + round % 4);
        let task = Grounder::new(&domain).task(&table.values, &table.state, &mut table.facts, &goal).unwrap();
        let (all, few) = (shortest(&task).0, plan_of_relevant(&task));
        let count = relevant(&task).into_iter().filter(|m| *m).count();
        assert_eq!(
            all.is_some(),
            few.is_some(),
            "{} with {count} of {} actions: {all:?}",
            goal.text,
            task.actions.len()
        );
        if let Some(plan) = few {
            assert!(does(&task, &plan), "{plan:?}");
            found += 1;
            long += usize::from(plan.len() > 2);
            fewer += usize::from(count < task.actions.len());
        }
    }
    assert!(found > 300 && found < 2500 && long > 50 && fewer > 100, "{found} {long} {fewer}");
}
