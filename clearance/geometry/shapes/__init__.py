"""Ready-made solids: box, cylinder, sphere, capsule, pipe, about the origin with the axis along z (as in URDF).

Round shapes are faceted from outside: the true solid lies within the faceted one, and `excess` bounds by how
much the faceted one is larger. Not for: shapes from files (room `load`).
"""

from clearance.geometry.shapes.box import box
from clearance.geometry.shapes.pipe import pipe
from clearance.geometry.shapes.round import capsule, cylinder, sphere

__all__ = ["box", "capsule", "cylinder", "pipe", "sphere"]
