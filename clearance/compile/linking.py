"""Libraries of object files: by the system's linker, or packed and linked by llvmlite when they are loaded.

Not for: what is in them (`objects`), and which is loaded (`library`).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
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


def opened_pack(packed: Path) -> Callable[[str], int | None]:
    """Where a symbol of packed objects lies, linked in this process; None if there is none of that name."""
    with zipfile.ZipFile(packed) as archive:
        names = archive.namelist()
        contents = [archive.read(name) for name in names]
    of_kernels = [name.rpartition("-")[0] for name in names if "-" in name]
    return linked(contents, [*of_kernels, *OF_MEMORY], {}).get


_linked: list[object] = []


def linked(
    objects: Iterable[bytes], symbols: Iterable[str], imported: Mapping[str, int]
) -> dict[str, int]:
    """Where the symbols of objects lie, linked by llvmlite in this process for as long as it runs.

    Args:
        imported: where other symbols lie that the objects need.
    """
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        reloc="pic", codemodel="small"
    )
    builder = llvm.JITLibraryBuilder().add_current_process()
    for content in objects:
        builder.add_object_img(content)
    for symbol, address in imported.items():
        builder.import_symbol(symbol, address)
    for symbol in symbols:
        builder.export_symbol(symbol)
    library = builder.link(llvm.create_lljit_compiler(machine), "clearance")
    _linked.append(library)
    return {symbol: library[symbol] for symbol in symbols}
