"""What we use of numba beyond its documented interface: a test for each row of the table in `numba_private`."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
import threading
import tomllib
from collections.abc import Callable
from copy import deepcopy
from importlib.metadata import version
from pathlib import Path
from types import SimpleNamespace

import numba
import numpy as np
import pytest
from numba.core import codegen
from packaging.requirements import Requirement

from clearance.compile import kernel_table, numba_private
from clearance.compile.heap import HeapHandle
from clearance.compile.jit import inline, kernel
from clearance.compile.kernel_table import apart, at_address, borrow, call, lend
from clearance.compile.numba_private import KernelCache, kernel_of, lay_on_heap
from clearance.kernels.arithmetic.lanes import lane, lanes_at, number_at
from clearance.kernels.arithmetic.vec3 import Vec3, rigid, row
from clearance.kernels.polytope.bodies import INDICES, NUMBERS, array_at
from tests.reached import reached

ROOT = Path(__file__).parents[2]
PRIVATE = ("numba.core", "numba.np", "numba.experimental", "numba.cpython", "numba._")

compiled_only = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled here")


def test_the_installed_numba_is_one_that_these_tests_ran_with():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    (found,) = (r for r in map(Requirement, project["dependencies"]) if r.name == "numba")
    assert any(bound.operator == "<" for bound in found.specifier)
    assert found.specifier.contains(version("numba"), prereleases=True)


def imported_by(tree: ast.AST) -> list[str]:
    names = [a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names]
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return names


def test_two_files_alone_use_what_numba_does_not_document():
    users = set()
    for path in (ROOT / "clearance").rglob("*.py"):
        source = path.read_text(encoding="utf-8")
        if "numba" in source and any(
            name.startswith(PRIVATE) for name in imported_by(ast.parse(source))
        ):
            users.add(path.relative_to(ROOT / "clearance").as_posix())
        elif any(
            word in source for word in ("call_conv", "_nrt", "_compile_for_args", "config.OPT =")
        ):
            users.add(path.name)
    assert users == {"compile/numba_private.py", "machine_code.py"}


def theirs(x):
    return 3.0 * x


class PassLog:
    """At which levels LLVM optimises whole modules, by thread."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._levels: dict[int, list[int]] = {}
        self._make = codegen.create_pass_builder
        self.at_each: Callable[[], None] = lambda: None
        monkeypatch.setattr(codegen, "create_pass_builder", self._recorded)

    def _recorded(self, machine, opt, **options):
        self.at_each()
        if opt != 0:  # the cheap pass that numba runs first, at every level
            self._levels.setdefault(threading.get_ident(), []).append(int(opt))
        return self._make(machine, opt=opt, **options)

    def of(self, function) -> set[int]:
        """The levels at which this thread compiles a function."""
        mine = self._levels.setdefault(threading.get_ident(), [])
        mine.clear()
        function.compile((numba.float64,))
        assert mine
        return set(mine)


@compiled_only
def test_our_functions_have_our_level_and_others_keep_theirs(monkeypatch):
    """Others are compiled before, after, and by a thread that comes while ours is at it."""
    ours = kernel_of(lambda x: 2.0 * x)
    before, meanwhile, after = (numba.njit(theirs) for _ in range(3))
    log, level, found = PassLog(monkeypatch), type(numba.config.OPT)(2), []
    monkeypatch.setattr(numba.config, "OPT", level)
    waiting = threading.Thread(target=lambda: found.append(log.of(meanwhile)))

    def begin_another() -> None:
        if ours.is_compiling and waiting.ident is None:
            waiting.start()

    log.at_each = begin_another
    assert log.of(before) == {int(level)}
    assert log.of(ours) == {numba_private.levels()[0]}
    waiting.join()
    assert found == [{int(level)}]
    assert log.of(after) == {int(level)}
    assert numba.config.OPT is level


@compiled_only
def test_our_level_is_given_back_where_compiling_fails():
    level = numba.config.OPT
    with pytest.raises(numba.TypingError):
        kernel_of(lambda x: x.nothing).compile((numba.float64,))
    assert numba.config.OPT is level


@compiled_only
def test_the_environment_overrules_our_level(monkeypatch):
    monkeypatch.setenv("NUMBA_OPT", "2")
    try:
        with numba_private.own_level():
            assert int(numba.config.OPT) == 2 == numba_private.levels()[0]
    finally:
        monkeypatch.undo()
        numba.config.reload_config()


