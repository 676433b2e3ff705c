"""`eyas cache`."""

from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(help="Show or delete the files that Eyas keeps on disk.", no_args_is_help=True)


@app.command()
def info() -> None:
    """Print the folder, size, size limit and contents of the cache."""
    from eyas.modes import cache

    cache.run_info()


@app.command()
def clear(
    kind: Annotated[
        str | None, typer.Option("--kind", help="Only this kind, as `eyas cache info` names it.")
    ] = None,
) -> None:
    """Delete the contents of the cache; they are made again when they are needed."""
    from eyas.modes import cache

    cache.run_clear(kind)
