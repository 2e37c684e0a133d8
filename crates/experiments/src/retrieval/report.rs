//! Tables and figures from rows alone.
