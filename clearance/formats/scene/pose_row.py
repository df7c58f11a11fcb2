"""A pose as a row of a YAML scene: `{xyz: […], quat_xyzw: […]}`. Not for: reading one (`schema.pose`)."""

from __future__ import annotations

import numpy as np


def pose_row(pose: np.ndarray) -> dict[str, list[float]]:
    """The row of a (4, 4) pose [m]; without a rotation where there is none.

    Exactness: the place is the same; the rotation read back is off by a few roundings.
    """
    row = {"xyz": pose[:3, 3].tolist()}
    if not np.array_equal(pose[:3, :3], np.eye(3)):
        row["quat_xyzw"] = _quaternion(pose[:3, :3])
    return row


def _quaternion(rotation: np.ndarray) -> list[float]:
    """The unit quaternion, the scalar last, by its largest component.

    Source: Shepperd, Quaternion from rotation matrix, 1978.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    rows = {
        xx + yy + zz: (zy - yz, xz - zx, yx - xy, 1 + xx + yy + zz),
        xx - yy - zz: (1 + xx - yy - zz, xy + yx, xz + zx, zy - yz),
        yy - xx - zz: (xy + yx, 1 + yy - xx - zz, yz + zy, xz - zx),
        zz - xx - yy: (xz + zx, yz + zy, 1 + zz - xx - yy, yx - xy),
    }
    quaternion = np.array(rows[max(rows)])
    return (quaternion / np.linalg.norm(quaternion)).tolist()
