//! Which objects does this posture, this motion, touch: answers in sets.
