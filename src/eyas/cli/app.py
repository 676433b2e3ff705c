"""The commands of `eyas`."""

import logging
import os
import sys
import traceback
import warnings
from collections.abc import Callable
from typing import Annotated, Any, TextIO

import typer
import typer.core

from eyas.engine.core.errors import EyasError, one_line
from eyas.engine.core.own_code import ended
from eyas.engine.core.registry import Registry
from eyas.engine.core.scratch import remove_left_scratch
from eyas.engine.terminal.stderr import lacks_memory, say

# Typer brings its own copy of click in new versions and uses click in old ones.
_UsageError: Any = typer.BadParameter.__mro__[1]
Click = Any  # an object of Typer's own copy of click, or of click


class _Carried(Exception):  # noqa: N818  # no error
    """Carries an interrupt past Typer, which would drop what its notes say."""

    def __init__(self, interrupt: KeyboardInterrupt) -> None:
        self.interrupt = interrupt


_OFFLINE = "--offline"


class _Group(typer.core.TyperGroup):
    def invoke(self, ctx: Click) -> Any:  # noqa: ANN401  # as in Typer
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            raise _Carried(interrupt) from None

    def resolve_command(self, ctx: Click, args: list[str]) -> Any:  # noqa: ANN401  # as in Typer
        """Let `eyas evaluate --offline` be `eyas track`, which is of another house."""
        if args[:1] == ["evaluate"] and any(one.split("=")[0] == _OFFLINE for one in args):
            given = [one.removeprefix(f"{_OFFLINE}=") for one in args[1:] if one != _OFFLINE]
            args = ["track", *given]
        return super().resolve_command(ctx, args)


app = typer.Typer(
    cls=_Group,
    name="eyas",
    help="A fast, repeatable simulator and benchmark for drone visual active tracking.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

COMMANDS: Registry[Any] = Registry("command", object, group="eyas.commands")
"""Functions and groups of functions (`typer.Typer`) by the names of their commands."""

_FIRST = tuple(
    "demo video export track train run serve evaluate compare leaderboard reproduce policies "
    "dataset targets maps traffic".split()
)
"""The order of the commands in the help; all others follow."""


def _add_commands() -> None:
    try:
        names = COMMANDS.names()
    except EyasError as error:  # two packages bring the same command
        say(f"warning: {one_line(str(error))}")
        names = COMMANDS.built_in
    for name in (*(name for name in _FIRST if name in names), *sorted({*names} - {*_FIRST})):
        try:
            found = COMMANDS.get(name)
        except Exception as error:  # whatever the package of somebody else raises
            if name in COMMANDS.built_in:
                raise
            say(f"warning: the command {name!r} is left out: {one_line(str(error))}")
            continue
        if isinstance(found, typer.Typer):
            app.add_typer(found, name=name)
        else:
            app.command(name)(found)


_add_commands()


def _print_version(value: bool) -> None:  # typer's callback
    if value:
        from eyas.engine.core.identity.build import (
            this_build,  # reads files, so only when it is asked for
        )
        from eyas.engine.core.installed import installed_version

        typer.echo(f"eyas {installed_version()} (build {this_build().id})")
        raise typer.Exit


@app.callback()
def _options(
    context: typer.Context,
    version: Annotated[  # used by its callback
        bool,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            help="Print the version and the build.",
        ),
    ] = False,
    verbose: Annotated[
        bool,
        typer.Option("--verbose", "-v", help="Print a traceback with an error, and more of a run."),
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print nothing but errors, and what is asked for.")
    ] = False,
) -> None:
    remove_left_scratch()
    if quiet:
        logging.getLogger("eyas").setLevel(logging.ERROR)
        context.default_map = _quiet(context.command)
    elif verbose:
        logging.getLogger("eyas").setLevel(logging.DEBUG)


def _quiet(command: Click) -> dict[str, Any]:
    """Return the defaults of a command, and of those in it, where each that can be is quiet."""
    inner = {name: _quiet(each) for name, each in getattr(command, "commands", {}).items()}
    own = any("--quiet" in option.opts for option in command.params)
    return inner | ({"quiet": True} if own and not inner else {})


