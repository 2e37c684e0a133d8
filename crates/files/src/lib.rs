//! Reads untrusted files within bounds; errors that point at the place.
