"""The command `eyas`."""

import logging
import os
import sys
import warnings
from typing import Annotated, Any

import typer

from eyas import __version__
from eyas.cli import bench, cache, config, maps, traffic, video
from eyas.core.errors import EyasError

__all__ = ["app", "main"]

_INTERRUPTED = 130
# Typer brings its own copy of click in new versions and uses click in old ones.
_UsageError: Any = typer.BadParameter.__mro__[1]

app = typer.Typer(
    name="eyas",
    help="A fast, repeatable simulator and benchmark for drone visual active tracking.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command("video")(video.command)
app.command("bench")(bench.command)
app.add_typer(cache.app, name="cache")
app.add_typer(config.app, name="config")
app.add_typer(maps.app, name="maps")
app.add_typer(traffic.app, name="traffic")


def _print_version(value: bool) -> None:  # typer's callback
    if value:
        typer.echo(f"eyas {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[  # used by its callback
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None: ...


class _Line(logging.Formatter):
    """Formats a log record as `eyas: message`, with `warning:` from that level on."""

    def format(self, record: logging.LogRecord) -> str:
        word = "warning: " if record.levelno >= logging.WARNING else ""
        return f"eyas: {word}{record.getMessage()}"


def main() -> None:
    """Run the command line: errors are one line on stderr and exit code 2, without a traceback."""
    warnings.showwarning = lambda message, *_, **__: _say(f"warning: {message}")
    lines = logging.StreamHandler()
    lines.setFormatter(_Line())
    logging.basicConfig(handlers=[lines], level=logging.WARNING)
    logging.getLogger("eyas").setLevel(logging.INFO)
    status = _run()
    if status == _INTERRUPTED:
        _say("interrupted")
    sys.exit(status)


def _run() -> int:
    """Return the exit code."""
    try:
        status = app(standalone_mode=False)
        sys.stdout.flush()  # here, so that a closed pipe is caught below
    except EyasError as error:
        return _failed(str(error))
    except _UsageError as error:
        return _failed(error.format_message())
    except (KeyboardInterrupt, typer.Abort):
        return _INTERRUPTED
    except BrokenPipeError:
        # The reader of our output has closed the pipe, so nothing more can be printed.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return status if isinstance(status, int) else 0


def _say(line: str) -> None:
    print(f"eyas: {line}", file=sys.stderr)


def _failed(line: str) -> int:
    _say("error: " + " ".join(line.splitlines()))
    return 2


if __name__ == "__main__":
    main()