USES_THE_PACKAGE = """
import numba
level = numba.config.OPT
import clearance as cl
box = cl.box((1.0, 1.0, 1.0))
assert cl.distance(box, box).distance == 0.0
assert numba.config.OPT is level, numba.config.OPT
"""


@compiled_only
def test_using_the_package_leaves_the_settings_of_the_process():
    done = subprocess.run(
        [sys.executable, "-c", USES_THE_PACKAGE], cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True, text=True,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


@inline
def scaled(x, k):
    return x * k


@compiled_only
def test_an_inner_function_has_one_form_for_all_values_and_widths():
    calling = numba.njit(lambda x, k: scaled(x, 2) + scaled(x, 3) + scaled(x, k))
    assert calling(1.0, 4) == 9.0
    assert calling(1.0, np.int32(4)) == 9.0
    assert list(scaled.overloads) == [(numba.float64, numba.int64)]


@inline
def first_of(arrays):
    return arrays[0]


@compiled_only
def test_an_array_is_not_handed_on_to_a_kernel_that_counts_no_references():
    """One form of `first_of` would serve both: where only one counts, an array is freed while it is in use."""

    @numba.njit  # not cached: `first_of` is compiled here, with counts
    def counting(arrays):
        return first_of(arrays)[0]

    @kernel(reference_counts=False)
    def not_counting(arrays):
        return first_of(arrays)[0]

    arrays = (np.ones(2), np.zeros(2))
    assert counting(arrays) == 1.0
    with pytest.raises(
        Exception, match="first_of returns an array to a kernel without reference counts"
    ):
        not_counting(arrays)


@compiled_only
@pytest.mark.parametrize(
    "options",
    [{"force": True}, {"reference_counts": False}, {}],
    ids=["forced", "not counting", "left to the compiler"],
)
def test_what_counts_no_references_makes_no_array(options):
    made = inline(**options)(lambda n: np.zeros(n).sum())
    calling = numba.njit(lambda n: made(n))
    if options:
        with pytest.raises(numba.TypingError, match="Only accept returning of array passed"):
            calling(3)
    else:
        assert calling(3) == 0.0


@compiled_only
def test_what_counts_makes_arrays_whoever_calls_it():
    summed = inline(reference_counts=True)(lambda n: np.ones(n).sum())
    calling = numba_private.kernel_of(lambda n: summed(n) + 1.0, reference_counts=False)
    assert calling(3) == 4.0


def refusing(n):
    if n > 1:
        raise ValueError("too large", n)
    return n


@compiled_only
def test_of_what_is_linked_into_kernels_no_machine_code_is_written(monkeypatch):
    """Once in the kernel is enough; what it raises needs its environment, which the kernel's code is told."""
    written, write = [], codegen.JITCodeLibrary._finalize_specific
    monkeypatch.setattr(
        codegen.JITCodeLibrary,
        "_finalize_specific",
        lambda library: [written.append(library.name), write(library)],
    )
    inner = kernel_of(refusing, numba_private.KernelForKernels)
    calling = kernel_of(lambda n: inner(n) + 1)
    assert calling(1) == 2
    with pytest.raises(ValueError, match="too large") as raised:
        calling(5)
    assert raised.value.args == ("too large", 5)
    assert len(inner.overloads) == 1 and written and "refusing" not in written


def added(x, k):
    total = 0
    for i in range(k):
        total += x + i
    return total


@compiled_only
def test_what_is_merged_into_its_caller_is_not_copied(monkeypatch):
    """Nobody else has what numba reads to merge it: one function, merged twice, is read twice."""
    copied = []
    monkeypatch.setattr(
        numba.core.inline_closurecall,
        "copy",
        SimpleNamespace(deepcopy=lambda block: copied.append(block) or deepcopy(block)),
    )
    merged = kernel_of(added, numba_private.KernelForKernels, inline="always")
    calling = kernel_of(lambda x: (merged(x, 3), merged(2 * x, 2)))
    assert calling(10) == (33, 41)
    assert copied == []
    theirs = numba.njit(inline="always")(added)
    assert numba.njit(lambda x: theirs(x, 3))(10) == 33
    assert copied != []  # which shows that it is there that numba copies


@compiled_only
def test_what_only_kernels_can_call_is_refused_to_python():
    with pytest.raises(TypeError, match=r"vec3\.rigid can be called by kernels only"):
        rigid(np.eye(4))
    assert reached(rigid)(np.eye(4)).xx == 1.0
    with pytest.raises(TypeError, match="by kernels only"):
        rigid(np.eye(4))


class InMemory:
    """The files of a kernel, in memory."""

    folder = ""

    def __init__(self, kept: dict[str, bytes], entries: dict[tuple, object]) -> None:
        self.kept, self.entries = kept, entries

    def read(self, named, kind):
        return self.kept.get(named)

    def write(self, named, kind, payload):
        self.kept[named] = payload()

    def entry(self, form):
        return self.entries.get(form)

    def keep_entry(self, form, entry):
        self.entries[form] = entry


@compiled_only
def test_a_compiled_form_is_kept_as_bytes_and_taken_back(monkeypatch):
    kept: dict[str, bytes] = {}
    entries: dict[tuple, object] = {}

    def taken() -> int:
        function = kernel_of(theirs)
        function._cache = KernelCache(InMemory(kept, entries))
        assert function(2.0) == 6.0
        return sum(function.stats.cache_hits.values())

    assert (taken(), len(kept), taken()) == (0, 1, 1)
    assert list(entries) == [("d",)]
    (named,) = kept
    kept[named] = b"from another numba"
    assert (taken(), taken()) == (0, 1)
    monkeypatch.setattr(numba_private, "OWN_LEVEL", 2)
    assert (taken(), len(kept)) == (0, 2)


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch) -> int:
    """One more place in a table that nothing is entered in."""
    monkeypatch.setattr(kernel_table, "_table", np.zeros((13, 2), dtype=np.int64))
    monkeypatch.setattr(kernel_table, "_apart", dict(kernel_table._apart))
    return 12


