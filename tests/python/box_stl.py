"""Writes boxes as binary STL, for tests of meshes."""

import hashlib
import struct
from pathlib import Path

import numpy as np

from plan_checker import shapes


def write_box_stl(path: Path, *boxes) -> str:
    """Binary STL of boxes given as (centre, size); returns its sha256."""
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = []
    for centre, size in boxes:
        corners = np.asarray(centre) + shapes.SIGNS * np.asarray(size) / 2
        for a, b, c, d in quads:
            triangles += [
                (corners[a], corners[b], corners[c]),
                (corners[a], corners[c], corners[d]),
            ]
    data = bytes(80) + struct.pack("<I", len(triangles))
    for triangle in triangles:
        data += struct.pack("<12f", 0, 0, 0, *np.concatenate(triangle)) + b"\0\0"
    path.write_bytes(data)
    return hashlib.sha256(data).hexdigest()
