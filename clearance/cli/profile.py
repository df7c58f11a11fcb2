"""`clearance profile`: sweeps, fits and comparisons of outlines; here `compare`, others in files of their own."""

from __future__ import annotations

from pathlib import Path

import click

from clearance.cli.options import OutputPath, SortParamType
from clearance.cli.profile_fit import fit
from clearance.cli.profile_sweep import sweep
from clearance.options import LENGTH

_FILES = ("comparison.svg", "comparison.png", "comparison.json")


@click.group()
def profile() -> None:
    """Profiles: outlines in the plane."""


profile.add_command(fit)
profile.add_command(sweep)


@profile.command()
@click.argument("a", type=click.Path())
@click.argument("b", type=click.Path())
@click.option("--out", type=OutputPath(), help="Picture (.svg, .png), or a folder for all results.")
@click.option(
    "--field", is_flag=True, help="Colour the page by the nearest arc of B (the distance map)."
)
@click.option("--limit", type=float, help="Exit with 1 where the Hausdorff distance is above this.")
@click.option("--limit-mm", type=SortParamType(LENGTH), help="The same in mm, for files in metres.")
def compare(
    a: str, b: str, out: Path | None, field: bool, limit: float | None, limit_mm: float | None
) -> None:
    """How far the outlines in files A and B differ, with a proven error, in their unit.

    Each is a swept profile, a sketch, a list of curves (.yaml) or a drawing (.dxf). Exit code: 0,
    1 beyond the limit or not proven to be within it, 2 bad input.
    """
    if limit is not None and limit_mm is not None:
        raise click.UsageError("--limit and --limit-mm are both given")
    if _compare(a, b, out, field, limit_mm if limit is None else limit):
        click.get_current_context().exit(1)


def _compare(a: str, b: str, out: Path | None, field: bool, limit: float | None) -> bool:
    from clearance.cli.places import refuse_inputs
    from clearance.planar.entries import checked_number
    from clearance.profiles.compare import compare as compared
    from clearance.profiles.outline_file import read_outline

    if out is not None:
        refuse_inputs([out, *(out / name for name in _FILES)], [a, b])
    limit = None if limit is None else checked_number(limit, "--limit", least=0.0)
    found = compared(read_outline(a), read_outline(b), limit=limit)
    for direction, directed in found.found.directed.items():
        click.echo(_line(direction, directed))
    whole = found.found
    click.echo(f"hausdorff {whole.distance:.12g} ± {whole.error_bound:.1e} ({whole.direction})")
    _tell(found)
    if out is not None:
        _write(found, out, field)
    if limit is None:
        return False
    click.echo(f"limit {limit:g}: {_verdict(found)}")
    return not found.within_limit


def _verdict(found) -> str:
    if found.verdict != "undecided":
        return found.verdict
    whole = found.found
    return f"undecided (proven: {whole.lower:.12g} to {whole.upper:.12g}), which counts as beyond"


def _line(direction: str, directed) -> str:
    (ax, ay), (bx, by) = directed.point_a, directed.point_b
    return (
        f"{direction} {directed.distance:.12g} ± {directed.error_bound:.1e} {directed.kind} "
        f"a({ax:.9g}, {ay:.9g}) b({bx:.9g}, {by:.9g})"
    )


def _tell(found) -> None:
    for name, one in (("a_to_b", found.forth), ("b_to_a", found.back)):
        shares = ", ".join(f"{p} % {one.percentile(p):.6g}" for p in (50, 95, 99))
        click.echo(f"deviation {name}: mean {one.mean:.6g}, {shares}")
    if found.gained is not None:
        click.echo(f"area gained {found.gained:.6g}, lost {found.lost:.6g}")
    for side, (link, step) in found.makers.items():
        click.echo(f"worst point of {side} made by {link}, step {step}")
    for one in found.beyond[:8]:
        click.echo(
            f"beyond on {one.outline}: {one.length:.6g} long, up to {one.distance:.6g} "
            f"at ({one.point[0]:.6g}, {one.point[1]:.6g})"
        )
    if len(found.beyond) > 8:
        click.echo(f"and {len(found.beyond) - 8} more stretches")


def _write(found, out: Path, field: bool) -> None:
    if field:
        from clearance.planar.picture import draw_comparison

        draw_comparison(found.a.curve, found.b.curve, found.found, out)
        click.echo(f"picture {out}")
        return
    from clearance.profiles.picture import draw_outlines

    whole = found.found
    title = f"Hausdorff distance {whole.distance:.6g} ± {whole.error_bound:.1e}"
    ends = (whole.point_a, whole.point_b)
    if out.suffix.lower() in (".svg", ".png"):
        draw_outlines(found.a, found.b, _array(ends), title, out)
        click.echo(f"picture {out}")
        return
    from clearance.cli.places import require_folder_place

    require_folder_place(out)
    *pictures, data = _FILES
    for name in pictures:
        draw_outlines(found.a, found.b, _array(ends), title, out / name)
    _write_data(found, out / data)
    click.echo(f"written {out}")


def _write_data(found, path: Path) -> None:
    import json

    from clearance.profiles.compare import as_data

    path.write_text(json.dumps(as_data(found), indent=1, sort_keys=True) + "\n", encoding="utf-8")


def _array(ends):
    import numpy as np

    return np.stack(ends)
