"""`eyas completion`: what a shell needs to complete commands, options and names."""

from collections.abc import Callable, Iterator, Sequence
from enum import StrEnum
from typing import Annotated, Any

import typer

Command = Any  # Typer's own copy of click's class, or click's


class CommandShell(StrEnum):
    """Shells that can complete."""

    BASH = "bash"
    ZSH = "zsh"
    FISH = "fish"


def completion(
    shell: Annotated[CommandShell, typer.Argument(help="bash, zsh or fish.", show_default=False)],
) -> None:
    """Print a script by which a shell completes commands, options, and names of maps or policies.

    For bash: eval "$(eyas completion bash)", in ~/.bashrc.
    """
    from eyas.cli.app import app

    typer.echo(script(shell, typer.main.get_command(app)), nl=False)


def script(shell: CommandShell, command: Command) -> str:
    """Return the script for a shell."""
    known = [
        (path.removeprefix("eyas").strip(), list(getattr(one, "commands", ())), _options(one))
        for path, one in commands("eyas", command)
    ]
    if shell is CommandShell.FISH:
        return "\n".join(_fish(known)) + "\n"
    return "\n".join(_bash(known, zsh=shell is CommandShell.ZSH)) + "\n"


Known = tuple[str, list[str], list[tuple[str, str]]]
"""Path of a command, names of the commands in it, its options with their help."""


def commands(path: str, command: Command) -> Iterator[tuple[str, Any]]:
    """Yield a command and all those in it, each with what is typed for it."""
    yield path, command
    for name, each in getattr(command, "commands", {}).items():
        yield from commands(f"{path} {name}", each)


def _options(command: Command) -> list[tuple[str, str]]:
    options = [
        (word, getattr(each, "help", "") or "")
        for each in command.params
        for word in (*each.opts, *each.secondary_opts)
        if word.startswith("--")
    ]
    return [*options, ("--help", "Show this message and exit.")]


def _names() -> dict[str, Sequence[str]]:
    """Return the names that options take, by option."""
    from eyas.benchmark.api import list_policies
    from eyas.engine import names

    lists: dict[str, Callable[[], Sequence[str]]] = {
        "--map": names.list_maps,
        "--weather": names.list_weathers,
        "--preset": names.list_presets,
        "--policy": list_policies,
        "--target": names.list_targets,
        "--format": names.list_formats,
    }
    return {option: listed() for option, listed in lists.items()}


def _bash(known: Sequence[Known], *, zsh: bool) -> Iterator[str]:
    """Yield the lines of a script for bash, which zsh can run, too."""
    if zsh:
        yield "autoload -U +X compinit && compinit"
        yield "autoload -U +X bashcompinit && bashcompinit"
    yield "_eyas() {"
    # Not `path` and `words`, which are zsh's own: without the first it finds no program.
    yield '  local at="" next i offered="" last="${COMP_WORDS[COMP_CWORD-1]}"'
    yield '  local current="${COMP_WORDS[COMP_CWORD]}"'
    yield "  COMPREPLY=()"
    yield "  for ((i = 1; i < COMP_CWORD; i++)); do"
    yield '    next="${at:+$at }${COMP_WORDS[i]}"'
    yield '    case "$next" in'
    paths = "|".join(f'"{path}"' for path, _, _ in known if path)
    yield f'      {paths}) at="$next" ;;'
    yield "    esac"
    yield "  done"
    yield '  case "$last" in'
    for option, names in _names().items():
        yield f'    {option}) offered="{" ".join(names)}" ;;'
    yield "  esac"
    yield '  if [ -z "$offered" ]; then case "$at" in'
    for path, inner, options in known:
        words = " ".join((*inner, *(word for word, _ in options)))
        yield f'    "{path}") offered="{words}" ;;'
    yield "  esac; fi"
    yield '  COMPREPLY=($(compgen -W "$offered" -- "$current"))'
    yield "}"
    yield "complete -o default -F _eyas eyas"


def _fish(known: Sequence[Known]) -> Iterator[str]:
    """Yield the lines of a script for fish."""
    names = _names()
    # fish's own __fish_seen_subcommand_from takes `maps export` for `export`.
    yield "function __eyas_at"
    yield "  set -l at ''"
    yield "  for word in (commandline -opc)[2..-1]"
    yield "    set -l next (string trim -- $at' '$word)"
    paths = " ".join(f"'{path}'" for path, _, _ in known if path)
    yield f"    contains -- $next {paths}; and set at $next"
    yield "  end"
    yield '  test "$at" = "$argv[1]"'
    yield "end"
    yield "complete -c eyas -f -n '__eyas_at \"\"'"
    for path, inner, options in known:
        when = f'__eyas_at "{path}"'
        for name in inner:
            yield f"complete -c eyas -f -n '{when}' -a {name}"
        for word, help_ in options:
            said = help_.replace("\\", "").replace("'", "\\'")
            takes = f" -x -a '{' '.join(names[word])}'" if word in names else ""
            yield f"complete -c eyas -n '{when}' -l {word[2:]} -d '{said}'{takes}"
