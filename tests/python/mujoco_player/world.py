"""The MuJoCo model of a plan, and who owns which geom."""

import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np

from . import drives, gap, poses, scene_bodies, settings, urdf
from .robot_bodies import LINK, RobotBodies
from .scene_bodies import OBJECT


class World:
    """`model` and `data`; owners are named by `link/`, `fixture/` or `object/` and their ids."""

    def __init__(self, plan: dict) -> None:
        scene, robot = plan["scene"], plan["robot"]
        self.tree = urdf.parse(robot["urdf"])
        self.drives = drives.drives(self.tree, plan)
        self.hand_links = list(robot["hand"]["links"])
        self.tool = robot["tool"]
        self.gap = gap.Gap(robot["hand"])
        self.cup = "suction" in robot["hand"]["kind"]
        self.objects = [keys["id"] for keys in scene["objects"]]
        self.model = mujoco.MjModel.from_xml_string(self._mjcf(plan, scene))
        self.data = mujoco.MjData(self.model)
        names = [self.model.body(i).name for i in range(self.model.nbody)]
        self.owners = names
        self.owner_of_geom = np.array(self.model.geom_bodyid)
        self.body_of = {name: number for number, name in enumerate(names)}

    def _mjcf(self, plan: dict, scene: dict) -> str:
        root = ElementTree.Element("mujoco")
        ElementTree.SubElement(
            root,
            "compiler",
            angle="radian",
            autolimits="true",
            boundmass="0.01",
            boundinertia="1e-6",
            balanceinertia="true",
        )
        # With MuJoCo's own 35 iterations, cylinders upon cylinders are at times thought deep in
        # each other, and shoot away.
        option = ElementTree.SubElement(
            root,
            "option",
            timestep=f"{settings.STEP}",
            cone="elliptic",
            impratio="10",
            integrator="implicitfast",
            noslip_iterations="4",
            ccd_iterations="200",
            ccd_tolerance="1e-8",
        )
        # What stands still is left out until something touches it: three times as fast.
        ElementTree.SubElement(option, "flag", sleep="enable")
        worldbody = ElementTree.SubElement(root, "worldbody")
        robot = RobotBodies(self.tree, self.drives, set(self.hand_links), self.gap.drive_inertia())
        robot.add(worldbody, poses.from_keys((scene.get("robot") or {}).get("base")))
        for keys in scene.get("fixtures") or []:
            scene_bodies.add_fixture(worldbody, keys)
        for keys in scene["objects"]:
            scene_bodies.add_object(worldbody, keys, scene)
        self._couple(root)
        return ElementTree.tostring(root, encoding="unicode")

    def _couple(self, root) -> None:
        """Couplings, suction's grip on each object (off), and motors, whose gains come later."""
        equality = ElementTree.SubElement(root, "equality")
        stiff = {"solref": "0.003 1", "solimp": "0.99 0.999 0.001"}
        for joint, (leader, multiplier, offset) in self.drives.coupled.items():
            polynomial = poses.words((offset, multiplier, 0, 0, 0))
            ElementTree.SubElement(
                equality, "joint", joint1=joint, joint2=leader, polycoef=polynomial, **stiff
            )
        for name in self.objects if self.cup else ():
            pair = {"body1": LINK + self.tool, "body2": OBJECT + name}
            ElementTree.SubElement(
                equality, "weld", name=OBJECT + name, active="false", **pair, **stiff
            )
        actuator = ElementTree.SubElement(root, "actuator")
        for joint in self.drives.arm + self.drives.hand:
            ElementTree.SubElement(
                actuator, "general", name=joint, joint=joint, biastype="affine", forcerange="-1 1"
            )

    def forward(self) -> None:
        mujoco.mj_forward(self.model, self.data)

    def columns(self, joints) -> tuple[np.ndarray, np.ndarray]:
        """Where the values of `joints` are in `qpos`, and their rates in `qvel`."""
        found = [self.model.joint(name) for name in joints]
        values, rates = ([getattr(j, key)[0] for j in found] for key in ("qposadr", "dofadr"))
        return np.array(values, int), np.array(rates, int)

    def set_robot(self, row, gripper) -> None:
        """Puts the robot into a posture at once; what is coupled follows."""
        values = dict(zip(self.drives.arm + self.drives.hand, [*row, *gripper], strict=True))
        for joint, (leader, multiplier, offset) in self.drives.coupled.items():
            values[joint] = multiplier * values[leader] + offset
        for joint, value in values.items():
            self.data.qpos[self.model.joint(joint).qposadr[0]] = value

    def object_pose(self, name: str) -> np.ndarray:
        body = self.body_of[OBJECT + name]
        return poses.pose(self.data.xmat[body].reshape(3, 3), self.data.xpos[body])

    def set_object(self, name: str, at: np.ndarray) -> None:
        start = self.model.joint(OBJECT + name).qposadr[0]
        self.data.qpos[start : start + 3] = at[:3, 3]
        self.data.qpos[start + 3 : start + 7] = poses.quaternion_of(at)

    def link(self, name: str) -> int:
        return self.body_of[LINK + name]

    def is_link(self, owner: int) -> bool:
        return self.owners[owner].startswith(LINK)
