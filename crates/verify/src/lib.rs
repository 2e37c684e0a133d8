//! Judges a finished plan with exact shapes, by means that share nothing with the planner's.
