"""The links of robots as a sweep takes them."""

from dataclasses import replace

from clearance.world.case import Case
from clearance.world.forest import forest_of


def links_of(placed):
    """The links of some placed robots behind one another."""
    named = [
        replace(one, robot=replace(one.robot, name=f"robot_{i}")) for i, one in enumerate(placed)
    ]
    return forest_of(Case("forest", tuple(named), ())).links
