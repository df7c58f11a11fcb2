"""The plain data in a YAML file, with the file's name in errors. Not for: which keys are valid (`schema.case`)."""

from __future__ import annotations

from clearance.errors import at
from clearance.plain_yaml import plain_data


def parse_yaml(data: bytes, shown: str) -> object:
    """The plain data in a YAML file.

    Args:
        shown: the file's name in errors.

    Raises:
        BadSyntax, DuplicateName: as `plain_data` says.
    """
    with at(shown):
        return plain_data(data)
