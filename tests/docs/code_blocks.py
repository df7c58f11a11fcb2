"""The code blocks of the README, of `.github` and of the guide: their language, title, text and place."""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
GUIDE = ROOT / "scripts" / "docs"
PAGES = (ROOT / "README.md", *sorted((ROOT / ".github").glob("*.md")), *sorted(GUIDE.rglob("*.md")))

_BLOCK = re.compile(
    r"^( *)```(\w*)(?: title=\"([^\"]+)\")?\n(.*?)^\1```$", re.DOTALL | re.MULTILINE
)


@dataclass(frozen=True)
class CodeBlock:
    """A fenced block: `language` may be empty; `title` names the file that it is, if it is one."""

    language: str
    title: str
    text: str
    line: int

    @property
    def commands(self) -> list[str]:
        """The lines of a block of commands."""
        return [line for line in self.text.splitlines() if line.strip()]


def blocks_of(page: Path) -> list[CodeBlock]:
    """The code blocks of a page in order; every fence of the page belongs to one."""
    text = page.read_text(encoding="utf-8")
    found = [
        CodeBlock(m[2], m[3] or "", textwrap.dedent(m[4]), text[: m.start()].count("\n") + 1)
        for m in _BLOCK.finditer(text)
    ]
    fences = len(re.findall(r"^ *```", text, re.MULTILINE))
    assert fences == 2 * len(found), f"{page}: {fences} fences, {len(found)} blocks"
    return found
