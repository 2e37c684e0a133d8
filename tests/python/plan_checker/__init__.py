"""Judges Clearway plan files with Pinocchio (kinematics) and Coal (exact shapes).

Written from the contract of the plan file alone; shares no code with the planner or its verifier.
Units are metres, radians and seconds; z is up; quaternions are ``[x, y, z, w]``; every pose is a
4×4 matrix ``a_from_b`` that takes coordinates in frame b to frame a.
"""

from .judge import check_file, check_plan
from .violations import Violation

__all__ = ["Violation", "check_file", "check_plan"]
