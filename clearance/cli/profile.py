"""`clearance profile`: outlines in the plane compared, fitted to a sketch, and swept by a robot."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import click

from clearance.cli import ExitCode
from clearance.cli.options import OutputPath, SortParamType
from clearance.options import LENGTH
from clearance.run.options import MOTIONS

MOST_BEYOND = 8
"""Stretches beyond the limit that are printed."""

_OF_COMPARISON = ("comparison.svg", "comparison.png", "comparison.json")


@click.group()
def profile() -> None:
    """Profiles: outlines in the plane."""


@profile.command()
@click.argument("a", type=click.Path())
@click.argument("b", type=click.Path())
@click.option("--out", type=OutputPath(), help="Picture (.svg, .png), or a folder for all results.")
@click.option("--limit", type=float, help="Exit with 1 where the Hausdorff distance is above this.")
@click.option("--limit-mm", type=SortParamType(LENGTH), help="The same in mm, for files in metres.")
def compare(a: str, b: str, out: Path | None, limit: float | None, limit_mm: float | None) -> None:
    """Measures how far two outlines differ.

    It is their Hausdorff distance, with a proven error.

    Lengths are in mm if a file says its unit, as a swept profile and most DXF do, or --limit-mm is given.
    Else they are in the unit of the files, and so is --limit.

    A and B are each a swept profile, a sketch, a list of curves (.yaml) or a drawing (.dxf). Exit code: 0,
    1 beyond the limit or not proven to be within it, 2 bad input.
    """
    if limit is not None and limit_mm is not None:
        raise click.UsageError("--limit and --limit-mm are both given")
    in_mm = limit_mm is not None
    if not _compare(a, b, out, limit_mm if in_mm else limit, in_mm):
        click.get_current_context().exit(1)


def _compare(a: str, b: str, out: Path | None, limit: float | None, in_mm: bool) -> bool:
    """Whether the outlines keep the limit, if any; after the comparison is printed and written."""
    from clearance.files import refuse_inputs
    from clearance.planar.entries import checked_number
    from clearance.profiles.compare import compare as compared
    from clearance.profiles.outline_file import read_outline

    if out is not None:
        refuse_inputs([out, *(out / name for name in _OF_COMPARISON)], [a, b])
    limit = None if limit is None else checked_number(limit, "--limit", least=0.0)
    outlines = read_outline(a), read_outline(b)
    if limit is not None and not in_mm:
        _require_no_unit(outlines)
    found = compared(*outlines, limit=limit)
    for line in _comparison_lines(found, *_unit(found, in_mm)):
        click.echo(line)
    if out is not None:
        _write(found, out)
    return found.within_limit


def _require_no_unit(outlines) -> None:
    """Nothing, if no file says its unit: then a limit without one is in theirs."""
    from clearance.errors import BadInput

    for drawn in outlines:
        if drawn.in_metres:
            problem = f"a limit without a unit, where {drawn.name} says its own"
            raise BadInput(problem, where="--limit", valid="--limit-mm")


def _unit(found, in_mm: bool) -> tuple[str, float]:
    """The unit in which lengths are printed, and how many of it the outlines' unit is."""
    is_metres = in_mm or found.a.in_metres or found.b.in_metres
    return (" mm", 1000.0) if is_metres else (" (unit of the files)", 1.0)


