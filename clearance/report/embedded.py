"""What stands inside a page's script elements: our scripts, and data as JSON. Not for: what is in them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from markupsafe import Markup

_HERE = Path(__file__).parent


def script(name: str) -> Markup:
    """A script of this room."""
    return inside_script((_HERE / name).read_text(encoding="utf-8"))


def inside_script(text: str) -> Markup:
    """A script so that no string in it can end the script element that it stands in."""
    return Markup(re.sub(r"</(?=script)", r"<\\/", text, flags=re.IGNORECASE))


def json_inside_script(value: Any) -> Markup:
    """JSON that holds no `<`, so that nothing in it can be taken for markup."""
    return Markup(json.dumps(value, sort_keys=True, allow_nan=False).replace("<", "\\u003c"))