def sum_of(lent):
    vector, numbers = borrow(lent)
    if vector.x < 0.0:
        raise ValueError("x is negative")
    return vector.x + vector.y + vector.z + numbers[-1]


def ask_for_sum(x, numbers, table):
    return at_address(table, 12, 1.0, (lend((Vec3(x, 2.0, 3.0), numbers)),))


def test_a_kernel_is_called_by_its_address_and_what_it_raises_is_handed_on(place):
    like = (Vec3(0.0, 0.0, 0.0), np.zeros(1))
    apart(place, lambda: (kernel_table.LentArgument(like),))(sum_of)
    asking = kernel(ask_for_sum)
    assert call(asking, 1.0, np.array([0.0, 4.0])) == 10.0
    if not numba.config.DISABLE_JIT:
        assert (kernel_table._table[place] != 0).all()
    with pytest.raises(ValueError, match="x is negative"):
        call(asking, -1.0, np.ones(1))


def test_elements_are_found_by_their_address():
    points = np.arange(12.0).reshape(4, 3)
    lanes = np.arange(8.0).reshape(2, 4)
    assert reached(kernel_row)(points, 2) == (6.0, 7.0, 8.0)
    assert reached(kernel_lane)(lanes, 1) == 4.0 + 7.0


@inline
def kernel_row(points, i):
    return row(points, i)


@inline
def kernel_lane(lanes, i):
    return lane(lanes_at(lanes, i), 0) + number_at(lanes, i, 3)


@inline
def ends_of(rows, i):
    first = i * rows.shape[1]
    numbers = array_at(rows, first + NUMBERS, np.float64)
    return numbers[-1] + array_at(rows, first + INDICES, np.int64)[-1]


def test_arrays_are_reached_by_their_addresses():
    numbers, indices = np.array([0.5, 1.5]), np.array([7, 8, 9])
    one = [numbers.ctypes.data, len(numbers), indices.ctypes.data, len(indices)]
    rows = np.array([[0, 0, 0, 0], one], dtype=np.int64)
    assert reached(ends_of)(rows, 1) == 10.5


if not numba.config.DISABLE_JIT:

    class Cell(HeapHandle):
        pass

    lay_on_heap(Cell, ("level", "numbers"))


@compiled_only
def test_a_structure_lies_on_the_heap_and_its_fields_change():
    @numba.njit
    def made(numbers):
        return Cell(1, numbers)

    @numba.njit
    def raised(cell):
        cell.level = cell.level + 1
        return cell.level + cell.numbers[0]

    cell = made(np.array([10.0]))
    assert (raised(cell), raised(cell)) == (12.0, 13.0)