def _comparison_lines(found, unit: str, scale: float) -> Iterator[str]:
    whole = found.found
    decision = "" if found.limit is None else f"{found.verdict} {scale * found.limit:.6g}{unit}: "
    yield (
        f"{decision}the outlines differ by {scale * whole.distance:.6g}{unit}, "
        f"error at most {scale * whole.error_bound:.1e}"
    )
    if found.verdict == "undecided":
        low, high = scale * whole.lower, scale * whole.upper
        yield f"  proven is {low:.12g} to {high:.12g}, which counts as beyond"
    cuts = [_cut(drawn.profile) for drawn in (found.a, found.b) if drawn.profile is not None]
    if len(set(cuts)) > 1:
        yield f"  note      A is a {cuts[0]}, B a {cuts[1]}"
    metres, square = (" m", " m2") if scale != 1.0 else ("", "")
    sides = ("A", "B", found.forth), ("B", "A", found.back)
    for (side, other, spread), one in zip(sides, whole.directed.values(), strict=True):
        (ax, ay), (bx, by) = one.point_a, one.point_b
        ends = (ax, ay, bx, by) if side == "A" else (bx, by, ax, ay)
        places = "({:.6g}, {:.6g}) to ({:.6g}, {:.6g})".format(*ends) + metres
        maker = found.makers.get(side.lower())
        by_whom = "" if maker is None else f"; made by {maker[0]}, step {maker[1]}"
        yield f"  {side} from {other}  at most {scale * one.distance:.6g}, {places}{by_whom}"
        shares = ", ".join(f"{p} % {scale * spread.percentile(p):.4g}" for p in (50, 95, 99))
        yield f"            mean {scale * spread.mean:.4g}, {shares}"
    if found.gained is not None:
        yield f"  area      {found.lost:.6g}{square} only in A, {found.gained:.6g}{square} only in B"
    for side, drawn in (("A", found.a), ("B", found.b)):
        yield from (f"  note      {side}: {note}" for note in drawn.notes)
        if drawn.region_fault:
            yield f"  note      no areas: {drawn.region_fault}"
        if drawn.profile is not None:
            yield f"  sweep {side}   exceeds what is swept by at most {scale * drawn.profile.bound:.4g}{unit}"
    for one in found.beyond[:MOST_BEYOND]:
        yield (
            f"  beyond    on {one.outline.upper()}: {scale * one.length:.6g} long, up to "
            f"{scale * one.distance:.6g}, at ({one.point[0]:.6g}, {one.point[1]:.6g}){metres}"
        )
    if len(found.beyond) > MOST_BEYOND:
        yield f"  beyond    on {len(found.beyond) - MOST_BEYOND} more stretches"


def _cut(profile) -> str:
    """What a profile is, with the height of its cut along the plane's normal."""
    if profile.section is None:
        return "silhouette"
    import numpy as np

    height = float(profile.plane_origin @ np.cross(*profile.plane_axes))
    return f"section at {height:.6g} m"


def _write(found, out: Path) -> None:
    from clearance.profiles.picture import draw_outlines

    whole = found.found
    title = f"Hausdorff distance {whole.distance:.6g} ± {whole.error_bound:.1e}"
    ends = (whole.point_a, whole.point_b)
    if out.suffix.lower() in (".svg", ".png"):
        draw_outlines(found.a, found.b, _array(ends), title, out)
        click.echo(f"picture {out}")
        return
    from clearance.files import require_folder_place

    require_folder_place(out)
    *pictures, data = _OF_COMPARISON
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


