//! Which actions of a task can matter for its goal: most objects stand in nobody's way.
//!
//! Backwards from the goal: an action matters when it brings about something wanted that is not so at first, and
//! then what it needs is wanted too. What holds at first and is undone on the way (an empty hand) is restored by
//! what follows on such actions: needs something that they bring about. Plans that need more than that are missed: where none is found, all
//! actions are to be tried.

use crate::ground::{Literal, Task};
use std::collections::HashSet;

/// Which actions matter.
pub fn relevant(task: &Task) -> Vec<bool> {
    let init: HashSet<usize> = task.init.iter().copied().collect();
    let holds_at_first = |(atom, holds): &Literal| init.contains(atom) == *holds;
    let mut wanted: HashSet<Literal> = task.goal.iter().flatten().copied().collect();
    let mut matters = vec![false; task.actions.len()];
    loop {
        let before = (wanted.len(), matters.iter().filter(|m| **m).count());
        // What actions that matter undo, and what they bring about.
        let mut undone: HashSet<Literal> = HashSet::new();
        let mut brought: HashSet<Literal> = HashSet::new();
        for (action, _) in task.actions.iter().zip(&matters).filter(|(_, m)| **m) {
            undone.extend(action.adds.iter().map(|a| (*a, false)).chain(action.deletes.iter().map(|d| (*d, true))));
            brought.extend(action.adds.iter().map(|a| (*a, true)).chain(action.deletes.iter().map(|d| (*d, false))));
        }
        for (action, matters) in task.actions.iter().zip(&mut matters).filter(|(_, m)| !**m) {
            let mut effects = action.adds.iter().map(|a| (*a, true)).chain(action.deletes.iter().map(|d| (*d, false)));
            let mut open = action.precondition.iter().filter(|l| !holds_at_first(l)).peekable();
            let follows = open.peek().is_none() || open.any(|l| brought.contains(l));
            let does = |l: Literal| wanted.contains(&l) && (!holds_at_first(&l) || undone.contains(&l) && follows);
            if effects.any(does) {
                *matters = true;
                wanted.extend(action.precondition.iter().copied());
            }
        }
        if before == (wanted.len(), matters.iter().filter(|m| **m).count()) {
            return matters;
        }
    }
}

/// The task with only some of its actions, and which each of them was.
pub fn with_only(task: &Task, matters: &[bool]) -> (Task, Vec<usize>) {
    let kept: Vec<usize> = (0..task.actions.len()).filter(|i| matters[*i]).collect();
    let actions = kept.iter().map(|i| task.actions[*i].clone()).collect();
    (Task { atoms: task.atoms.clone(), init: task.init.clone(), actions, goal: task.goal.clone() }, kept)
}
