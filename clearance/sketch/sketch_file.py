"""Sketch files: YAML with parameters, entities, constraints, in the order in which they are made.

```yaml
parameters: {W: 10.0}
points: {a: [0, 0], b: [9.7, 0.2]}
lines: {l: [a, b]}                 # or [[x, y], [x, y]] for a line without points
segments: {edge: [a, b]}
circles: {c: {center: [4, 3], radius: 2.1}}
arcs: {round: {center: m, start: p, end: q}}
constraints:
  - {kind: distance, of: [a, b], value: W, name: width}
```
Directions are stored in radians. Not for: anything but sketches.
"""

from __future__ import annotations

import io
from pathlib import Path

from clearance.errors import BadSyntax, Contradiction, MissingKey, UnknownKey, at, nearest_name
from clearance.files import write_file
from clearance.plain_yaml import yaml_file
from clearance.sketch.entities import Line

_SECTIONS = ("parameters", "points", "lines", "segments", "circles", "arcs", "constraints")
AS_DRAWN = 1e-6
"""[-] How far the value that a file has of a driven dimension may be off, [m], [rad] or relative."""

_FIELDS = {"kind", "of", "value", "name", "driven", "inside"}


def read(path: Path, kind):
    """The sketch in a file.

    Raises:
        MissingFile, BadSyntax, MissingKey, UnknownKey, and what the sketch's own methods raise,
        each with the file and the field.
    """
    with at(str(path)):
        return sketch_of(yaml_file(path, "a sketch file"), kind)


def sketch_of(content: object, kind):
    """The sketch that the content of a file says.

    Raises:
        As `read`, with the field.
    """
    if not isinstance(content, dict):
        raise BadSyntax("is not a sketch", valid=f"a mapping with {', '.join(_SECTIONS)}")
    sketch = kind()
    for section in content:
        if section not in _SECTIONS:
            raise UnknownKey(
                f"unknown section {section!r}", valid=nearest_name(str(section), _SECTIONS)
            )
    _entities(sketch, content)
    for i, entry in enumerate(_listed(content.get("constraints"))):
        with at(f"constraints[{i}]"):
            _constraint(sketch, entry)
    return sketch


def _mapping(content: dict, section: str) -> dict:
    value = content.get(section) or {}
    if not isinstance(value, dict):
        raise BadSyntax(f"{section} is not a mapping", valid="name: value")
    return {str(name): entry for name, entry in value.items()}


def _listed(value) -> list:
    if value is None:
        return []
    if not isinstance(value, list):
        raise BadSyntax("constraints is not a list", valid="- {kind: ..., of: [...]}")
    return value


def _entities(sketch, content: dict) -> None:
    makers = {
        "parameters": lambda value, name: sketch.parameter(name, value),
        "points": lambda place, name: sketch.point(*_some(place, 2), name=name),
        "lines": lambda ends, name: sketch.line(*_ends(sketch, ends), name=name),
        "segments": lambda ends, name: sketch.segment(*_ends(sketch, ends), name=name),
        "circles": lambda entry, name: sketch.circle(*_circle(sketch, entry), name=name),
        "arcs": lambda entry, name: sketch.arc(*_arc(sketch, entry), name=name),
    }
    for section, make in makers.items():
        for name, value in _mapping(content, section).items():
            with at(f"{section}.{name}"):
                make(value, name)


def _ends(sketch, ends) -> list:
    return [_place(sketch, e) for e in _some(ends, 2)]


def _circle(sketch, entry) -> tuple:
    center, radius = _fields(entry, ("center", "radius"))
    return _place(sketch, center), radius


def _arc(sketch, entry) -> tuple:
    center, *ends = _fields(entry, ("center", "start", "end"))
    return _place(sketch, center), *(sketch.entity(str(end)) for end in ends)


def _place(sketch, value):
    return sketch.entity(value) if isinstance(value, str) else value


def _some(value, count: int) -> list:
    if not isinstance(value, list) or len(value) != count:
        raise BadSyntax(f"{value!r} given", valid=f"a list of {count}")
    return value


def _fields(entry, names: tuple[str, ...]) -> list:
    if not isinstance(entry, dict):
        raise BadSyntax(f"{entry!r} given", valid=f"a mapping with {', '.join(names)}")
    for name in names:
        if name not in entry:
            raise MissingKey(f"{name} is missing", valid=f"{', '.join(names)}")
    for key in entry:
        if key not in names:
            raise UnknownKey(f"unknown key {key!r}", valid=nearest_name(str(key), names))
    return [entry[name] for name in names]


def _constraint(sketch, entry) -> None:
    if not isinstance(entry, dict) or "kind" not in entry or "of" not in entry:
        raise MissingKey("kind or of is missing", valid="{kind: ..., of: [...]}")
    for key in entry:
        if key not in _FIELDS:
            raise UnknownKey(f"unknown key {key!r}", valid=nearest_name(str(key), _FIELDS))
    of = entry["of"] if isinstance(entry["of"], list) else [entry["of"]]
    options = {k: entry[k] for k in ("value", "name", "driven", "inside") if k in entry}
    added = sketch.add(str(entry["kind"]), *map(str, of), **options)
    if added.driven and isinstance(entry.get("value"), int | float):
        drawn = sketch.value(added.name)
        if not abs(entry["value"] - drawn) <= AS_DRAWN * (1.0 + abs(drawn)):
            raise Contradiction(
                f"{added.kind} {added.name} is driven, so {entry['value']:.9g} is not asked for: the drawing has "
                f"{drawn:.9g}",
                valid="leave out `driven` to ask for the value, or leave out the value",
            )


def write(sketch, path: Path) -> None:
    """Writes a sketch; reading it back gives the same numbers bit for bit.

    Raises:
        Unwritable: the file cannot be written.
    """
    from ruamel.yaml import YAML

    yaml = YAML()
    yaml.default_flow_style = None
    yaml.width = 110
    text = io.StringIO()
    yaml.dump(tree_of(sketch), text)
    write_file(path, text.getvalue().encode())


def tree_of(sketch) -> dict:
    """The content of a sketch's file: numbers, lists and mappings; see `sketch_of`."""
    tree: dict = {name: {} for name in _SECTIONS[:-1]}
    tree["parameters"] = dict(sketch.parameters)
    for name, e in sketch.entities.items():
        if e.what == "point":
            tree["points"][name] = e.position.tolist()
        elif e.what in ("line", "segment"):
            tree[e.what + "s"][name] = [p.name for p in e.ends] if e.ends else _drawn(e)
        elif e.what == "circle":
            tree["circles"][name] = {"center": e.center.name, "radius": e.radius}
        else:
            tree["arcs"][name] = {"center": e.center.name, "start": e.start.name, "end": e.end.name}
    tree["constraints"] = [_entry(sketch, c) for c in sketch.constraints.values() if not c.built_in]
    return {k: v for k, v in tree.items() if v}


def _drawn(line: Line) -> list:
    foot = line.foot
    return [(foot - 0.5 * line.direction).tolist(), (foot + 0.5 * line.direction).tolist()]


def _entry(sketch, c) -> dict:
    entry = {"kind": c.kind, "of": [e.name for e in c.entities]}
    if c.given is not None:
        entry["value"] = sketch.value(c.name) if c.driven else c.given
    entry["name"] = c.name
    if c.driven:
        entry["driven"] = True
    return entry | c.options