@profile.command()
@click.argument("sketch_file", metavar="SKETCH.yaml", type=click.Path(path_type=Path))
@click.argument("profile_file", metavar="PROFILE", type=click.Path(path_type=Path))
@click.option(
    "--nearest", "mode", flag_value="nearest", default=True, help="Least Hausdorff distance."
)
@click.option("--outside", "mode", flag_value="outside", help="Least area that contains PROFILE.")
@click.option(
    "--inside", "mode", flag_value="inside", help="Largest area that stays clear of PROFILE."
)
@click.option(
    "--margin-mm", type=SortParamType(LENGTH), default="0", help="Least gap to keep.  [default: 0]"
)
@click.option(
    "--free", help="Dimensions to change, separated by commas.  [default: the driven ones]"
)
@click.option(
    "--most-seconds",
    type=click.FloatRange(min=0.0),
    default=10.0,
    help="Processor time after which the solve of the sketch stops [s].  [default: 10]",
)
@click.option("--out", required=True, type=OutputPath(), help="Sketch to write, .yaml.")
@click.option("--picture", type=OutputPath(), help="Picture to write, .svg or .png.")
def fit(
    sketch_file: Path,
    profile_file: Path,
    mode: str,
    margin_mm: float,
    free: str | None,
    most_seconds: float,
    out: Path,
    picture: Path | None,
) -> None:
    """Fits a sketch to an outline.

    Changes the free dimensions of SKETCH.yaml, and its place unless it is fixed, to suit PROFILE.

    PROFILE is a swept profile, a sketch or a list of curves (.yaml), in metres, or a drawing (.dxf) that
    names its unit.
    """
    from clearance.errors import BadInput, at
    from clearance.files import refuse_inputs, require_file_place
    from clearance.profiles.fit import fit as fitted
    from clearance.profiles.outline_file import DrawnOutline, read_outline
    from clearance.sketch import Sketch

    if out.suffix.lower() not in (".yaml", ".yml"):
        raise BadInput(f"a sketch {out.suffix or 'without suffix'}", where=str(out), valid=".yaml")
    require_file_place(out)
    refuse_inputs([out, *([] if picture is None else [picture])], [sketch_file, profile_file])
    outline = read_outline(profile_file)
    if profile_file.suffix.lower() == ".dxf" and not outline.in_metres:
        problem = "the drawing names no unit ($INSUNITS 0), and sketches are in metres"
        valid = "a unit: $INSUNITS 4 for mm, 6 for metres"
        raise BadInput(problem, where=str(profile_file), valid=valid)
    sketch = Sketch.load(sketch_file)
    sketch.most_seconds = most_seconds
    names = None if free is None else [name.strip() for name in free.split(",")]
    with at(str(sketch_file)):
        found = fitted(sketch, outline, mode, free=names, margin=margin_mm)
    found.sketch.save(out)
    _print_fit(found)
    for note in outline.notes:
        click.echo(f"note: {outline.name}: {note}")
    click.echo(f"written {out}")
    if picture is not None:
        from clearance.profiles.picture import draw_outlines

        drawn = DrawnOutline(out.name, found.curve)
        shade = ("only in the sketch", "only in the outline")
        draw_outlines(outline, drawn, found.ends, found.title, picture, shade=shade)
        click.echo(f"picture {picture}")


def _print_fit(found) -> None:
    what = "distance" if found.mode == "nearest" else "gap"
    for name, value in found.dimensions.items():
        unit, scale = found.unit_of(name)
        up, down = (1000.0 / scale * rate for rate in found.sensitivity[name])
        click.echo(
            f"{name} {scale * value:.7g} {unit} "
            f"({what} changes by {up:+.4g} mm a {unit} up, {down:+.4g} down)"
        )
    if found.shift.any() or found.turn:
        x, y = found.shift
        click.echo(f"placed by ({x:.9g}, {y:.9g}) m, {found.turn:.9g} rad")
    whole = found.distance
    (ax, ay), (bx, by) = whole.point_a, whole.point_b
    click.echo(
        f"outline and sketch differ by {1000 * whole.distance:.6g} mm, "
        f"error at most {1000 * whole.error_bound:.1e}, ({ax:.6g}, {ay:.6g}) to ({bx:.6g}, {by:.6g})"
    )
    if found.clearance is not None:
        what = "contains the outline" if found.mode == "outside" else "stays clear of the outline"
        click.echo(f"{what}, proven gap {1000 * found.clearance:.6g} mm; area {found.area:.9g} m2")
    unit = "distance" if found.mode == "nearest" else "area"
    for name, rate in list(found.active.items())[:6]:
        click.echo(f"held by {name}: {unit} changes by {rate:+.4g} a unit of it")
    starts = f"best of {found.n_starts} starts, {found.n_agreeing} of them came to it"
    click.echo(f"touches at {len(found.touching)} places; {starts}")
    if 2 * found.n_agreeing < found.n_starts:
        click.echo("most starts ended elsewhere: another drawing to start from may fit better")


