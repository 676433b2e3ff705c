"""`eyas maps`."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.options import AsJson, OnlyMaps, OnlyWeathers, Out, Overwrite, to_write

Name = Annotated[
    str, typer.Argument(help="Name of the map, the folder of an imported one, or a plan.")
]
Seed = Annotated[int, typer.Option("--map-seed", min=0, help="Seed of the map.")]

app = typer.Typer(help="List and draw the maps.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command("list")
def list_maps(*, as_json: AsJson = False) -> None:
    """Print the maps with their weathers."""
    from eyas.engine.world.maps import MAPS

    if as_json:
        recipes = {name: MAPS.get(name) for name in sorted(MAPS.names())}
        told = [
            {"name": name, "title": recipe.title, "weathers": list(recipe.weathers)}
            for name, recipe in recipes.items()
        ]
        typer.echo(json.dumps(told, indent=1))
        return
    for name in sorted(MAPS.names()):
        recipe = MAPS.get(name)
        typer.echo(f"{name}: {recipe.title} ({', '.join(recipe.weathers)})")


@app.command("gallery")
def draw_gallery(
    out: Out = Path("runs/gallery"), map_name: OnlyMaps = None, weather: OnlyWeathers = None
) -> None:
    """Draw a page of pictures of each map in each weather."""
    from eyas.maps.gallery import run as gallery

    gallery.run(out, map_name or (), weather or ())


@app.command("import")
def import_map(  # noqa: PLR0913  # its options
    file: Annotated[
        Path, typer.Argument(help="Of OpenStreetMap (.osm, .osm.pbf, ...) or SUMO (.net.xml).")
    ],
    name: Annotated[str | None, typer.Option("--name", help="Name of the map.")] = None,
    out: Annotated[Path | None, to_write("Folder of the map; then use --map FOLDER.")] = None,
    bbox: Annotated[
        str | None, typer.Option("--bbox", help="Only WEST,SOUTH,EAST,NORTH, in degrees.")
    ] = None,
    drive_on: Annotated[
        str | None,
        typer.Option("--drive-on", help="left or right; by default as the file or the place says."),
    ] = None,
    routes: Annotated[
        list[Path] | None,
        typer.Option("--routes", help="SUMO: the vehicles that drive, .rou.xml; several times."),
    ] = None,
    sumocfg: Annotated[
        Path | None, typer.Option("--sumocfg", help="SUMO: what names their files, .sumocfg.")
    ] = None,
    buildings: Annotated[bool, typer.Option(help="SUMO: make houses along the streets.")] = True,
    around: Annotated[
        Path | None,
        typer.Option(
            "--buildings-of",
            metavar="FILE",
            help="SUMO: a file of OpenStreetMap of the same place, with its buildings and grounds.",
        ),
    ] = None,
    traffic: Annotated[bool, typer.Option(help="Record the traffic now, not on first use.")] = True,
    parked: Annotated[
        bool, typer.Option(help="Cars park along kerbs, as tagged or as is usual.")
    ] = True,
    overwrite: Overwrite = False,
) -> None:
    """Make a map of OpenStreetMap or SUMO; use it with --map NAME, or --map DIR with --out DIR."""
    from eyas.maps.osm.importing import run
    from eyas.maps.sumo import importing as sumo

    if sumo.is_sumo(file):
        given = {"--bbox": bbox is not None, "--drive-on": drive_on is not None}
    else:
        given = {
            "--routes": bool(routes),
            "--sumocfg": sumocfg is not None,
            "--buildings-of": around is not None,
        }
    for option, used in given.items():
        if used:
            raise ConfigError(f"{option}: is not for {file.name!r}")
    if sumo.is_sumo(file):
        report = sumo.run(
            file,
            name,
            routes or (),
            sumocfg,
            out=out,
            buildings=around or buildings,
            record=traffic,
            parked=parked,
            overwrite=overwrite,
        )
        typer.echo("\n".join(report.lines()))
        return
    bounds = _bounds(bbox)
    if drive_on is not None:
        _known_side(drive_on)
    report = run(
        file,
        name,
        out=out,
        bounds=bounds,
        drive_on=drive_on,
        record=traffic,
        parked=parked,
        overwrite=overwrite,
    )
    for line in report.lines():
        typer.echo(line)


@app.command("new")
def new_map(
    name: Annotated[str, typer.Argument(help="Name of the map whose kind it is.")],
    seed: Annotated[int, typer.Option("--map-seed", min=0, help="Seed of the new map.")],
    drive_on: Annotated[str, typer.Option("--drive-on", help="left or right.")] = "right",
) -> None:
    """Make another map of a kind now, with its traffic, not on first use."""
    from eyas.maps.commands.info import make_another

    _known_side(drive_on)
    for line in make_another(name, seed, left_hand=drive_on == "left"):
        typer.echo(line)


@app.command("info")
def show_info(name: Name, seed: Seed = 0, *, as_json: AsJson = False) -> None:
    """Print figures of a map: its size, streets, buildings, trees, and whose data it is."""
    from eyas.maps.commands.info import about, describe

    if as_json:
        typer.echo(json.dumps(asdict(about(name, seed)), indent=1))
        return
    for line in describe(name, seed):
        typer.echo(line)


@app.command("show")
def show_map(
    name: Name,
    out: Annotated[Path | None, to_write("PNG file to write; by default NAME.png.")] = None,
    seed: Seed = 0,
    width: Annotated[
        int, typer.Option("--width", min=100, max=8000, help="Width in pixels.")
    ] = 1200,
    tracks: Annotated[bool, typer.Option(help="Draw where the recorded cars drive.")] = True,
) -> None:
    """Draw a map from above: streets, buildings, trees, and where its cars drive."""
    from eyas.engine.world.maps import MAPS
    from eyas.maps.commands.show import run

    path = out if out is not None else Path(f"{MAPS.get(name).name}.png")
    run(name, seed, path, width, tracks=tracks)
    typer.echo(path)


@app.command("plan")
def write_plan(
    name: Name,
    out: Annotated[Path | None, to_write("File to write; by default NAME.plan.json.")] = None,
    seed: Seed = 0,
) -> None:
    """Write the plan of a map: all that stands on it. Use it, or a copy, with --map FILE."""
    from eyas.engine.world.maps import MAPS
    from eyas.maps.commands.plan import write_plan_of

    path = out if out is not None else Path(f"{MAPS.get(name).name}.plan.json")
    for made in write_plan_of(name, seed, path):
        typer.echo(made)


@app.command("check")
def check_plan(
    file: Annotated[Path, typer.Argument(help="A plan of a map: .plan.json or .plan.json.gz.")],
) -> None:
    """Say what is wrong with a plan, one line each."""
    from eyas.maps.commands.plan import named_file_problems
    from eyas.maps.plan.file import problems

    wrong = problems(file, named_file_problems)
    for line in wrong:
        typer.echo(line)
    if wrong:
        raise typer.Exit(1)
    typer.echo(f"{file}: no faults found; use it with --map {file}")


@app.command("export")
def export_map(
    name: Name,
    kind: Annotated[
        str,
        typer.Option(
            "--format", help="gltf, usd, opendrive, sumo, geojson or webots.", show_default=False
        ),
    ],
    out: Annotated[
        Path | None, to_write("File or folder to write; by default NAME with an ending.")
    ] = None,
    seed: Seed = 0,
    detail: Annotated[
        int, typer.Option("--detail", min=0, max=9, help="gltf, usd, webots: trees; 0: finest.")
    ] = 1,
    lamps: Annotated[bool, typer.Option(help="gltf: street lamps are lights.")] = True,
    cell: Annotated[
        float | None,
        typer.Option(
            "--cell",
            min=0.1,
            max=100.0,
            help="geojson: side of a raster cell in metres; by default 0.5, on large maps 1.",
        ),
    ] = None,
    weather: Annotated[
        str | None, typer.Option("--weather", help="webots: of the world; by default the first.")
    ] = None,
    hour: Annotated[
        float | None, typer.Option("--hour", min=0.0, max=24.0, help="webots: of the day.")
    ] = None,
) -> None:
    """Write a map for other programs: shapes, roads, or a plan."""
    from eyas.maps.formats.registry import MapExport, export

    options = MapExport(name, seed, detail, lamps, cell, weather, hour)
    for line in export(kind, out, options):
        typer.echo(line)


def _known_side(text: str) -> None:
    from eyas.maps.osm.driving_side import SIDES

    if text not in SIDES:
        raise ConfigError(f"--drive-on: {text!r} is not allowed; allowed: left, right")


def _bounds(text: str | None) -> tuple[float, float, float, float] | None:
    if text is None:
        return None
    try:
        west, south, east, north = (float(part) for part in text.split(","))
    except ValueError:
        raise ConfigError(
            f"--bbox: {text!r} is not allowed; allowed: WEST,SOUTH,EAST,NORTH in degrees"
        ) from None
    return west, south, east, north
