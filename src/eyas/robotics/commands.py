"""`eyas drone`."""

import json
import math
from pathlib import Path
from typing import Annotated

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.options import AsJson

app = typer.Typer(help="Find the constants of a drone from its flights.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command("fit")
def fit_log(
    log: Annotated[
        Path,
        typer.Argument(
            metavar="LOG",
            help="A table (.csv), or the folder of an episode that 'eyas video' has recorded with "
            "the writer 'sensors' and tracker.tells_rotors=true.",
        ),
    ],
    mass: Annotated[
        float | None, typer.Option("--mass", help="Mass, where it is known, in kg.")
    ] = None,
    thrust_constant: Annotated[
        float | None,
        typer.Option(
            "--thrust-constant", help="Thrust of a rotor over its squared rate, where it is known."
        ),
    ] = None,
    *,
    as_json: AsJson = False,
) -> None:
    """Fit thrust, drag and lag of the rotors to a flight, and say how well."""
    for name, value in (("--mass", mass), ("--thrust-constant", thrust_constant)):
        if value is not None and not 0.0 < value < math.inf:
            raise ConfigError(f"{name}: {value} is not allowed: a number above 0")
    if mass is not None and thrust_constant is not None:
        raise ConfigError("--mass and --thrust-constant: only one of them, which gives the other")
    from eyas.robotics.fitting.fit import fit, lines, record
    from eyas.robotics.fitting.log import read_log

    found = fit(read_log(log))
    if as_json:
        typer.echo(json.dumps(record(found, mass, thrust_constant), indent=1))
        return
    for line in lines(found, mass, thrust_constant):
        typer.echo(line)
