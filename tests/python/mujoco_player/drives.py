"""How each joint of a robot gets its value: driven by the plan, coupled to one that is, or held."""

from dataclasses import dataclass, field

from .unplayable import Unplayable
from .urdf import Urdf


@dataclass
class Drives:
    """`arm`, `hand`: joints with a motor of their own, in the plan's order.
    `coupled`: joint → (a joint with a motor, multiplier, offset). `held`: joint → value."""

    arm: list[str]
    hand: list[str]
    coupled: dict[str, tuple[str, float, float]] = field(default_factory=dict)
    held: dict[str, float] = field(default_factory=dict)

    def of_hand(self) -> list[str]:
        """Every joint that moves with the gripper."""
        return self.hand + [
            name for name, (leader, _, _) in self.coupled.items() if leader in self.hand
        ]


def gripper_joints(plan: dict) -> list[str]:
    """The joints that the plan gives values to beside the arm's."""
    found = {}
    for step in plan["steps"]:
        for segment in step["segments"]:
            found.update(dict.fromkeys(segment.get("gripper") or {}))
    return list(found)


def drives(tree: Urdf, plan: dict) -> Drives:
    """What drives the joints of `tree`; one that nothing decides is `Unplayable`."""
    robot = plan["robot"]
    result = Drives(list(robot["joints"]), gripper_joints(plan))
    fixed = robot.get("fixed") or {}
    for joint in tree.joints.values():
        if joint.kind == "fixed" or joint.name in result.arm + result.hand:
            continue
        leader, multiplier, offset = joint.name, 1.0, 0.0
        while (follows := tree.joints[leader].mimic) and leader not in fixed:
            leader, m, o = follows
            offset, multiplier = offset + multiplier * o, multiplier * m
        if leader in result.arm + result.hand:
            result.coupled[joint.name] = (leader, multiplier, offset)
        elif leader in fixed:
            result.held[joint.name] = multiplier * fixed[leader] + offset
        else:
            raise Unplayable(f"joint {joint.name}: neither in the plan's rows nor fixed")
    return result
