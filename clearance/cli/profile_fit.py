"""`clearance profile fit SKETCH.yaml PROFILE`: the sketch whose free dimensions suit an outline best."""

from __future__ import annotations

from pathlib import Path

import click

from clearance.cli.options import OutputPath, SortParamType
from clearance.options import LENGTH


@click.command()
@click.argument("sketch_file", metavar="SKETCH.yaml", type=click.Path(path_type=Path))
@click.argument("profile_file", metavar="PROFILE", type=click.Path(path_type=Path))
@click.option(
    "--nearest", "mode", flag_value="nearest", default=True, help="Least Hausdorff distance."
)
@click.option("--outside", "mode", flag_value="outside", help="Least area that contains it.")
@click.option("--inside", "mode", flag_value="inside", help="Largest area that stays clear of it.")
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
    help="Processor time after which the solve of the sketch stops [s].  [default: 5]",
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
    """Changes the free dimensions of SKETCH.yaml, and its place if nothing holds it, to suit PROFILE.

    PROFILE is a swept profile, a sketch, a list of curves (.yaml) or a drawing (.dxf).
    """
    from clearance.cli.places import refuse_inputs, require_file_place
    from clearance.errors import BadInput, at
    from clearance.profiles.fit import fit as fitted
    from clearance.profiles.outline_file import DrawnOutline, read_outline
    from clearance.sketch import Sketch

    if out.suffix.lower() not in (".yaml", ".yml"):
        raise BadInput(f"a sketch {out.suffix or 'without suffix'}", where=str(out), valid=".yaml")
    require_file_place(out)
    refuse_inputs([out, *([] if picture is None else [picture])], [sketch_file, profile_file])
    outline = read_outline(profile_file)
    sketch = Sketch.load(sketch_file)
    sketch.most_seconds = most_seconds
    names = None if free is None else [name.strip() for name in free.split(",")]
    with at(str(sketch_file)):
        found = fitted(sketch, outline, mode, free=names, margin=margin_mm)
    found.sketch.save(out)
    _tell(found)
    click.echo(f"written {out}")
    if picture is not None:
        from clearance.profiles.picture import draw_outlines

        drawn = DrawnOutline(out.name, found.curve)
        shade = ("only in the sketch", "only in the outline")
        draw_outlines(outline, drawn, found.ends, found.title, picture, shade=shade)
        click.echo(f"picture {picture}")


def _tell(found) -> None:
    what = "distance" if found.mode == "nearest" else "gap"
    for name, value in found.dimensions.items():
        up, down = found.sensitivity[name]
        click.echo(f"{name} {value:.12g}  ({what} changes {up:+.4g} a unit up, {down:+.4g} down)")
    if found.shift.any() or found.turn:
        x, y = found.shift
        click.echo(f"placed by ({x:.9g}, {y:.9g}) m, {found.turn:.9g} rad")
    whole = found.distance
    (ax, ay), (bx, by) = whole.point_a, whole.point_b
    click.echo(
        f"hausdorff {whole.distance:.12g} ± {whole.error_bound:.1e} "
        f"at ({ax:.6g}, {ay:.6g}) and ({bx:.6g}, {by:.6g})"
    )
    if found.clearance is not None:
        what = "contains the outline" if found.mode == "outside" else "stays clear of the outline"
        click.echo(f"{what}, proven gap {1000 * found.clearance:.6g} mm; area {found.area:.9g} m2")
    unit = "distance" if found.mode == "nearest" else "area"
    for name, rate in list(found.active.items())[:6]:
        click.echo(f"held by {name}: {unit} changes by {rate:+.4g} a unit of it")
    click.echo(f"touches at {len(found.touching)} places; best of {found.n_starts} starts")
