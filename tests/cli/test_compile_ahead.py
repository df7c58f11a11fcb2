"""What a second process compiles ahead: taken by the first, never waited for in vain.

The kernels of the search take half a minute to compile. Small ones stand in their places of the table here: how a
kernel goes from process to process does not depend on what it does.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numba
import pytest

from clearance.cli import compile_ahead
from clearance.compile import kernel_table
from clearance.simulate.parts import usable_cores
from tests.cli.test_leaving import write_case

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled here")

SMALL_KERNELS = """
from clearance.compile.kernel_table import apart

def like():
    return (1.0,)
"""
"""Imports no more than it needs: a process reads all sources that a kernel imports to know where it is kept."""
IN_THEIR_PLACES = """
from clearance.cli import compile_ahead  # after its kernels these take their places
import small_kernels

compile_ahead.ALL = compile_ahead.FIRST
"""
A_SMALL_KERNEL = """
@apart({place}, like)
def kernel_{place}(x):
    return x + {place}
"""
PLACES = (*compile_ahead.FIRST, *kernel_table.TOGETHER, kernel_table.WINDING_NUMBER)

FROM_A_SECOND_PROCESS = """
import json, subprocess
import in_their_places, small_kernels
from clearance.cli import compile_ahead
from clearance.compile import kernel_table

def with_small_kernels(command, really=subprocess.Popen, **settings):
    *python, script = command
    assert script.endswith("; main()")
    return really([*python, script.replace("; main()", "; import in_their_places; main()")], **settings)

subprocess.Popen = with_small_kernels
told = {"kept": [kernel_table.is_kept(place) for place in compile_ahead.FIRST], "first": compile_ahead.start()}
for place in compile_ahead.FIRST:
    kernel_table.compile_kernel(place)
kernels = [getattr(small_kernels, f"kernel_{place}") for place in compile_ahead.FIRST]
told["taken"] = [sum(f.stats.cache_hits.values()) for f in kernels]
told["made"] = [sum(f.stats.cache_misses.values()) for f in kernels]
told["again"] = compile_ahead._start_once.__wrapped__()
print(json.dumps(told))
"""

FROM_ONE_THAT_ENDS = """
import json, subprocess, sys
import in_their_places, small_kernels
from clearance.compile import kernel_table
process = subprocess.Popen([sys.executable, "-c", ""], stdout=subprocess.PIPE)
kernel_table.await_from(process, [kernel_table.WINDING_NUMBER])
kernel_table.compile_kernel(kernel_table.WINDING_NUMBER)
print(json.dumps(sum(small_kernels.kernel_4.stats.cache_misses.values())))
"""

FROM_ONE_THAT_IS_BUSY_WITH_ANOTHER = """
import json, subprocess, sys
import in_their_places, small_kernels
from clearance.compile import kernel_table
process = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"], stdout=subprocess.PIPE)
kernel_table.await_from(process, [kernel_table.SEARCH, kernel_table.WINDING_NUMBER])
kernel_table.compile_kernel(kernel_table.WINDING_NUMBER)
runs = process.poll() is None
process.kill()
print(json.dumps([sum(small_kernels.kernel_4.stats.cache_misses.values()), runs]))
"""

WHAT_GOES_TOGETHER = '''
import json, subprocess, sys
import in_their_places, small_kernels
from clearance.compile import kernel_table
from clearance.compile.kernel_table import COMMON_POINT, MEETING, OVERLAP
do = f"""import sys; sys.path[:] = {sys.path!r}; import in_their_places
from clearance.compile import kernel_table
sys.stdin.readline()
kernel_table.compile_kernel(kernel_table.MEETING)"""
process = subprocess.Popen([sys.executable, "-c", do], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
here = kernel_table._compile_here

def and_then_the_other(place):
    here(place)
    if all(map(kernel_table.is_kept, (COMMON_POINT, OVERLAP))) and not process.stdin.closed:
        process.stdin.close()

kernel_table._compile_here = and_then_the_other
kernel_table.await_from(process, kernel_table.TOGETHER)
kernel_table.compile_kernel(MEETING)
kernels = [getattr(small_kernels, f"kernel_{place}") for place in (MEETING, COMMON_POINT, OVERLAP)]
made = [sum(f.stats.cache_misses.values()) for f in kernels]
print(json.dumps([made, sum(kernels[0].stats.cache_hits.values())]))
'''

ONE_THAT_TAKES_LONG = """
import json, subprocess, sys
from clearance.compile import kernel_table
from clearance.kernels.search import containment
process = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
kernel_table.await_from(process, [kernel_table.WINDING_NUMBER])
listened = []
class Pipe:
    def readline(self):
        listened.append(len(listened))
        if len(listened) < 1000:
            return b"not this one yet"
        process.kill()
        return b""
