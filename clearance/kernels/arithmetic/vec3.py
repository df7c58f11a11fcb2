"""Points and vectors in space, and rigid motions, as plain tuples that stay in registers.

Not for: arrays of points (numpy) and poses as users give them (room `geometry.pose`).
"""

from typing import NamedTuple

from clearance.compile.decorators import CHECKS_BOUNDS, inline, when_compiling


class Vec3(NamedTuple):
    """A point or vector [m]."""

    x: float
    y: float
    z: float


class RigidMotion(NamedTuple):
    """A rigid motion x -> R x + t, row by row."""

    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    zx: float
    zy: float
    zz: float
    t: Vec3


@inline(force=True)
def add(a, b):
    """a + b."""
    return Vec3(a.x + b.x, a.y + b.y, a.z + b.z)


@inline(force=True)
def sub(a, b):
    """a - b."""
    return Vec3(a.x - b.x, a.y - b.y, a.z - b.z)


@inline(force=True)
def along(a, s, d):
    """a + s d."""
    return Vec3(a.x + s * d.x, a.y + s * d.y, a.z + s * d.z)


@inline(force=True)
def dot(a, b):
    """The scalar product."""
    return a.x * b.x + a.y * b.y + a.z * b.z


@inline(force=True)
def cross(a, b):
    """The vector product."""
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@inline(force=True)
def gap_sq(a, b):
    """The squared distance of two points."""
    x = a.x - b.x
    y = a.y - b.y
    z = a.z - b.z
    return x * x + y * y + z * z


def row(array, i):
    """Row `i`, from 0, of an (n, 3) array that lies in one piece."""
    return Vec3(array[i, 0], array[i, 1], array[i, 2])


def _row_by_address():
    from numba import types
    from numba.extending import intrinsic

    from clearance.compile.intrinsics import elements_at, stands_for

    @intrinsic
    def row_at(typing_context, array, i):
        place = types.NamedUniTuple(array.dtype, 3, Vec3)
        if array.layout != "C":
            raise TypeError(f"{array} does not lie in one piece")

        def emit(context, builder, signature, values):
            start = builder.mul(values[1], values[1].type(3), flags=["nsw"])
            indices = [builder.add(start, start.type(k), flags=["nsw"]) for k in range(3)]
            numbers = map(builder.load, elements_at(context, builder, array, values[0], indices))
            return context.make_tuple(builder, place, list(numbers))

        return place(array, types.intp), emit

    stands_for(row, row_at)


if CHECKS_BOUNDS:
    inline(force=True)(row)
else:
    when_compiling.append(_row_by_address)


@inline(force=True)
def turn(m, v):
    """R v."""
    return Vec3(
        m.xx * v.x + m.xy * v.y + m.xz * v.z,
        m.yx * v.x + m.yy * v.y + m.yz * v.z,
        m.zx * v.x + m.zy * v.y + m.zz * v.z,
    )


@inline(force=True)
def turned_back(m):
    """The rotation R^T, without a translation."""
    return RigidMotion(m.xx, m.yx, m.zx, m.xy, m.yy, m.zy, m.xz, m.yz, m.zz, Vec3(0.0, 0.0, 0.0))


@inline(force=True)
def turn_back(m, v):
    """R^T v."""
    return turn(turned_back(m), v)


@inline(force=True)
def move(m, v):
    """R v + t."""
    return add(turn(m, v), m.t)


@inline(force=True)
def move_back(m, v):
    """R^T (v - t): the inverse motion."""
    return turn_back(m, sub(v, m.t))


@inline(force=True)
def inverse(m):
    """The motion x -> R^T (x - t)."""
    t = turn_back(m, m.t)
    return RigidMotion(m.xx, m.yx, m.zx, m.xy, m.yy, m.zy, m.xz, m.yz, m.zz, Vec3(-t.x, -t.y, -t.z))


@inline(force=True)
def rigid(matrix):
    """The motion that a (4, 4) or (3, 4) matrix describes."""
    return RigidMotion(
        matrix[0, 0], matrix[0, 1], matrix[0, 2],
        matrix[1, 0], matrix[1, 1], matrix[1, 2],
        matrix[2, 0], matrix[2, 1], matrix[2, 2],
        Vec3(matrix[0, 3], matrix[1, 3], matrix[2, 3]),
    )  # fmt: skip


@inline(force=True)
def _product(a, b, t):
    """The motion x -> R_a R_b x + t."""
    return RigidMotion(
        a.xx * b.xx + a.xy * b.yx + a.xz * b.zx,
        a.xx * b.xy + a.xy * b.yy + a.xz * b.zy,
        a.xx * b.xz + a.xy * b.yz + a.xz * b.zz,
        a.yx * b.xx + a.yy * b.yx + a.yz * b.zx,
        a.yx * b.xy + a.yy * b.yy + a.yz * b.zy,
        a.yx * b.xz + a.yy * b.yz + a.yz * b.zz,
        a.zx * b.xx + a.zy * b.yx + a.zz * b.zx,
        a.zx * b.xy + a.zy * b.yy + a.zz * b.zy,
        a.zx * b.xz + a.zy * b.yz + a.zz * b.zz,
        t,
    )  # fmt: skip


@inline(force=True)
def after(a, b):
    """The motion `b` and then `a`: x -> a(b(x))."""
    return _product(a, b, move(a, b.t))


@inline(force=True)
def relative(world_from_a, world_from_b):
    """The motion `a_from_b`; the origins are differenced before anything is multiplied."""
    a_from_world = turned_back(world_from_a)
    t = turn(a_from_world, sub(world_from_b.t, world_from_a.t))
    return _product(a_from_world, world_from_b, t)
