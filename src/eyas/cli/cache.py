"""`eyas cache`."""

from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(help="Look at what is kept on disk, and remove it.", no_args_is_help=True)


@app.command()
def info() -> None:
    """Print where the cache is, how large it is and may become, and what is in it."""
    from eyas.modes import cache

    cache.run_info()


@app.command()
def clear(
    kind: Annotated[
        str | None, typer.Option("--kind", help="Only this kind, as `eyas cache info` names it.")
    ] = None,
) -> None:
    """Remove what is in the cache; it is made anew when it is needed."""
    from eyas.modes import cache

    cache.run_clear(kind)
