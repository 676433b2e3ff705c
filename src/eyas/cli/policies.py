"""`eyas policies`."""

import typer

__all__ = ["app"]

app = typer.Typer(help="List the policies that Eyas brings along.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command("list")
def list_policies() -> None:
    """Print the policies for `eyas evaluate --policy`, and what the trained ones reach."""
    from eyas.evaluation.policies.shipped import card_of, shipped_names
    from eyas.evaluation.policies.table import BUILT_IN

    for name in BUILT_IN:
        typer.echo(f"{name} (built in)")
    for name in shipped_names():
        card = card_of(name)
        typer.echo(f"{name}: {card.title}; {card.decisions:,} decisions of `{card.command}`")
        for score in card.scores:
            typer.echo(
                f"  {score.protocol:<6} {score.map:<10} {score.weather:<6} TSR {score.tsr:.3f}  "
                f"CR {score.cr:.1f}  n {score.n}"
            )
