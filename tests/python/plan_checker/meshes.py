"""The files that a plan names: found through `robot.meshes`, their sha256 checked, then loaded."""

import hashlib
from pathlib import Path

import coal
import numpy as np

from .violations import Report

CELL = 0.1
"""Metres: points are grouped by cells of this size, so that far groups cost nothing."""


class MeshStore:
    """`uri` as written in the URDF or the scene → a checked file beside the plan."""

    def __init__(self, entries: list[dict], folder: Path, report: Report) -> None:
        self._entries = {entry["uri"]: entry for entry in entries}
        self._folder = folder
        self._report = report
        self._checked: dict[str, Path | None] = {}

    def path(self, uri: str) -> Path | None:
        """The file, or None after reporting why there is none."""
        if uri not in self._checked:
            self._checked[uri] = self._check(uri)
        return self._checked[uri]

    def _check(self, uri: str) -> Path | None:
        entry = self._entries.get(uri)
        if entry is None:
            self._report.add("mesh", uri, "used, but not listed in robot.meshes")
            return None
        path = self._folder / entry["file"]
        if not path.is_file():
            self._report.add("mesh", uri, f"no such file beside the plan: {entry['file']}")
            return None
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        if digest != str(entry["sha256"]).lower():
            text = f"{entry['file']} has sha256 {digest}, the plan says {entry['sha256']}"
            self._report.add("mesh", uri, text)
        return path

    def triangles(self, uri: str, scale):
        """Coal's tree of the file's triangles, scaled; None when there is no file."""
        path = self.path(uri)
        if path is None:
            return None
        loader = coal.MeshLoader(coal.BV_OBBRSS)
        return loader.load(str(path), np.asarray(scale, float))

    def point_groups(self, uri: str) -> list[np.ndarray]:
        """The points of a cloud (`x y z` lines, XYZ or text PLY), grouped by cells of space."""
        path = self.path(uri)
        if path is None:
            return []
        points = read_points(path)
        cells = np.floor(points / CELL).astype(np.int64)
        _, group = np.unique(cells, axis=0, return_inverse=True)
        order = np.argsort(group.ravel(), kind="stable")
        borders = np.flatnonzero(np.diff(group.ravel()[order])) + 1
        return np.split(points[order], borders)


def read_points(path: Path) -> np.ndarray:
    """k×3 metres."""
    data = path.read_bytes()
    if data.startswith(b"ply"):
        return _read_ply(data)
    lines = (line.split("#")[0].replace(",", " ").split() for line in data.decode().splitlines())
    return np.array([[float(word) for word in words[:3]] for words in lines if words])


_PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip


def _read_ply(data: bytes) -> np.ndarray:
    """The vertices of a PLY file whose first element is `vertex`."""
    header, _, body = data.partition(b"end_header")
    body = body[body.index(b"\n") + 1 :]
    words = [line.split() for line in header.decode().splitlines()]
    form = next(w[1] for w in words if w[:1] == ["format"])
    first = next(i for i, w in enumerate(words) if w[:1] == ["element"])
    if words[first][1] != "vertex":
        raise ValueError("the first element of a PLY point cloud must be `vertex`")
    count, properties = int(words[first][2]), []
    for line in words[first + 1 :]:
        if line[:1] == ["element"]:
            break
        if line[:1] == ["property"]:
            properties.append((line[2], line[1]))
    if form == "ascii":
        rows = np.array([line.split() for line in body.decode().splitlines()[:count]], float)
        columns = {name: rows[:, i] for i, (name, _) in enumerate(properties)}
    else:
        order = "<" if form == "binary_little_endian" else ">"
        layout = np.dtype([(name, order + _PLY_TYPES[kind]) for name, kind in properties])
        columns = np.frombuffer(body, layout, count)
    return np.stack([columns["x"], columns["y"], columns["z"]], axis=1).astype(float)


def connected_parts(model) -> list[np.ndarray]:
    """The vertices of each connected part of a mesh; equal vertices are one."""
    vertices, same = np.unique(np.array(model.vertices()), axis=0, return_inverse=True)
    same = same.ravel()
    parent = list(range(len(vertices)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for index in range(model.num_tris):
        triangle = model.tri_indices(index)
        corners = [root(int(same[triangle[i]])) for i in range(3)]
        parent[corners[1]] = parent[corners[2]] = corners[0]
    labels = np.array([root(i) for i in range(len(vertices))])
    return [vertices[labels == label] for label in np.unique(labels)]
