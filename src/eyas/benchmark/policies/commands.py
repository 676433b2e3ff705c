"""`eyas policies`."""

import json
from typing import Annotated, Any

import typer

from eyas.engine.terminal.options import AsJson

__all__ = ["app"]

app = typer.Typer(help="Tell of the policies that Eyas brings along.", no_args_is_help=True)


@app.callback()
def _policies_group() -> None: ...


@app.command("list")
def list_policies(*, as_json: AsJson = False) -> None:
    """Print the policies for `eyas evaluate --policy`; as JSON, also what trained ones reach."""
    from eyas.benchmark.policies.shipped import card_of, shipped_names
    from eyas.benchmark.policies.table import POLICIES
    from eyas.benchmark.report.reproduce.tables import flown_of

    if as_json:
        listed: list[dict[str, Any]] = [{"name": name} for name in POLICIES.names()]
        for name in shipped_names():
            figures = [
                {"table": table, **one.model_dump(mode="json"), "build_id": build}
                for table, rows in flown_of(name).items()
                for _, one, build in rows
            ]
            said = card_of(name).model_dump(mode="json")
            listed.append({"name": name, **said, "figures": figures})
        typer.echo(json.dumps(listed, indent=1))
        return
    for name in POLICIES.names():
        typer.echo(f"{name} ({POLICIES.path(name) or 'built in'})")
    for name in shipped_names():
        card = card_of(name)
        typer.echo(f"{name}: {card.title}; {card.decisions:,} decisions of `{card.command}`")
    typer.echo("What a trained policy reaches: eyas policies card NAME")


@app.command("card")
def policy_card(
    name: Annotated[str, typer.Argument(help="Name of a trained policy: see 'list'.")],
) -> None:
    """Print the model card of a trained policy: what it is for, learned from, reaches, cannot."""
    from eyas.benchmark.policies.shipped import shipped_names
    from eyas.benchmark.report.reproduce.model_card import model_card
    from eyas.engine.core.errors import UnknownNameError

    if name not in shipped_names():
        raise UnknownNameError("NAME", name, shipped_names())
    typer.echo(model_card(name))
