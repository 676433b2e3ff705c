"""What there is besides runs: bench, verify, doctor, config, cache, about."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from eyas.engine.terminal.options import (
    AsJson,
    ConfigFile,
    MapName,
    OnlyMaps,
    OnlyWeathers,
    Overrides,
    Preset,
    chosen_file,
    gathered,
    to_write,
)
from eyas.engine.terminal.stderr import say

if TYPE_CHECKING:
    from importlib.metadata import Distribution

    from eyas.engine.settings.config import EyasConfig


def bench(
    out: Annotated[Path | None, to_write("JSON file to write the figures to, as well.")] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Measure for a tenth of the time.")
    ] = False,
    cold: Annotated[
        bool, typer.Option("--cold", help="Also time a first picture with an empty cache.")
    ] = False,
    stages: Annotated[
        bool, typer.Option("--stages", help="Also time each stage of drawing a picture.")
    ] = False,
    camera: Annotated[
        bool, typer.Option("--camera", help="Also time the models of cameras.")
    ] = False,
    device: Annotated[
        str | None,
        typer.Option(
            "--device", help="Measure pictures on a graphics processor only: cuda, cuda:1, ..."
        ),
    ] = None,
) -> None:
    """Measure the speed of Eyas on this machine, as medians."""
    from eyas.cli.bench import run as bench

    bench.run(out, quick=quick, cold=cold, stages=stages, camera=camera, device=device)


def doctor(json_: AsJson = False) -> None:
    """Show what Eyas finds here: versions, processor, cache, shipped kernels, graphics card."""
    from eyas.cli.doctor import run

    run(as_json=json_)


def verify(
    quick: Annotated[
        bool, typer.Option("--quick", help="Look at a tenth of the cases only.")
    ] = False,
    map_: MapName = None,
    json_: AsJson = False,
) -> None:
    """Check that this machine computes the promised bytes: pictures, labels, rewards, people.

    Exit code 1 if anything differs.
    """
    from eyas.cli.verify.run import run

    if not run(quick=quick, map_name=map_, as_json=json_):
        raise typer.Exit(1)


config_app = typer.Typer(help="Show and convert settings.", no_args_is_help=True)


@config_app.callback()
def _config_group() -> None: ...


def bring(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Files or folders of any other tool.")
    ],
    out: Annotated[
        Path | None, to_write("Settings file to write, of a calibrated camera; then --config FILE.")
    ] = None,
) -> None:
    """Look at files of others: what they are, what is left out, what makes them usable.

    Maps, tracks, shapes, policies, networks, sequences, films, calibrations, settings. The exit
    code is 1 if none can be used.
    """
    from eyas.cli.bring import Brought, lines
    from eyas.cli.bring import bring as brought_files
    from eyas.engine.core.errors import ConfigError
    from eyas.engine.core.files import write_atomic

    found = brought_files(files)
    for line in lines(found):
        typer.echo(line)
    usable = [one for one in found if isinstance(one, Brought)]
    if out is not None:
        settings = [one.settings for one in usable if one.settings is not None]
        if len(settings) != 1:
            raise ConfigError("--out: for one calibration, whose settings are written")
        write_atomic(out, (json.dumps(settings[0], indent=1) + "\n").encode())
    if not usable:
        raise typer.Exit(1)


@config_app.command("show")
def show_config(
    config: ConfigFile = None,
    preset: Preset = None,
    set_: Overrides = None,
    legacy: Annotated[
        bool, typer.Option("--legacy", help="In the format of the DAT benchmark's env_config.json.")
    ] = False,
) -> None:
    """Check the settings, and print all of them as JSON."""
    from eyas.engine.settings.dialect import originals_named
    from eyas.engine.settings.file import load_settings
    from eyas.engine.settings.trust import code_of
    from eyas.engine.world.maps import MAPS

    # Nothing that the file names is imported here, so it may be anyone's.
    settings = load_settings(chosen_file(config, preset), gathered(set_), trust=True)
    if ":" not in settings.world.map:  # code of the user's is not run to show settings
        with originals_named(settings):
            MAPS.get(settings.world.map).light(settings.world.weather)
    for setting, name in code_of(settings):
        say(f"note: {setting} names code, which a run calls: {name!r}")
    typer.echo(_text(settings, legacy=legacy))


@config_app.command("convert")
def convert_config(
    source: Annotated[Path, typer.Argument(help="Settings to read, in either notation.")],
    target: Annotated[Path, typer.Argument(help="File to write; it must not exist.")],
    set_: Overrides = None,
) -> None:
    """Convert settings between the native and the DAT benchmark's notation."""
    from eyas.dat.settings.adapter import is_original
    from eyas.engine.core.errors import OutputError
    from eyas.engine.core.files import write_atomic
    from eyas.engine.settings.file import load_settings, read_settings

    if target.exists():
        raise OutputError(f"{target}: already exists; settings files are never overwritten")
    legacy = not is_original(read_settings(source))
    text = _text(load_settings(source, gathered(set_), trust=True), legacy=legacy)
    write_atomic(target, f"{text}\n".encode())
    written = "the DAT benchmark's" if legacy else "the native"
    typer.echo(f"{target}: the settings of {source} in {written} notation")