class _Line(logging.Formatter):
    """Formats a log record as `eyas: message`, with `warning:` from that level on."""

    def format(self, record: logging.LogRecord) -> str:
        word = "warning: " if record.levelno >= logging.WARNING else ""
        lines = map(one_line, record.getMessage().split("\n"))  # several with a traceback
        return f"eyas: {word}" + "\n".join(lines)


class _Lines(logging.StreamHandler[TextIO]):
    """Writes records as lines; on a terminal the next one takes the place of one that passes."""

    _stage: object = None  # That was written last

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record; where lines stay, none that is empty, and each stage once."""
        terminal, stage = self.stream.isatty(), getattr(record, "passing", None)
        if terminal or (record.msg and (stage is None or stage != self._stage)):
            self.terminator = "\r" if terminal and stage is not None else "\n"
            self._stage = stage or self._stage
            super().emit(record)

    def format(self, record: logging.LogRecord) -> str:
        """Return the text of a record, over what has passed."""
        text = super().format(record) if record.msg else ""
        return f"\x1b[2K{text}" if self.stream.isatty() else text


def _as_switches(command: Click) -> Click:
    """Return a command whose help, and that of all in it, prints switches without `<bool>`, which
    new versions of Typer add.
    """
    command.get_params = _patched(command.get_params)
    for inner in getattr(command, "commands", {}).values():
        _as_switches(inner)
    return command


def _patched(get_params: Callable[[Any], list[Any]]) -> Callable[[Any], list[Any]]:
    def params(context: Click) -> list[Any]:
        found = get_params(context)
        for each in found:
            described = getattr(each, "type_descriptor", None)
            if described is not None and described.annotation is bool:
                each.metavar = ""
        return found

    return params


def run() -> int:
    """Run the command line; return the exit code."""
    warnings.showwarning = lambda message, *_, **__: say(f"warning: {message}")
    lines = _Lines()
    lines.setFormatter(_Line())
    logging.basicConfig(handlers=[lines], level=logging.WARNING)
    logging.getLogger("eyas").setLevel(logging.INFO)
    try:
        status = _as_switches(typer.main.get_command(app))(standalone_mode=False)
        sys.stdout.flush()  # here, so that a closed pipe is caught below
    except EyasError as error:
        if logging.getLogger("eyas").isEnabledFor(logging.DEBUG):
            traceback.print_exception(error)
        return _failed(str(error))
    except _UsageError as error:
        return _misused(error)
    except _Carried as carried:
        raise carried.interrupt from None
    except typer.Abort:
        raise KeyboardInterrupt from None
    except (OSError, ValueError) as error:
        return _not_ours(error)
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):  # Typer and rich end so
            return 1  # the reader of our output has seen enough
        return _failed(f"code of a map, a writer or a file {ended(error)}")
    return status if isinstance(status, int) else 0


def _not_ours(error: OSError | ValueError) -> int:
    """Return the exit code of an error that is not an `EyasError`; a fault is raised again."""
    if isinstance(error, OSError) and error.errno is not None and not lacks_memory(error):
        return _not_printed(error)
    from eyas.lanes import LanesError

    if not isinstance(error, LanesError):
        raise error
    return _failed(str(error))


def _not_printed(error: OSError) -> int:
    """Return the exit code of a system's refusal, nearly always to print."""
    if error.filename is not None:
        return _failed(f"{error.filename}: {error.strerror}")
    # What is left in the buffer would fail again when Python ends.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if isinstance(error, BrokenPipeError):
        return 1  # the reader of our output has seen enough
    return _failed(f"stdout: cannot write: {error.strerror or error}")


def _misused(error: Click) -> int:
    """Return the exit code of a command line that is wrong."""
    message = error.format_message()
    if type(error).__name__ != "NoArgsIsHelpError":
        return _failed(message)
    if message:  # new versions of Typer have printed the help already
        print(message, file=sys.stderr)
    return 2


def _failed(line: str) -> int:
    say("error: " + " ".join(line.splitlines()))
    return 2
