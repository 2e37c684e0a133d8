"""The robot of a plan: Pinocchio's kinematics with every joint's value filled in by us."""

import numpy as np
import pinocchio

from . import shapes, urdf
from .meshes import MeshStore
from .violations import PlanError

_KINDS = ("revolute", "prismatic", "continuous", "fixed")


class Robot:
    """`planned` is the plan's `robot`; `world_from_root` the pose of the URDF's root link."""

    def __init__(self, planned: dict, world_from_root, meshes: MeshStore) -> None:
        self.tree = urdf.parse(planned["urdf"])
        for joint in self.tree.joints.values():
            if joint.kind not in _KINDS:
                raise PlanError(f"robot.urdf: joint {joint.name} is {joint.kind}: not supported")
        self.joints: list[str] = planned["joints"]
        self.fixed: dict[str, float] = planned.get("fixed") or {}
        self.home: dict[str, float] = planned.get("home") or {}
        self.hand_links: list[str] = planned["hand"]["links"]
        self.tool: str = planned["tool"]
        self.limits = planned["limits"]
        self._known(self.joints, self.tree.joints, "robot.joints")
        self._known(self.fixed, self.tree.joints, "robot.fixed")
        self._known(self.hand_links, self.tree.collisions, "robot.hand.links")
        self._known([planned["tool"]], self.tree.collisions, "robot.tool")
        self.moving = [j for j in self.tree.joints.values() if j.moves]
        self.mounted = self._links_of_root()
        self.parts = {
            link: [part for c in found if (part := link_part(c, meshes)) is not None]
            for link, found in self.tree.collisions.items()
        }
        self._build(urdf.kinematics_only(planned["urdf"]), world_from_root)

    @staticmethod
    def _known(names, among, where: str) -> None:
        for name in names:
            if name not in among:
                raise PlanError(f"{where}: {name!r} is not in the URDF")

    def _links_of_root(self) -> set[str]:
        """The root link, or, where it has no shape, the first links with one fixed to it."""
        found, border = set(), [self.tree.root]
        while border:
            link = border.pop()
            found.add(link)
            if not self.tree.collisions[link]:
                border += [
                    j.child for j in self.tree.joints.values() if j.parent == link and not j.moves
                ]
        return found

    def _build(self, text: str, world_from_root: np.ndarray) -> None:
        try:
            self._model = pinocchio.buildModelFromXML(text)
        except (ValueError, RuntimeError) as error:
            raise PlanError(f"Pinocchio refuses robot.urdf: {error}") from error
        self._data = self._model.createData()
        self._columns = [
            (j.name, self._model.joints[self._model.getJointId(j.name)]) for j in self.moving
        ]
        self._world_from_root = world_from_root
        self._frames = {}
        for link in self.tree.links():
            index = self._model.getFrameId(link, pinocchio.FrameType.BODY)
            frame = self._model.frames[index]
            self._frames[link] = (frame.parentJoint, frame.placement.homogeneous.copy())

    def values(self, rows: np.ndarray, gripper: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Every moving joint's value at each of n rows, from `joints`' columns (n×k), `fixed`,
        the gripper's values (n each) and `<mimic>`. An undetermined joint is a `PlanError`."""
        count = len(rows)
        known = {name: np.full(count, float(value)) for name, value in self.fixed.items()}
        known.update({name: np.asarray(value, float) for name, value in gripper.items()})
        known.update({name: rows[:, i] for i, name in enumerate(self.joints)})
        return {j.name: self._value(j, known, 0) for j in self.moving}

    def _value(self, joint: urdf.Joint, known: dict, depth: int) -> np.ndarray:
        if joint.mimic is None or depth > len(self.moving):
            if joint.name not in known:
                raise PlanError(
                    f"joint {joint.name} has no value: not in joints, fixed, gripper, nor a mimic"
                )
            return known[joint.name]
        leader = self.tree.joints.get(joint.mimic.joint)
        if leader is None or not leader.moves:
            raise PlanError(f"joint {joint.name} mimics {joint.mimic.joint}, which does not move")
        return joint.mimic.multiplier * self._value(leader, known, depth + 1) + joint.mimic.offset

    def place(self, values: dict[str, np.ndarray]) -> "Postures":
        """Forward kinematics for n rows of `values`."""
        count = len(next(iter(values.values()))) if values else 1
        configurations = np.zeros((count, self._model.nq))
        for name, joint in self._columns:
            if joint.nq == 2:
                configurations[:, joint.idx_q] = np.cos(values[name])
                configurations[:, joint.idx_q + 1] = np.sin(values[name])
            else:
                configurations[:, joint.idx_q] = values[name]
        root_from_joint = np.zeros((count, self._model.njoints, 4, 4))
        root_from_joint[..., 3, 3] = 1.0
        placements = self._data.oMi
        for row, configuration in enumerate(configurations):
            pinocchio.forwardKinematics(self._model, self._data, configuration)
            for joint in range(self._model.njoints):
                placement = placements[joint]
                root_from_joint[row, joint, :3, :3] = placement.rotation
                root_from_joint[row, joint, :3, 3] = placement.translation
        return Postures(self._world_from_root @ root_from_joint, self._frames)


class Postures:
    """World poses of every link at n postures."""

    def __init__(self, world_from_joint: np.ndarray, frames: dict) -> None:
        self._world_from_joint = world_from_joint
        self._frames = frames
        self._links: dict[str, np.ndarray] = {}

    def __len__(self) -> int:
        return len(self._world_from_joint)

    def link(self, name: str) -> np.ndarray:
        """n×4×4: the link's frame in the world."""
        if name not in self._links:
            joint, joint_from_link = self._frames[name]
            self._links[name] = self._world_from_joint[:, joint] @ joint_from_link
        return self._links[name]


def link_part(collision: urdf.Collision, meshes: MeshStore) -> shapes.Part | None:
    """The exact shape of one `<collision>`; None for a mesh that is missing (and reported)."""
    keys, at = collision.attributes, collision.link_from_shape
    if collision.shape == "box":
        return shapes.box([float(word) for word in keys["size"].split()], at)
    if collision.shape == "sphere":
        return shapes.sphere(float(keys["radius"]), at)
    if collision.shape == "cylinder":
        return shapes.cylinder(float(keys["radius"]), float(keys["length"]), at)
    if collision.shape == "capsule":
        return shapes.capsule(float(keys["radius"]), float(keys["length"]), at)
    if collision.shape == "mesh":
        scale = [float(word) for word in keys.get("scale", "1 1 1").split()]
        model = meshes.triangles(keys["filename"], scale)
        return None if model is None else shapes.triangles(model, at)
    raise PlanError(f"robot.urdf: unknown collision shape <{collision.shape}>")
