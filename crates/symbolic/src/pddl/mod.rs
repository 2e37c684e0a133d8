//! PDDL with streams, as read: what a domain, its streams and a goal say, with every name resolved.
//!
//! Of PDDL: typing, constants, negative, disjunctive and conditional parts, quantifiers, equality, and
//! derived predicates that are no recursion. Variables are slots of the action, stream or derived predicate that
//! they belong to: parameters first, then whatever is quantified inside.
//!
//! No numbers, costs or durations. Names are compared as they are written, keywords in either case. What is read is
//! bounded in size and depth; what is wrong with it comes back as a `FileError` that points at the place.

mod ast;
mod contradiction;
mod derived;
mod domain;
mod effects;
mod formula;
mod goal;
mod lists;
mod names;
mod sexpr;
mod streams;
mod types;
mod unsupported;

pub use ast::{
    Action, Atom, Constant, Derived, Domain, Effect, Formula, Goal, Predicate, PredicateId, Stream, Term, TypeId,
    Types, Variable,
};
pub use streams::Provided;
