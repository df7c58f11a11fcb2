"""`clearance profile compare A B`: how far one outline strays from another, as numbers and a picture."""

from __future__ import annotations

import click

from clearance.cli.profile_sweep import sweep


@click.group()
def profile() -> None:
    """Profiles: outlines in the plane."""


profile.add_command(sweep)


@profile.command()
@click.argument("a", type=click.Path())
@click.argument("b", type=click.Path())
@click.option("--out", type=click.Path(), help="Picture to write, .svg or .png.")
@click.option(
    "--field", is_flag=True, help="Colour the page by the nearest arc of B (the distance map)."
)
@click.option("--limit", type=float, help="Exit with 1 where the Hausdorff distance is above this.")
def compare(a: str, b: str, out: str | None, field: bool, limit: float | None) -> None:
    """The exact Hausdorff distance of the curves in files A and B (.dxf, .yaml), in their unit."""
    if _compare(a, b, out, field, limit):
        click.get_current_context().exit(1)


def _compare(a: str, b: str, out: str | None, field: bool, limit: float | None) -> bool:
    from clearance.planar.curve_file import read_curve
    from clearance.planar.entries import checked_number
    from clearance.planar.hausdorff import hausdorff

    limit = None if limit is None else checked_number(limit, "--limit", least=0.0)
    one, two = read_curve(a), read_curve(b)
    found = hausdorff(one, two)
    for direction, directed in found.directed.items():
        click.echo(_line(direction, directed))
    click.echo(f"hausdorff {found.distance:.12g} ± {found.error_bound:.1e} ({found.direction})")
    if out is not None:
        from clearance.planar.picture import draw_comparison

        draw_comparison(one, two, found, out, field=field)
        click.echo(f"picture {out}")
    if limit is None:
        return False
    beyond = found.distance > limit
    click.echo(f"limit {limit:g}: {'beyond' if beyond else 'within'}")
    return beyond


def _line(direction: str, directed) -> str:
    (ax, ay), (bx, by) = directed.point_a, directed.point_b
    return (
        f"{direction} {directed.distance:.12g} ± {directed.error_bound:.1e} {directed.kind} "
        f"a({ax:.9g}, {ay:.9g}) b({bx:.9g}, {by:.9g})"
    )
