"""Libraries of object files: by the system's linker, or packed and linked by llvmlite when they are loaded.

Not for: what is in them (`objects`), and which is loaded (`library`).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

from clearance.compile.memory import OF_MEMORY


class NotLinked(Exception):
    """The linker's own words."""


def linker() -> str | None:
    """A compiler that can link a shared library; None where the machine has none."""
    return shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


def link(objects: Sequence[Path], library: Path) -> None:
    """Makes a shared library of object files.

    Raises:
        NotLinked: the linker refuses.
    """
    program = linker()
    assert program is not None
    listed = library.with_name(f"{library.name}.objects")
    listed.write_text("\n".join(f'"{file}"' for file in objects))
    flags = ["-shared", "-o", str(library), f"@{listed}"]
    if sys.platform.startswith("linux"):
        flags += ["-s", "-Wl,-Bsymbolic,-z,defs", "-lm", "-lpthread"]
    done = subprocess.run([program, *flags], capture_output=True, text=True, check=False)
    listed.unlink()
    if done.returncode != 0:
        raise NotLinked(done.stderr.strip())


def pack(objects: Sequence[Path], packed: Path) -> None:
    """Puts object files into one, for `PackedObjects`."""
    with zipfile.ZipFile(packed, "w") as archive:
        for file in objects:
            archive.write(file, file.name)


class PackedObjects:
    """Packed object files, linked in this process."""

    def __init__(self, packed: Path) -> None:
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
            reloc="pic", codemodel="small"
        )
        builder = llvm.JITLibraryBuilder().add_current_process()
        with zipfile.ZipFile(packed) as archive:
            for name in archive.namelist():
                builder.add_object_img(archive.read(name))
                for symbol in [name.rpartition("-")[0]] if "-" in name else OF_MEMORY:
                    builder.export_symbol(symbol)
        self._library = builder.link(llvm.create_lljit_compiler(machine), "clearance")

    def address_of(self, symbol: str) -> int | None:
        """Where a symbol lies; None if there is none of that name."""
        try:
            return self._library[symbol]
        except KeyError:
            return None
