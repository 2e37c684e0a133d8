"""What a plan file does not say: steps, contacts, motors. SI units."""

STEP = 5e-4
"""Seconds between two steps of physics."""
SETTLE, AFTER = 0.2, 0.7
"""Seconds of standing still before the first row and after the last one."""

CONTACT = {"solref": "0.004 1", "solimp": "0.95 0.99 0.0002"}
"""Stiff: what weighs a kilogram sinks in by micrometres. Stiffer, and what starts to slide hops."""
PAD_CONTACT = {"solref": f"{2 * STEP} 1", "solimp": "0.95 0.99 0.0002", "solmix": "1e6"}
"""As stiff as the step allows, and not averaged with the object's. MuJoCo leaves the centripetal
term out of its constraints, so that what is held in a swinging hand creeps by that acceleration
times the step, here a few mm/s in a hard swing: a millimetre or so in a transfer. That halves with
the step; what a grip really loses does not."""
DENSITY, FRICTION = 500.0, 0.4
"""Of objects whose plan gives no mass or friction, kg/m³."""
PADS = 1.0
"""Friction of the hand's links: rubber."""
SPIN = 0.005
"""Metres: torsional friction of the pads; a line contact as long as a pad has about as much."""

STIFFNESS = 200.0
"""rad/s: what each joint's servo and the inertia it moves would swing at without damping."""
MOTOR_TURNS, MOTOR_SLIDES = 0.1, 2.0
"""Inertia of an arm joint's own motor, kg m² or kg."""

GRIP = 30.0
"""Newtons on each pad at most."""
GRIP_STIFFNESS = 15e3
"""Newtons on each pad per metre that the gap is from what is asked."""
BEYOND = 0.005
"""Metres that the gap is asked to be narrower than the plan says, while something is held."""
FINGER = 0.5
"""Kilograms that each finger's drive adds to the pad."""

CUP_REACH = 2e-3
"""Metres from a suction cup within which it takes hold."""
