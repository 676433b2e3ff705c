"""Switches in `--help`, after which new versions of Typer print `<bool>`."""

from collections.abc import Callable
from typing import Any

__all__ = ["as_switches"]


def as_switches(command: Any) -> Any:  # noqa: ANN401  # Typer's own copy of click, or click
    """Return a command whose help, and that of all commands in it, prints switches alone."""
    command.get_params = _patched(command.get_params)
    for inner in getattr(command, "commands", {}).values():
        as_switches(inner)
    return command


def _patched(get_params: Callable[[Any], list[Any]]) -> Callable[[Any], list[Any]]:
    def params(context: Any) -> list[Any]:  # noqa: ANN401  # as above
        found = get_params(context)
        for each in found:
            described = getattr(each, "type_descriptor", None)
            if described is not None and described.annotation is bool:
                each.metavar = ""
        return found

    return params
