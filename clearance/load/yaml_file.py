"""YAML text to plain data: lists, mappings, numbers, text (YAML 1.2, so `1e-3` is a number, `no` is
text).

Not for: which keys are valid (`schema`).
"""

from __future__ import annotations

from clearance.errors import BadSyntax, DuplicateName


def parse_yaml(data: bytes, shown: str) -> object:
    """The plain data in a YAML file.

    Args:
        shown: the file's name in errors.

    Raises:
        BadSyntax: not YAML, not UTF-8, or more than one document. DuplicateName: a key twice in a
        mapping.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.constructor import DuplicateKeyError
    from ruamel.yaml.error import YAMLError

    try:
        return YAML(typ="safe", pure=True).load(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise BadSyntax(
            f"byte {error.start} is not UTF-8 text", where=shown, valid="YAML"
        ) from None
    except DuplicateKeyError as error:
        problem = (error.problem or "a key twice").split(" with value")[0]
        raise DuplicateName(problem, where=_place(shown, error), valid="each key once") from None
    except (YAMLError, ValueError, RecursionError) as error:
        problem = getattr(error, "problem", None) or str(error) or "too deeply nested"
        raise BadSyntax(f"not YAML: {problem}", where=_place(shown, error)) from None


def _place(shown: str, error: Exception) -> str:
    mark = getattr(error, "problem_mark", None)
    return shown if mark is None else f"{shown}: line {mark.line + 1}"
