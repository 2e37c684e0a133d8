//! Which objects must move, in what order, and how: the planner of the paper.
