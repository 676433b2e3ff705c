"""`eyas traffic`."""

import json
import math
import re
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.options import (
    AsJson,
    ConfigFile,
    MapName,
    Overrides,
    Overwrite,
    Preset,
    Trust,
    chosen_file,
    gathered,
    to_write,
)

if TYPE_CHECKING:
    from eyas.maps.traffic.tracks_traffic import Put

app = typer.Typer(
    help="Record traffic with SUMO, or make it of recorded vehicles.", no_args_is_help=True
)

_MOST = 10_000  # Largest number of seeds at once


@app.callback()
def _group() -> None: ...


@app.command()
def record(
    map_name: MapName = None,
    map_seed: Annotated[int | None, typer.Option("--map-seed", help="Seed of the map.")] = None,
    seed: Annotated[
        int | None, typer.Option("--traffic-seed", help="Seed of SUMO and of the routes.")
    ] = None,
    duration: Annotated[float, typer.Option("--duration", help="Seconds to record.")] = 1260.0,
    vehicle_type: Annotated[
        str | None,
        typer.Option(
            "--type",
            help="passenger, bus, truck, trailer or motorcycle; or shares of several, such as "
            """'{"passenger": 0.8, "bus": 0.2}'.""",
        ),
    ] = None,
    seeds: Annotated[
        str | None,
        typer.Option("--traffic-seeds", help="Several, such as 1-8 or 3,5,9: a file for each."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=1, help="Processes for several seeds; default: all cores."),
    ] = None,
    out: Annotated[Path | None, to_write("File to write; with --traffic-seeds the folder.")] = None,
    overwrite: Overwrite = False,
    config: ConfigFile = None,
    preset: Preset = None,
    set_: Overrides = None,
    trust: Trust = False,
    canonical: Annotated[
        bool,
        typer.Option(
            "--canonical",
            help="Regenerate the files that ship with the map: its roads and its recordings.",
        ),
    ] = False,
) -> None:
    """Record traffic; use it with --set traffic.recording=FILE."""
    from eyas.engine.settings.dialect import originals_named
    from eyas.engine.settings.file import load_settings
    from eyas.maps.traffic.recording import run, run_canonical

    short = {"world.seed": map_seed, "traffic.seed": seed, "traffic.vehicle_type": vehicle_type}
    said = [f"{key}={value}" for key, value in short.items() if value is not None]
    file, overrides = chosen_file(config, preset), [*gathered(set_, map_name), *said]
    settings = load_settings(file, overrides, trust=trust)
    many = _numbers(seeds) if seeds is not None else ()
    with originals_named(settings):
        if canonical:
            run_canonical(settings.world)
            return
        run(
            world=settings.world,
            config=settings.traffic,
            duration=duration,
            path=out,
            seeds=many,
            workers=workers,
            overwrite=overwrite,
        )


@app.command("import")
def import_tracks(
    table: Annotated[
        Path,
        typer.Argument(
            help="Table of recorded vehicles (CSV): highD, inD, rounD, exiD, INTERACTION, NGSIM, "
            "VisDrone, or any other with --columns."
        ),
    ],
    map_name: MapName = None,
    map_seed: Annotated[int, typer.Option("--map-seed", help="Seed of the map.")] = 0,
    columns: Annotated[
        Path | None, typer.Option("--columns", help="JSON file that says what its columns are.")
    ] = None,
    unit: Annotated[
        float | None,
        typer.Option("--unit", help="Metres of its unit of length, such as of a pixel."),
    ] = None,
    at: Annotated[
        str | None,
        typer.Option(
            "--at",
            metavar="X,Y,TURN",
            help="Place of its middle on the map, in metres, and degrees by which it is turned; "
            "by default where its metadata say, or in the middle.",
        ),
    ] = None,
    out: Annotated[Path | None, to_write("File to write; by default TABLE.traffic.npz.")] = None,
    overwrite: Overwrite = False,
) -> None:
    """Make traffic of recorded vehicles; use it with --set traffic.recording=FILE."""
    from eyas.engine.traffic.recording_file import save
    from eyas.engine.world.maps import MAPS
    from eyas.engine.world.maps.place import projection_of
    from eyas.maps.traffic.about import about, lines_of
    from eyas.maps.traffic.recording import check_free
    from eyas.maps.traffic.tables import read_columns, read_tracks
    from eyas.maps.traffic.tracks_traffic import put_by_place, traffic_of

    if unit is not None and not 0.0 < unit <= 1e4:
        raise ConfigError(f"--unit: {unit:g} is not allowed: above 0, up to 10000")
    recipe = MAPS.get(map_name or "citystreet")
    path = out or table.with_suffix(".traffic.npz")
    check_free(path, overwrite=overwrite)
    found = read_tracks(table, None if columns is None else read_columns(columns), unit)
    known = put_by_place(found, projection_of(recipe)) if at is None else None
    put = known or _put(at or "0,0,0")
    recording = traffic_of(found, recipe.roads(map_seed), put, table)
    save(recording, path)
    where = "where its metadata place it" if known else f"at {at or '0,0,0'}"
    typer.echo(f"{path}: {len(found.vehicles)} vehicles of a table {found.form}, {where}")
    for what, count in found.left_out.items():
        typer.echo(f"  left out: {count} {what}")
    for line in lines_of(about(path)):
        typer.echo(f"  {line}")
    typer.echo(f"  eyas video --map {map_name or 'citystreet'} --set traffic.recording={path}")


@app.command()
def info(
    file: Annotated[Path, typer.Argument(help="A recording of traffic.")],
    *,
    as_json: AsJson = False,
) -> None:
    """Print what is in a recording: its map and settings, vehicles, speeds, lasting tracks."""
    from eyas.maps.traffic.about import about, lines_of

    said = about(file)
    if as_json:
        typer.echo(json.dumps(asdict(said), indent=1))
        return
    for line in lines_of(said):
        typer.echo(line)


def _put(text: str) -> "Put":
    """Return the place of `X,Y,TURN`, in metres and degrees."""
    from eyas.maps.traffic.tracks_traffic import Put

    try:
        x, y, turn = map(float, text.split(","))
    except ValueError:
        x = y = turn = math.nan
    if not (abs(x) <= 1e5 and abs(y) <= 1e5 and abs(turn) <= 360.0):
        raise ConfigError(f"--at: {text!r} is not allowed: X,Y,TURN in metres and degrees")
    return Put(x, y, math.radians(turn))


def _numbers(text: str) -> tuple[int, ...]:
    """Return the numbers of a list such as `1-4,9`."""
    ends = [re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", part.strip()) for part in text.split(",")]
    spans = [range(int(one[1]), int(one[2] or one[1]) + 1) for one in ends if one]
    if all(ends) and all(spans) and sum(map(len, spans)) <= _MOST:
        return tuple(dict.fromkeys(number for span in spans for number in span))
    raise ConfigError(
        f"--traffic-seeds: {text!r} is not allowed; allowed: at most {_MOST} numbers, "
        "such as 1-8 or 3,5,9"
    )
