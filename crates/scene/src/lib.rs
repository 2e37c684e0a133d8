//! Shelf, objects, target and places, read from scene files and checked.
