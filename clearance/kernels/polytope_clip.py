"""Cutting a convex polytope by half-spaces, one after another, on its trivalent form.

A trivalent vertex lies on three planes; `planes[v]` names them in order and `across[v, k]` is the vertex at
the other end of the edge that leaves plane k. A corner of more faces is several such vertices at one place,
joined by edges of length zero. So every cut is one operation: take away the connected vertices above the
plane, put one new vertex on each edge that leads out of them. This is the dual of inserting a point into a
convex hull; new places are interpolated on edges and cannot run away. Not for: choosing the order of bodies.
"""

from __future__ import annotations

import numpy as np

from clearance.jit import inlined, kernel

REDUNDANT, CUT, EMPTY, BROKEN = 0, 1, 2, 3


@inlined
def height(places, v, normal, offset):
    """[m] How far trivalent vertex `v` stands above the plane."""
    return normal[0] * places[v, 0] + normal[1] * places[v, 1] + normal[2] * places[v, 2] - offset


@inlined
def flood_plateau(places, across, start, normal, offset, noise, stamps, stamp, queue):
    """A vertex above `start` next to the level ground about it, or -1; level means within `noise`."""
    level = height(places, start, normal, offset)
    queue[0] = start
    stamps[start] = stamp
    n_queue = 1
    i = 0
    while i < n_queue:
        for k in range(3):
            w = across[queue[i], k]
            if stamps[w] == stamp:
                continue
            value = height(places, w, normal, offset)
            if value > level + noise:
                return w
            if value >= level - noise:
                stamps[w] = stamp
                queue[n_queue] = w
                n_queue += 1
        i += 1
    return -1


@inlined
def climb(places, across, start, normal, offset, noise, stop, stamps, stamp, queue):
    """The first vertex above `stop` met on the way up from `start`, or the top vertex.

    Source: hill climbing of Tereshchenko (2013), section 1; level ground is searched by flooding.
    """
    v = start
    value = height(places, v, normal, offset)
    while value <= stop:
        best = v
        for k in range(3):
            w = across[v, k]
            there = height(places, w, normal, offset)
            if there > value:
                best = w
                value = there
        if best == v:
            best = flood_plateau(places, across, v, normal, offset, noise, stamps, stamp, queue)
            if best < 0:
                return v
            value = height(places, best, normal, offset)
        v = best
    return v


@inlined
def gather_above(places, across, top, normal, offset, tolerance, stamps, stamp, queue):
    """Number of connected vertices above the plane, from `top`; they are `queue[:n]` and stamped."""
    queue[0] = top
    stamps[top] = stamp
    n_above = 1
    i = 0
    while i < n_above:
        for k in range(3):
            w = across[queue[i], k]
            if stamps[w] != stamp and height(places, w, normal, offset) > tolerance:
                stamps[w] = stamp
                queue[n_above] = w
                n_above += 1
        i += 1
    return n_above


@inlined
def new_corner(places, u, w, normal, offset, place):
    """Writes to `place` where the edge from `u` (above) to `w` (not above) meets the plane."""
    up = height(places, u, normal, offset)
    down = height(places, w, normal, offset)
    if down >= 0.0:
        for i in range(3):
            place[i] = places[w, i]
        return
    share = down / (down - up)
    for i in range(3):
        place[i] = places[w, i] + share * (places[u, i] - places[w, i])


@inlined
def collect_rim(places, across, planes, queue, n_above, stamps, stamp, normal, offset, rim, rim_at):
    """Number of edges that leave the stamped region; each is a row (outside, its slot, plane, plane)."""
    n_rim = 0
    for i in range(n_above):
        u = queue[i]
        for k in range(3):
            w = across[u, k]
            if stamps[w] == stamp:
                continue
            rim[n_rim, 0] = w
            for j in range(3):
                if across[w, j] == u and planes[w, j] != planes[u, (k + 1) % 3]:
                    if planes[w, j] != planes[u, (k + 2) % 3]:
                        rim[n_rim, 1] = j
            rim[n_rim, 2] = planes[u, (k + 1) % 3]
            rim[n_rim, 3] = planes[u, (k + 2) % 3]
            new_corner(places, u, w, normal, offset, rim_at[n_rim])
            n_rim += 1
    return n_rim


@inlined
def rim_is_one_ring(rim, n_rim, first, first_stamp, stamp):
    """True if the rim's edges follow each other through their planes in one ring."""
    for i in range(n_rim):
        a = rim[i, 2]
        if first_stamp[a] == stamp:
            return False
        first_stamp[a] = stamp
        first[a] = i
    i = 0
    for n_seen in range(1, n_rim + 1):
        b = rim[i, 3]
        if first_stamp[b] != stamp:
            return False
        i = first[b]
        if i == 0:
            return n_seen == n_rim
    return False


