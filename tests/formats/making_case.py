"""The small case of `making`, loaded as it is or with changes."""

from clearance.case.case_file import load_case
from tests.formats.making import ARM, CASE, write_case

TWO_JOINTS = ARM.replace(
    '<joint name="flange" type="fixed"><parent link="upper"/><child link="tip"/></joint>',
    '<joint name="lift" type="prismatic"><parent link="upper"/><child link="tip"/>'
    '<limit lower="0" upper="0.1"/></joint>',
)


def load_small(folder, case=CASE, **changes):
    return load_case(write_case(folder, case, **changes))


def changed(*pairs: str) -> str:
    text = CASE
    for old, new in zip(pairs[::2], pairs[1::2], strict=True):
        assert old in text
        text = text.replace(old, new)
    return text


def with_obstacle(shape: str) -> str:
    return changed("box: {size: [0.1, 0.1, 1]}", shape)
