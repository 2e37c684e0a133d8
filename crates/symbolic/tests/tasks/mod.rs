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

/// Whether a plan can be carried out and reaches the goal.
pub fn does(task: &Task, plan: &[usize]) -> bool {
    let step = |state: Bits, a: &usize| {
        let action = &task.actions[*a];
        met(state, &action.precondition).then(|| after(state, action))
    };
    let end = plan.iter().try_fold(bits(task.init.iter().copied()), step);
    end.is_some_and(|end| task.goal.iter().any(|g| met(end, g)))
}

/// A shortest plan, if there is any, and how many states can be reached.
pub fn shortest(task: &Task) -> (Option<Vec<usize>>, usize) {
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

    /// A task of so many atoms, every one of them as likely as the others.
    pub fn task(&mut self, atoms: usize) -> Task {
        let actions = (0..self.below(2 * atoms)).map(|_| {
            let adds = self.some(atoms, 2);
            let deletes = self.some(atoms, 2).into_iter().filter(|d| !adds.contains(d)).collect();
            let precondition = self.literals(atoms, 3);
            GroundAction { action: 0, values: Vec::new(), precondition, adds, deletes, relies_on: Vec::new() }
        });
        let actions = actions.collect();
        let init = self.some(atoms, atoms / 2);
        let goals = [1, 1, 1, 2, 3, 0][self.below(6)];
        let goal = (0..goals).map(|_| self.literals(atoms, 5)).collect();
        let atoms = (0..atoms).map(|i| Fact { predicate: PredicateId(0), values: vec![Value(i as u32)] }).collect();
        Task { atoms, init, actions, goal }
    }
}
