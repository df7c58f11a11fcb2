"""Makes the guide's gallery: for each case a picture of its worst moment, the command, the verdict and the time.

    python -m scripts.makers.gallery

Writes `scripts/docs/gallery.md` and `scripts/docs/pictures/`. Needs pillow. Not for: the cases (`scenes`).
"""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

ROOT = Path(__file__).parents[2]
GUIDE = ROOT / "scripts" / "docs"
SIZE, COLOURS = (800, 500), 200
PASSES = 3

CASES = {
    "box_pipe": "A box passes through the bore of a pipe, which is concave.",
    "iiwa_pipe_rack": "A KUKA iiwa inspects pipes behind a rack.",
    "hot_cell": "Our arm reaches through a port of a shield wall, past a bent pipe.",
    "panda_shelf": "A Panda reaches into a shelf and pushes against a carton.",
    "dual_arm_handover": "Two Pandas hand a bar over in mid-air, onto a tray that drives on.",
    "turntable_cell": "An arm on a carriage looks at two towers that turn past it.",
    "welding_cell": "A robot program welds two parts on a turntable, past a clamp.",
    "door_and_arm": "An arm goes through a hatch whose door swings past it.",
}
"""Scenes, and a sentence on what happens."""

HEAD = """# Gallery

Each picture is the worst moment of a case, as `--png` draws it. The time is processor time of the whole
command, least of {passes}, without picture and report.

"""

ENTRY = """## {title}

{sentence}

![{title}: the worst moment](pictures/{name}.png)

```console
clearance check scenes/{name}/case.yaml
```

```text
{verdict}
```

{seconds:.2f} s

"""


def make() -> None:
    """Writes the page and its pictures."""
    (GUIDE / "pictures").mkdir(exist_ok=True)
    entries = [_entry(name, sentence) for name, sentence in CASES.items()]
    (GUIDE / "gallery.md").write_text(HEAD.format(passes=PASSES) + "".join(entries).rstrip() + "\n")


def _entry(name: str, sentence: str) -> str:
    runs = [_checked(name) for _ in range(PASSES)]
    with TemporaryDirectory() as folder:
        drawn = Path(folder, "worst.png")
        _checked(name, "--png", str(drawn))
        with Image.open(drawn) as picture:
            small = picture.convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
    small.quantize(COLOURS, dither=Image.Dither.NONE).save(
        GUIDE / "pictures" / f"{name}.png", optimize=True
    )
    title = name.replace("_", " ").capitalize()
    seconds = min(seconds for _, seconds in runs)
    return ENTRY.format(
        title=title, name=name, sentence=sentence, verdict=runs[0][0], seconds=seconds
    )


def _checked(name: str, *options: str) -> tuple[str, float]:
    """The first line that a check prints, and its processor time [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = ["check", f"scenes/{name}/case.yaml", *options]
    done = subprocess.run(
        [sys.executable, "-m", "clearance", *command], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode in (0, 1), done.stderr
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done.stdout.splitlines()[0], spent


if __name__ == "__main__":
    make()
