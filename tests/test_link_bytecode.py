"""What pip has compiled lies where the interpreter looks for it, once that is another folder."""

import py_compile
import sys
from importlib.util import cache_from_source
from pathlib import Path

from scripts.link_bytecode import link_bytecode


def test_a_compiled_file_is_linked_and_nothing_is_written_over(tmp_path, monkeypatch):
    sources = tmp_path / "library" / "part"
    sources.mkdir(parents=True)
    for name in ("one", "two"):
        (sources / f"{name}.py").write_text("x = 1\n")
    monkeypatch.setattr(sys, "pycache_prefix", None)
    compiled = [Path(py_compile.compile(str(path))) for path in sorted(sources.glob("*.py"))]
    (sources / "__pycache__" / "one.cpython-27.pyc").write_bytes(b"of another interpreter")
    monkeypatch.setattr(sys, "pycache_prefix", str(tmp_path / "kept"))
    one, two = (Path(cache_from_source(str(sources / f"{name}.py"))) for name in ("one", "two"))
    two.parent.mkdir(parents=True)
    two.write_bytes(b"newer")
    link_bytecode(tmp_path / "library")
    assert one.samefile(compiled[0])
    assert two.read_bytes() == b"newer"
    assert sorted(path.name for path in one.parent.iterdir()) == [one.name, two.name]