@config_app.command("schema")
def print_schema() -> None:
    """Print the JSON Schema of settings, by which editors complete and check them."""
    from eyas.engine.settings.schema import config_schema

    typer.echo(json.dumps(config_schema(), indent=1))


def _text(settings: "EyasConfig", *, legacy: bool) -> str:
    from eyas.dat.settings.adapter import to_original

    if legacy:
        return json.dumps(to_original(settings), indent=4)
    return settings.model_dump_json(indent=2)


cache_app = typer.Typer(
    help="Show, delete or make the files that Eyas keeps on disk.", no_args_is_help=True
)


@cache_app.command("info")
def cache_info(*, as_json: AsJson = False) -> None:
    """Print the folder, size, size limit and contents of the cache."""
    from eyas.cli import cache

    cache.run_info(as_json=as_json)


@cache_app.command("clear")
def clear_cache(
    kind: Annotated[
        str | None, typer.Option("--kind", help="Only this kind, as `eyas cache info` names it.")
    ] = None,
) -> None:
    """Delete the contents of the cache; they are made again when they are needed."""
    from eyas.cli import cache

    cache.run_clear(kind)


@cache_app.command("warm")
def warm_cache(map_name: OnlyMaps = None, weather: OnlyWeathers = None) -> None:
    """Make what the default settings need now, not on first use: for images of a cluster."""
    from eyas.cli.cache import run_warm

    run_warm(map_name or (), weather or ())


_SHOWN = ("overview.html", "index.html", "**/episode.*", "plots/*.png", "**/*.mp4", "**/*.png")
"""What there is to look at in folders of Eyas, the best first."""

_SEEN_BY = {".html", ".mp4", ".webp", ".png", ".jpg", ".jpeg", ".svg"}


def open_run(
    run: Annotated[Path, typer.Argument(help="Folder of a recording, data set, training, ...")],
    print_only: Annotated[
        bool, typer.Option("--print", help="Print what would be opened, and open nothing.")
    ] = False,
) -> None:
    """Show the film, page or plot of a run in the browser or the viewer of this machine."""
    from eyas.engine.core.errors import DataFileError

    if not run.exists():
        raise DataFileError(f"{run}: cannot read: no such file or folder")
    found = [run] if run.is_file() else [path for name in _SHOWN for path in sorted(run.glob(name))]
    shown = next((path for path in found if path.suffix.lower() in _SEEN_BY), None)
    if shown is None:
        raise DataFileError(f"{run}: holds no page, film or picture")
    typer.echo(str(shown))
    if not print_only:
        import webbrowser

        webbrowser.open(shown.resolve().as_uri())


_BESIDES = {
    "shapely": "its wheel has GEOS, LGPL-2.1",
    "numpy": "its wheel has OpenBLAS, BSD-3-Clause, and libgfortran, GPL-3.0 with the exception",
    "llvmlite": "its wheel has LLVM, Apache-2.0 with the exception",
}
"""What wheels have within them, by package: their metadata do not say it."""


class InstalledPackage(NamedTuple):
    """A package that a plain installation has."""

    name: str
    version: str
    licence: str  # Licence, by the package's metadata
    besides: str  # What its wheel has within it; empty: nothing that is known


def about(
    licences: Annotated[
        bool, typer.Option("--licences", help="List the packages that Eyas needs, and theirs.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Show the licences of Eyas and of the packages that it needs."""
    if as_json:
        typer.echo(json.dumps([part._asdict() for part in parts()], indent=1))
        return
    from eyas.engine.core.installed import installed_version

    typer.echo(
        f"Eyas {installed_version()}: a simulator and benchmark for drone visual active tracking."
    )
    typer.echo("MIT licence, with all maps, models, textures, recordings and policies that ship.")
    if not licences:
        return
    for part in parts():
        typer.echo(f"{part.name} {part.version}: {part.licence}")
        if part.besides:
            typer.echo(f"  {part.besides}")


def parts() -> list[InstalledPackage]:
    """Return the packages that Eyas needs, and those that they need, without extras."""
    from importlib.metadata import PackageNotFoundError, distribution  # slow to import

    known: dict[str, InstalledPackage] = {}
    todo = ["eyas"]
    while todo:
        name = todo.pop()
        if name in known:
            continue
        try:
            found = distribution(name)
        except PackageNotFoundError:  # of another system, or removed
            continue
        known[name] = InstalledPackage(name, found.version, _licence(found), _BESIDES.get(name, ""))
        todo += _needed(found)
    known.pop("eyas", None)
    return [known[name] for name in sorted(known)]


def _needed(found: "Distribution") -> Iterator[str]:
    """Yield the packages that one needs, whatever the system, without its extras."""
    for line in found.requires or ():
        name = re.match(r"[\w.-]+", line)
        if name and "extra ==" not in line:
            yield re.sub(r"[-_.]+", "-", name[0]).lower()


def _licence(found: "Distribution") -> str:
    """Return a package's licence: an expression of SPDX, or what its metadata say instead."""

    def told(key: str) -> list[str]:
        return found.metadata.get_all(key) or []

    names = [
        line.rpartition(" :: ")[2]
        for line in told("Classifier")
        if line.startswith("License ::") and not line.endswith("OSI Approved")
    ]
    said = [text.strip().partition("\n")[0] for text in told("License")]
    return next(filter(None, (*told("License-Expression"), *said, ", ".join(names))), "not told")
