"""What is asked of every case of a batch, with the key of it. Not for: which cases there are (`manifest`)."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from datetime import date
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from clearance.case.tolerance.tolerance_file import tolerance_digest
from clearance.errors import BadBatch, BadInput
from clearance.formats.files.input_files import read_bytes
from clearance.formats.motion.requests import files_of
from clearance.options import made, options_in
from clearance.run import CheckOptions, Question
from clearance.world.case import Case
from clearance.world.rules import Waiver

_WAIVERS = TypeAdapter(tuple[Waiver, ...])

_KEYED_BY_CONTENT = ("tolerance", "recorded", "waivers", "today")
"""Options of which the value says too little, or, of the day, too much: it decides only cases with waivers."""


@dataclass(frozen=True)
class CaseOptions:
    """What is asked of a case.

    Attributes:
        asked: paths are absolute, waivers are read, and there is a day.
        files_key: sha256 of what is in the files that it names.
    """

    asked: CheckOptions
    files_key: str

    @classmethod
    def of(cls, asked: CheckOptions) -> CaseOptions:
        """The same with the key of its files as they are now.

        Raises:
            BadInput: a file that cannot be read, or is none of its sort.
        """
        return cls(asked, _files_key(asked))

    @cached_property
    def key(self) -> str:
        """sha256 of all that it says of a row."""
        asked, names = self.asked, [*options_in(CheckOptions)]
        asked_values = [
            (name, getattr(asked, name)) for name in names if name not in _KEYED_BY_CONTENT
        ]
        given = [one for one in asked.waivers if isinstance(one, Waiver)]
        waivers = [(one, one.is_expired(self.day)) for one in given]
        return hashlib.sha256(repr((asked_values, self.files_key, waivers)).encode()).hexdigest()

    @property
    def day(self) -> date:
        """That which waivers are held against."""
        assert self.asked.today is not None
        return self.asked.today

    def question(self, case: Case) -> Question:
        """The question about a case.

        Raises:
            BadInput: as `Question.of`; files that are others than the key is of.
        """
        if _files_key(self.asked) != self.files_key:
            names = [path.name for paths in self.asked.files.values() for path in paths]
            where = " or ".join(names)
            raise BadBatch("it changed during the batch", where=where, valid="the batch again")
        return Question.of(case, self.asked)

    def waived_by(self, waivers: tuple[Waiver, ...]) -> CaseOptions:
        """The same with these waivers."""
        return replace(self, asked=replace(self.asked, waivers=waivers))

    def of_report(self) -> CaseOptions:
        """The same for a full report, which shows every step."""
        return replace(self, asked=replace(self.asked, need="steps"))

    def plain(self) -> dict[str, Any]:
        """The options as plain data, which `of_plain` reads."""
        known = options_in(CheckOptions).items()
        values = {name: getattr(self.asked, name) for name, _ in known}
        plain = {name: values[name] for name, one in known if values[name] != one.default}
        return plain | {"waivers": [asdict(one) for one in values["waivers"]]}

    @classmethod
    def of_plain(cls, plain: Mapping[str, Any]) -> CaseOptions:
        """The options that `plain` returns, with the key of their files as they are now.

        Raises:
            BadInput, ValueError: they are none.
        """
        waivers = _WAIVERS.validate_python(plain.get("waivers", ()))
        asked = made(CheckOptions, {**plain, "waivers": waivers})
        try:
            return cls.of(asked)
        except BadInput:
            return cls(asked, "none")


def _files_key(asked: CheckOptions) -> str:
    named = [(name, path) for name, paths in asked.files.items() for path in paths]
    found = [(name, _digest(name, path)) for name, path in named]
    return hashlib.sha256(repr(found).encode()).hexdigest() if found else ""


def _digest(name: str, path: Path) -> str:
    """sha256 of what an option has from its file; a recording may be a folder."""
    if name == "tolerance":
        return tolerance_digest(path)
    files = files_of(path) if path.is_dir() else [path]
    digests = [hashlib.sha256(read_bytes(one, one.name)).hexdigest() for one in files]
    return hashlib.sha256(repr(digests).encode()).hexdigest()