@profile.command()
@click.argument("case_file", metavar="CASE.yaml", type=click.Path(path_type=Path))
@click.option(
    "--plane",
    default="xy",
    show_default=True,
    help='xy, xz, yz or "px py pz nx ny nz": a point and a normal.',
)
@click.option("--links", help="Only these links, separated by commas; '' for none.")
@click.option("--obstacles", help="These obstacles as well, separated by commas.")
@click.option("--section", type=float, help="Cut at this height [m] along the normal, not project.")
@click.option(
    "--tolerance",
    type=SortParamType(LENGTH),
    help="Greatest excess over the swept area [mm].  [default: 0.5]",
)
@click.option("--per-link", is_flag=True, help="Each link's own profile as well.")
@click.option(
    "--motion",
    type=click.Choice(MOTIONS[:2]),
    default=MOTIONS[0],
    show_default=True,
    help="Motion to sweep: the trajectory itself, or a simulated robot that follows it.",
)
@click.option(
    "--out",
    required=True,
    type=OutputPath(),
    help="File to write: .yaml, .dxf, .svg or .geojson.",
)
@click.option("--quiet", is_flag=True, help="Print nothing but errors and what is not swept.")
def sweep(
    case_file: Path,
    plane: str,
    links: str | None,
    obstacles: str | None,
    section: float | None,
    tolerance: float | None,
    per_link: bool,
    motion: str,
    out: Path,
    quiet: bool,
) -> int:
    """Writes the outline that links sweep in a plane.

    It contains all that the links of CASE.yaml sweep.

    The motion between the samples is included: joints move linearly, or on cubics if the
    trajectory has velocities. The outline exceeds the swept area by at most the tolerance.
    Exit code: 0 done, 2 bad or suspect input.
    """
    from clearance.extras import require

    require("profiles", "profile sweep")
    from clearance.case.case_file import load_case
    from clearance.cli.notices import say_notices
    from clearance.cli.progress import shown_progress
    from clearance.files import refuse_inputs, require_file_place
    from clearance.profiles.profile_file import require_suffix, write_profile
    from clearance.profiles.sweep import TOLERANCE, swept_profile
    from clearance.world.case import uncounted_in_sweeps

    require_suffix(out)
    require_file_place(out)
    case = load_case(case_file)
    refuse_inputs([out], case.files_read)
    is_suspect = say_notices(case, quiet=quiet)
    moved = _moved(case, motion)
    with shown_progress(quiet, ["covering", "sweeping"]) as progress:
        found = swept_profile(
            moved,
            plane,
            links=None if links is None else _names(links),
            obstacles=_names(obstacles or ""),
            section=section,
            tolerance=TOLERANCE if tolerance is None else tolerance,
            per_link=per_link,
            progress=progress,
        )
    write_profile(found, out)
    if quiet:
        for note in found.left_out:
            click.echo(f"warning: {case.name}: {note}", err=True)
    else:
        _print_sweep(found, out, uncounted_in_sweeps([case]))
    return ExitCode.BAD_INPUT if is_suspect else ExitCode.CLEAR


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _moved(case, motion: str):
    """What is swept: the case as its trajectory says, or as the physics engine moves it."""
    if motion == "kinematic":
        return case
    from clearance.run import check

    return check(case, motion=motion)


def _print_sweep(found, out: Path, uncounted: str) -> None:
    holes = sum(contour.area < 0.0 for contour in found.contours)
    outer = len(found.contours) - holes
    what = f"section at {found.section:g} m" if found.section is not None else "silhouette"
    click.echo(f"{what} in {found.plane}, {found.n_steps} steps: {found.name}")
    click.echo(
        f"outlines {outer}, holes {holes}, {found.n_pieces} lines and arcs, "
        f"{found.length:.6g} m long, area {found.area:.6g} m2"
    )
    click.echo(found.promise)
    if uncounted:
        click.echo(f"without the {uncounted} of the case")
    if found.facets:
        click.echo(f"facets of round shapes stand out by up to {1000 * found.facets:.4g} mm more")
    for name, part in found.parts.items():
        click.echo(f"  {name}: {part.n_pieces} pieces, area {part.area:.6g} m2")
    for note in found.notes:
        click.echo(f"note: {note}")
    click.echo(f"written {out}")