@inlined
def close_rim(places, across, planes, plane, rim, rim_at, n_rim, first, slots):
    """Links the new vertices `slots[:n_rim]` to the outside and to each other."""
    for i in range(n_rim):
        v = slots[i]
        for j in range(3):
            places[v, j] = rim_at[i, j]
        planes[v, 0] = plane
        planes[v, 1] = rim[i, 2]
        planes[v, 2] = rim[i, 3]
        across[v, 0] = rim[i, 0]
        across[rim[i, 0], rim[i, 1]] = v
        after = slots[first[rim[i, 3]]]
        across[v, 1] = after
        across[after, 2] = v


@kernel
def cut_by_planes(
    places, across, planes, state, free, normals, offsets, order, base, tolerance,
    stamps, first, first_stamp, queue, rim, rim_at, slots,
):  # fmt: skip
    """Cuts the polytope by planes `order` of one body; `base` is the number of its first plane.

    Args:
        places: (c, 3) [m]; across, planes: (c, 3); state: (4,) start vertex, number of free rows, stamp,
            highest row used. free: the free rows.
        tolerance: [m] what counts as on the plane. The rest is working space.

    Returns: (EMPTY, BROKEN or CUT, planes that cut).
    """
    n_cuts = 0
    for i_order in range(len(order)):
        i_plane = order[i_order]
        normal = normals[i_plane]
        offset = offsets[i_plane]
        state[2] += 1
        # corners slide along edges nearly parallel to a cut, so that false tops stand up to about 1e-13
        # above their neighbours: level ground is taken far wider (2 eps missed a plane, 4e-7 of a volume)
        top = climb(
            places, across, state[0], normal, offset, 1e5 * tolerance, tolerance,
            stamps, state[2], queue,
        )  # fmt: skip
        state[0] = top
        if height(places, top, normal, offset) <= tolerance:
            continue
        state[2] += 1
        stamp = state[2]
        n_above = gather_above(places, across, top, normal, offset, tolerance, stamps, stamp, queue)
        n_rim = collect_rim(
            places, across, planes, queue, n_above, stamps, stamp, normal, offset, rim, rim_at
        )
        if n_rim == 0:
            return EMPTY, n_cuts
        if not rim_is_one_ring(rim, n_rim, first, first_stamp, stamp):
            return BROKEN, n_cuts
        for i in range(n_above):
            free[state[1]] = queue[i]
            state[1] += 1
        for i in range(n_rim):
            if state[1] > 0:
                state[1] -= 1
                slots[i] = free[state[1]]
            else:
                slots[i] = state[3]
                state[3] += 1
        close_rim(places, across, planes, base + i_plane, rim, rim_at, n_rim, first, slots)
        state[0] = slots[0]
        n_cuts += 1
    return CUT, n_cuts


@kernel
def face_rings(across, planes, start, n_rows):
    """The faces of the trivalent polytope: (plane of each ring, ring starts, trivalent vertices in order)."""
    reached = np.zeros(n_rows, dtype=np.bool_)
    walked = np.zeros((n_rows, 3), dtype=np.bool_)
    queue = np.empty(n_rows, dtype=np.int64)
    queue[0] = start
    reached[start] = True
    n_queue = 1
    i = 0
    while i < n_queue:
        for k in range(3):
            w = across[queue[i], k]
            if not reached[w]:
                reached[w] = True
                queue[n_queue] = w
                n_queue += 1
        i += 1
    names = np.empty(n_queue, dtype=np.int64)
    starts = np.zeros(n_queue + 1, dtype=np.int64)
    corners = np.empty(3 * n_queue, dtype=np.int64)
    n_faces = 0
    n_corners = 0
    for i in range(n_queue):
        for k in range(3):
            v = queue[i]
            slot = k
            if walked[v, slot]:
                continue
            name = planes[v, slot]
            while not walked[v, slot]:
                walked[v, slot] = True
                corners[n_corners] = v
                n_corners += 1
                v = across[v, (slot + 1) % 3]
                for j in range(3):
                    if planes[v, j] == name:
                        slot = j
            names[n_faces] = name
            n_faces += 1
            starts[n_faces] = n_corners
    return names[:n_faces], starts[: n_faces + 1], corners[:n_corners]


@kernel
def ring_moments(places, starts, corners, origin):
    """(volume [m^3], volume times centroid less `origin` [m^4]) inside rings that close a surface."""
    moments = np.zeros(4)
    for f in range(len(starts) - 1):
        ax = places[corners[starts[f]], 0] - origin[0]
        ay = places[corners[starts[f]], 1] - origin[1]
        az = places[corners[starts[f]], 2] - origin[2]
        for e in range(starts[f] + 1, starts[f + 1] - 1):
            bx = places[corners[e], 0] - origin[0]
            by = places[corners[e], 1] - origin[1]
            bz = places[corners[e], 2] - origin[2]
            cx = places[corners[e + 1], 0] - origin[0]
            cy = places[corners[e + 1], 1] - origin[1]
            cz = places[corners[e + 1], 2] - origin[2]
            sixth = (
                ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            ) / 6.0
            moments[0] += sixth
            moments[1] += sixth * (ax + bx + cx) * 0.25
            moments[2] += sixth * (ay + by + cy) * 0.25
            moments[3] += sixth * (az + bz + cz) * 0.25
    return moments
