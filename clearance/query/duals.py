"""The paper's way to a common region: the hull of the dual points of all half-spaces, and back.

Not for: everyday use; cutting is faster at every size measured (`POLYTOPES.md`).
"""

from __future__ import annotations

import numpy as np

from clearance.query.cutting import CuttingTask
from clearance.query.region import Region


def dual_region(task: CuttingTask) -> Region:
    """The region by one hull over all planes' dual points about the common point, by Qhull.

    Source: Tereshchenko (2013), section 2.3.
    """
    from scipy.spatial import ConvexHull

    normals = np.concatenate([body.normals for body in task.bodies])
    offsets = np.concatenate([body.offsets_about(task.origin) for body in task.bodies])
    points = normals / offsets[:, None]
    hull = ConvexHull(points)
    places = hull.equations[:, :3] / -hull.equations[:, 3:]
    corner = points[hull.simplices]
    turned = np.einsum("ij,ij->i", np.cross(corner[:, 0], corner[:, 1]), corner[:, 2])
    planes = np.where(turned[:, None] < 0.0, hull.simplices[:, ::-1], hull.simplices)
    return _rings_of_dual(task, places, planes)


def _rings_of_dual(task: CuttingTask, places: np.ndarray, planes: np.ndarray) -> Region:
    """Around each plane its dual triangles follow each other: (plane, b, c) after (plane, a, b)."""
    after = {
        (t[k], t[(k + 1) % 3]): (t[(k + 2) % 3], i)
        for i, t in enumerate(planes.tolist())
        for k in range(3)
    }
    begin = {name: second for name, second in after}
    names, starts, corners = [], [0], []
    for name in sorted(begin):
        second = first = begin[name]
        while True:
            second, i = after[(name, second)]
            corners.append(i)
            if second == first:
                break
        names.append(name)
        starts.append(len(corners))
    return Region(task, places, np.array(names), np.array(starts), np.array(corners))