process.stdout = Pipe()
compiled = []
kernel_table._compile_here = compiled.append
kernel_table.compile_kernel(kernel_table.WINDING_NUMBER)
print(json.dumps([len(listened), compiled == [kernel_table.WINDING_NUMBER]]))
"""

ENDS_WITH_THE_FIRST = """
import json, os, signal, sys
from clearance.cli import compile_ahead
process = compile_ahead._second_process()
print(json.dumps(process.pid), flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""

WHERE_NO_PROCESS_STARTS = """
import json, sys
from clearance.cli import compile_ahead
from clearance.compile import kernel_table
sys.executable = "/nowhere/python"
print(json.dumps([compile_ahead.start(), len(kernel_table._elsewhere)]))
"""

BEHIND_ONE_THAT_KEEPS_ITS_TURN = """
import json, os
from filelock import FileLock
from clearance.cli import compile_ahead as ahead
from clearance.kept_files import cache_root
ahead.LONGEST = 0
there, (end, kept_open) = os.dup(1), os.pipe()
os.dup2(end, 0)  # the first process lives
with FileLock(cache_root() / "ahead.lock"):
    ahead.main()
compiled = [place for place in ahead.ALL if ahead.kernel_table.is_kept(place)]
os.write(there, json.dumps(compiled).encode())
"""


def told_by(script, folder, ends=0):
    """What a script prints in a process of its own with an empty cache, from a folder with a trap in it."""
    here = folder / "work"
    here.mkdir()
    (here / "numba.py").write_text("open('trapped', 'w').close()\n")
    small = [A_SMALL_KERNEL.format(place=place) for place in PLACES]
    (folder / "small_kernels.py").write_text(SMALL_KERNELS + "".join(small))
    (folder / "in_their_places.py").write_text(IN_THEIR_PLACES)
    (folder / "script.py").write_text(f"import numba  # so that the compiler counts\n{script}")
    settings = {"PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(folder / "cache")}
    done = subprocess.run(
        [sys.executable, folder / "script.py"],
        cwd=here, env={**os.environ, **settings}, capture_output=True, text=True,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (ends, "")
    assert not (here / "trapped").exists()
    return json.loads(done.stdout)


@pytest.mark.skipif(usable_cores() < 2, reason="one core: nothing is compiled ahead")
def test_what_the_second_process_compiles_is_taken_and_not_made_again(tmp_path):
    told = told_by(FROM_A_SECOND_PROCESS, tmp_path)
    assert told["kept"] == [False, False, False]
    assert told["first"] and not told["again"]
    assert told["taken"] == [1, 1, 1]
    assert told["made"] == [0, 0, 0]


def test_a_process_that_ends_without_it_is_not_waited_for(tmp_path):
    assert told_by(FROM_ONE_THAT_ENDS, tmp_path) == 1


def test_what_another_process_has_not_come_to_is_not_waited_for(tmp_path):
    assert told_by(FROM_ONE_THAT_IS_BUSY_WITH_ANOTHER, tmp_path) == [1, True]


def test_while_one_of_two_kernels_is_awaited_the_other_is_compiled(tmp_path):
    assert told_by(WHAT_GOES_TOGETHER, tmp_path) == [[0, 1, 1], 1]


def test_what_takes_long_is_waited_for_until_that_process_has_ended(tmp_path):
    """However often it has had something else to say: no clock decides."""
    assert told_by(ONE_THAT_TAKES_LONG, tmp_path) == [1000, True]


def test_a_second_process_whose_turn_never_comes_compiles_nothing(tmp_path):
    assert told_by(BEHIND_ONE_THAT_KEEPS_ITS_TURN, tmp_path) == []


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="another way to list processes")
def test_the_second_process_ends_with_a_first_that_is_killed(tmp_path):
    """It has nothing to end for but the pipe that has closed; a process that is being waited for is a zombie."""
    second = Path("/proc", str(told_by(ENDS_WITH_THE_FIRST, tmp_path, -signal.SIGKILL)), "stat")
    guard = time.monotonic() + 120.0
    while second.exists() and second.read_text().rsplit(")")[-1].split()[0] != "Z":
        assert time.monotonic() < guard
        time.sleep(0.01)


@pytest.mark.skipif(usable_cores() < 2, reason="one core: nothing is compiled ahead")
def test_where_no_process_can_be_started_all_is_left_to_the_first(tmp_path):
    assert told_by(WHERE_NO_PROCESS_STARTS, tmp_path) == [True, 0]


WHO_STARTS_PROCESSES = """
import json, sys
import clearance as cl
from clearance.cli import run
from clearance.compile.kernel_files import KernelFiles

KernelFiles.holds_any = lambda self: False  # the cache looks empty to who asks whether to start a process
started = []
sys.addaudithook(lambda event, args: started.append(event) if event in {events} else None)
box = cl.box((1.0, 1.0, 1.0))
cl.distance(box, box)
cl.check({case!r}, certify=False)
by_library = list(started)
code = run(["check", {case!r}, "--samples-only", "--quiet"])
print(json.dumps([by_library, started, code]), file=sys.__stdout__)
"""
EVENTS = {"subprocess.Popen", "os.fork", "os.forkpty", "os.posix_spawn", "os.system"}


@pytest.mark.skipif(usable_cores() < 2, reason="one core: nothing is compiled ahead")
def test_a_library_call_starts_no_process_where_the_command_line_does(tmp_path):
    """What is compiled lies in the cache as ever: the rest of both calls runs through."""
    write_case(tmp_path / "case", None)
    case = str(tmp_path / "case" / "case.yaml")
    done = subprocess.run(
        [sys.executable, "-c", WHO_STARTS_PROCESSES.format(case=case, events=EVENTS)],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    by_library, by_all, code = json.loads(done.stdout.splitlines()[-1])
    assert (by_library, code) == ([], 0)
    assert "subprocess.Popen" in by_all
