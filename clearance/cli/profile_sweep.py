"""`clearance profile sweep CASE.yaml`: the outline that the robot sweeps, as a file for CAD or for comparing."""

from __future__ import annotations

from pathlib import Path

import click

from clearance.cli.options import OutputPath, SortParamType
from clearance.options import LENGTH
from clearance.run.options import MOTIONS


@click.command()
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
    "--tolerance", type=SortParamType(LENGTH), help="[mm] How far it may exceed.  [default: 0.5]"
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
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
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
) -> None:
    """Writes the outline that the links of CASE.yaml sweep in a plane: nothing swept lies outside it.

    The motion between the samples is included, joints moving linearly, or on cubics where the
    trajectory has velocities; the outline exceeds what is swept by at most the tolerance.
    """
    from clearance.case.case_file import load_case
    from clearance.cli.notices import say_notices
    from clearance.cli.places import refuse_inputs_of_cases, require_file_place
    from clearance.cli.progress import shown_progress
    from clearance.profiles.profile_file import require_suffix, write_profile
    from clearance.profiles.sweep import TOLERANCE, swept_profile

    require_suffix(out)
    require_file_place(out)
    case = load_case(case_file)
    refuse_inputs_of_cases([case], [out])
    if not quiet:
        say_notices(case)
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
    if not quiet:
        _tell(found, out)


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _moved(case, motion: str):
    """What is swept: the case as its trajectory says, or as the physics engine moves it."""
    if motion == "kinematic":
        return case
    from clearance.run import check

    return check(case, motion=motion)


def _tell(found, out: Path) -> None:
    holes = sum(contour.area < 0.0 for contour in found.contours)
    outer = len(found.contours) - holes
    what = f"section at {found.section:g} m" if found.section is not None else "silhouette"
    click.echo(f"{what} in {found.plane}, {found.n_steps} steps: {found.name}")
    click.echo(
        f"outlines {outer}, holes {holes}, {found.n_pieces} lines and arcs, "
        f"{found.length:.6g} m long, area {found.area:.6g} m2"
    )
    click.echo(f"contains all that is swept, exceeds it by at most {1000 * found.bound:.4g} mm")
    if found.facets:
        click.echo(f"facets of round shapes stand out by up to {1000 * found.facets:.4g} mm more")
    for name, part in found.parts.items():
        click.echo(f"  {name}: {part.n_pieces} pieces, area {part.area:.6g} m2")
    for note in found.notes:
        click.echo(f"note: {note}")
    click.echo(f"written {out}")
