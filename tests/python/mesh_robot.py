"""A URDF with meshes: free postures sampled, paths checked, with Pinocchio and Coal alone."""

import coal
import numpy as np
import pinocchio


class MeshRobot:
    """`joints` are the columns of the rows; the other joints stay at 0."""

    def __init__(self, text: str, package, joints: list[str]) -> None:
        self.text, self.joints = text, joints
        self.model = pinocchio.buildModelFromXML(text)
        self.data = self.model.createData()
        self.shapes = pinocchio.buildGeomFromUrdfString(
            self.model, text, pinocchio.GeometryType.COLLISION, package_dirs=[str(package.parent)]
        )
        self.columns = [self.model.joints[self.model.getJointId(j)].idx_q for j in joints]
        self.own = len(self.shapes.geometryObjects)
        self._choose_pairs()

    def _choose_pairs(self) -> None:
        """Links that are not within 1 cm of each other in every posture, neighbours aside."""
        objects = self.shapes.geometryObjects
        apart = [
            (a, b)
            for a in range(self.own)
            for b in range(a + 1, self.own)
            if objects[a].parentJoint != objects[b].parentJoint
            and self.model.parents[objects[b].parentJoint] != objects[a].parentJoint
        ]
        random = np.random.default_rng(0)
        met = {pair: 0 for pair in apart}
        for row in self.sample(random, 60):
            self._place(row)
            for pair in self._meeting(apart, 0.01):
                met[pair] += 1
        self.pairs = [pair for pair, count in met.items() if count < 60]

    def sample(self, random, count: int) -> np.ndarray:
        low, high = (
            np.array([limits[c] for c in self.columns])
            for limits in (self.model.lowerPositionLimit, self.model.upperPositionLimit)
        )
        return random.uniform(low, high, size=(count, len(self.columns)))

    def _place(self, row) -> None:
        q = np.zeros(self.model.nq)
        q[self.columns] = row
        pinocchio.forwardKinematics(self.model, self.data, q)

    def _pose(self, number: int):
        shape = self.shapes.geometryObjects[number]
        pose = self.data.oMi[shape.parentJoint] * shape.placement
        return coal.Transform3s(pose.rotation, pose.translation)

    def _meeting(self, pairs, margin: float = 0.0):
        poses = [self._pose(number) for number in range(self.own)]
        meshes = [shape.geometry for shape in self.shapes.geometryObjects]
        for a, b in pairs:
            if (
                coal.distance(
                    meshes[a],
                    poses[a],
                    meshes[b],
                    poses[b],
                    coal.DistanceRequest(),
                    coal.DistanceResult(),
                )
                <= margin
            ):
                yield a, b

    def touches(self, rows, problem: dict, margin: float = 0.0) -> bool:
        """Whether any row comes nearer than `margin` to the problem's spheres and boxes, which must
        not turn, or than an eighth of it to itself. A shape wholly inside a mesh is not seen."""
        stands = [(coal.Sphere(s["radius"]), s["position"]) for s in problem["sphere"]]
        stands += [
            (coal.Box(*(2 * np.array(s["half_extents"]))), s["position"]) for s in problem["box"]
        ]
        stands = [(shape, coal.Transform3s(np.eye(3), np.array(at))) for shape, at in stands]
        for row in rows:
            self._place(row)
            if next(self._meeting(self.pairs, margin / 8), None):
                return True
            for number, shape in enumerate(self.shapes.geometryObjects):
                if shape.parentJoint == 0:
                    continue
                for stand, at in stands:
                    request, result = coal.DistanceRequest(), coal.DistanceResult()
                    if (
                        coal.distance(
                            shape.geometry, self._pose(number), stand, at, request, result
                        )
                        <= margin
                    ):
                        return True
        return False

    def problems(self, seed: int, count: int) -> dict:
        """Problems among spheres and boxes; starts and goals 8 cm from everything."""
        random = np.random.default_rng(seed)
        made = []
        for index in range(1, count + 1):

            def things(kind, **size):
                return [
                    {"name": f"{kind}{i}", "position": self._at(random), **size} for i in range(2)
                ]

            problem = {
                "index": index,
                "sphere": things("ball", radius=0.08),
                "box": things("block", half_extents=[0.05, 0.1, 0.08]),
            }
            ends = []
            while len(ends) < 2:
                (row,) = self.sample(random, 1)
                if not self.touches([row], problem, margin=0.08):
                    ends.append(row.tolist())
            made.append({**problem, "start": ends[0], "goals": ends[1:]})
        return {"joints": self.joints, "problems": {"made_up": made}}

    @staticmethod
    def _at(random) -> list[float]:
        angle, far = random.uniform(-np.pi, np.pi), random.uniform(0.45, 0.7)
        return [far * np.cos(angle), far * np.sin(angle), random.uniform(0.1, 0.8)]
