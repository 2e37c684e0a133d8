"""Every tolerance of the checker, in one place. The first group is the contract's own."""

TOUCHING = 1e-4
"""Metres of overlap above which two things touch."""
RESTING = 1e-3
"""Metres of gap or overlap between an object and what carries it that count as resting."""
HOLD_REACH = 5e-3
"""Metres between a held object and the nearest of the hand's links."""
POSE_MATCH = 1e-3
"""Metres that any point of an object may be off where it stood or was put."""
ROW_SPACING = 0.02
"""Seconds between rows."""
CONTINUITY = 1e-6
"""Radians or metres between the end of a segment and the start of the next."""
ALWAYS_TOUCHING = 0.70
"""Share of uniform postures in which a pair must touch to go unchecked."""

LIMIT_SLACK = 1e-6
"""Radians or metres past a joint's position limit."""
RATE_SLACK = 1e-3
"""Relative excess over a velocity or acceleration limit."""
JERK_SLACK = 1e-2
"""Relative excess over a jerk limit."""
JERK_ROUNDING = 0.05
"""Besides, per s³: rows rounded to eight digits, over 0.02 s cubed."""
DISTANCE_SLACK = 2e-6
"""Metres that a distance may be off: see `distance`; a few times Coal's error."""
UPRIGHT = 1e-3
"""Radians between a placed object's vertical and the one it stood with."""
BALANCE = 1e-3
"""Metres past an edge at which a centre of mass still counts as carried."""
INSIDE = 1e-6
"""Metres that a footprint may stick out of its place."""
LIFT_OFF = 0.01
"""Metres round where an object stood or is put within which its carrier may overlap it."""
PUSH_PLACE = 1e-3
"""Metres that a push may be off: its line, its length, where it ends."""
PUSH_TURN = 0.01
"""Radians that the tool may turn, and the object lean."""
PUSH_NEAR = 1.5e-3
"""Metres within which the hand pushes."""
PUSH_DEPTH = 1e-3
"""Metres that the hand may be inside what it pushes."""
CARRIER_NEAR = 0.03
"""Metres round where an object stood or is put within which its carrier may be as near as it is."""
CLEARANCE = 1e-4
"""Metres less than the clearance asked for that are let pass."""
CLEARANCE_CLAIM = 3e-4
"""Metres more than was measured that a plan may claim."""
SUB_STEP = 2e-3
"""Metres that any point may move from one collision check to the next."""
POSTURES = 300
"""Uniform postures drawn to judge unchecked pairs."""
