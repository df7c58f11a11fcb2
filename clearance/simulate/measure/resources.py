"""What a long run may use: threads, a call that reports progress, and a place for its rows."""

from __future__ import annotations

from dataclasses import dataclass, replace

from clearance.errors import BadInput
from clearance.progress import Progress
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.simulate.measure.parts import usable_cores


@dataclass(frozen=True, eq=False)
class Resources:
    """The resources of a run.

    Attributes:
        jobs: threads; as many as the machine has to offer if None. The answer does not depend on it.
        progress: called with steps done and all steps.
        rows: where they are stored; in memory by default. In `open_resumable_rows` memory does not grow with the
            steps, and the same question asked again goes on where an interrupted run was.
        prefix: of the names of its rows.

    Raises:
        BadInput: fewer than one thread.
    """

    jobs: int | None = None
    progress: Progress | None = None
    rows: MeasuredRows = IN_MEMORY
    prefix: str = ""

    def __post_init__(self) -> None:
        if self.jobs is not None and (not isinstance(self.jobs, int) or self.jobs < 1):
            raise BadInput(f"{self.jobs} jobs", valid="1 or more")

    def of_section(self, number: int, steps: tuple[int, int], of: int) -> Resources:
        """The same for one section of several, whose rows have names of their own.

        Args:
            steps: of all sections before it, and with it. of: of all sections.
        """
        progress, (before, end) = self.progress, steps

        def shifted(done: int, total: int) -> None:
            """Counts in steps what a measurement counts in its own parts."""
            assert progress is not None
            progress(before + (end - before) * done // total, of)

        return replace(self, progress=progress and shifted, prefix=f"{self.prefix}{number}-")

    @property
    def n_threads(self) -> int:
        """How many threads there are to be."""
        return self.jobs or usable_cores()


DEFAULT_RESOURCES = Resources()
"""All threads, no progress reported, rows in memory."""
