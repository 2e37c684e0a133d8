//! Small tasks drawn at random, and the shortest plans for tasks by looking at every state.

use clearway_symbolic::facts::{Fact, Value};
use clearway_symbolic::ground::{GroundAction, Literal, Task};
use clearway_symbolic::pddl::PredicateId;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::{BTreeMap, HashMap};

/// A state: a bit for every atom that holds.
type Bits = u128;

fn bits(atoms: impl IntoIterator<Item = usize>) -> Bits {
    atoms.into_iter().fold(0, |bits, atom| bits | 1 << atom)
}

fn met(state: Bits, literals: &[Literal]) -> bool {
    literals.iter().all(|(atom, holds)| (state >> atom & 1 == 1) == *holds)
}

fn after(state: Bits, action: &GroundAction) -> Bits {
    state & !bits(action.deletes.iter().copied()) | bits(action.adds.iter().copied())
}

/// A task on a few lines.
pub fn told(task: &Task) -> String {
    let mut text = format!("{} atoms, at first {:?}, goal {:?}", task.atoms.len(), task.init, task.goal);
    for (index, GroundAction { precondition, adds, deletes, .. }) in task.actions.iter().enumerate() {
        text += &format!("\n{index}: {precondition:?} adds {adds:?} deletes {deletes:?}");
    }
    text
}

/// Whether a plan can be carried out and reaches the goal.
pub fn does(task: &Task, plan: &[usize]) -> bool {
    let step = |state: Bits, a: &usize| {
        let action = &task.actions[*a];
        met(state, &action.precondition).then(|| after(state, action))
    };
    let end = plan.iter().try_fold(bits(task.init.iter().copied()), step);
    end.is_some_and(|end| task.goal.iter().any(|g| met(end, g)))
}

/// The states that can be reached, nearest first, and by what each is.
fn reachable(task: &Task) -> (Vec<Bits>, HashMap<Bits, Option<(Bits, usize)>>) {
    assert!(task.atoms.len() <= 128);
    let first = bits(task.init.iter().copied());
    let mut came: HashMap<Bits, Option<(Bits, usize)>> = HashMap::from([(first, None)]);
    let mut queue = vec![first];
    let mut next = 0;
    while next < queue.len() {
        let state = queue[next];
        next += 1;
        for (index, action) in task.actions.iter().enumerate().filter(|(_, a)| met(state, &a.precondition)) {
            let after = after(state, action);
            came.entry(after).or_insert_with(|| {
                queue.push(after);
                Some((state, index))
            });
        }
    }
    (queue, came)
}

/// A shortest plan, if there is any, and how many states can be reached.
pub fn shortest(task: &Task) -> (Option<Vec<usize>>, usize) {
    let (queue, came) = reachable(task);
    let reached = queue.iter().find(|state| task.goal.iter().any(|g| met(**state, g)));
    let plan = reached.map(|state| {
        let mut plan = Vec::new();
        let mut at = *state;
        while let Some((before, action)) = came[&at] {
            plan.push(action);
            at = before;
        }
        plan.reverse();
        plan
    });
    (plan, queue.len())
}

pub fn action(precondition: &[Literal], adds: &[usize], deletes: &[usize]) -> GroundAction {
    let precondition = precondition.to_vec();
    let deletes = deletes.iter().filter(|d| !adds.contains(d)).copied().collect();
    GroundAction { action: 0, values: Vec::new(), precondition, adds: adds.to_vec(), deletes, relies_on: Vec::new() }
}

/// A task of so many atoms, of which none holds at first.
pub fn task(atoms: usize, actions: Vec<GroundAction>, goal: Vec<Vec<Literal>>) -> Task {
    let atoms = (0..atoms).map(|i| Fact { predicate: PredicateId(0), values: vec![Value(i as u32)] }).collect();
    Task { atoms, init: Vec::new(), actions, goal }
}

pub struct Draw(Xoshiro256PlusPlus);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.0.random_range(0..end)
    }

    pub fn in_ten(&mut self, times: usize) -> bool {
        self.below(10) < times
    }

    fn some(&mut self, atoms: usize, most: usize) -> Vec<usize> {
        let mut some: Vec<usize> = (0..self.below(most + 1)).map(|_| self.below(atoms)).collect();
        some.sort_unstable();
        some.dedup();
        some
    }

    fn literals(&mut self, atoms: usize, most: usize) -> Vec<Literal> {
        let all: BTreeMap<usize, bool> = self.some(atoms, most).into_iter().map(|a| (a, self.in_ten(6))).collect();
        all.into_iter().collect()
    }

    /// A task of so many atoms. Most goals are far away, and some are just out of reach.
    pub fn task(&mut self, atoms: usize) -> Task {
        let mut task = self.without_goal(atoms);
        // Mostly one in which there is somewhere to go.
        while reachable(&task).0.len() < 3 * atoms && self.in_ten(9) {
            task = self.without_goal(atoms);
        }
        let last = reachable(&task).0.pop().unwrap_or_default();
        for _ in 0..[1, 1, 1, 2, 3, 0][self.below(6)] {
            let mut goal = self.literals(atoms, 8);
            let out_of_reach = self.in_ten(2);
            for (index, (atom, holds)) in goal.iter_mut().enumerate() {
                *holds = (last >> *atom & 1 == 1) != (out_of_reach && index == 0);
            }
            task.goal.push(goal);
        }
        task
    }

    fn without_goal(&mut self, atoms: usize) -> Task {
        let actions = (0..self.below(3 * atoms)).map(|_| {
            let adds = self.some(atoms, 2);
            let deletes = self.some(atoms, 2);
            action(&self.literals(atoms, 4), &adds, &deletes)
        });
        let actions = actions.collect();
        Task { init: self.some(atoms, atoms / 2), ..task(atoms, actions, Vec::new()) }
    }
}
