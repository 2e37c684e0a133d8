//! Draws scenes and rejects the easy ones.
