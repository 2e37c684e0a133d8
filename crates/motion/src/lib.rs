//! From posture to posture without touching: RRT-Connect, shortcuts, timing.
