"""`eyas dataset make`, from the words of a user."""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from eyas.datasets.asked import Asked
from eyas.datasets.layout import RECIPE_FILE, Plan
from eyas.datasets.making.make import Making, make, report
from eyas.datasets.recipe import Recipe, read_recipe
from eyas.engine.core.config import validated
from eyas.engine.core.errors import ConfigError
from eyas.engine.video.action import check_flight


def run(
    # `detect`, `follow`, `sot`, the path of a recipe, or one from Python, as its JSON
    named: str | Mapping[str, Any],
    out: str,
    making: Making,
    *,
    asked: Asked = Asked(),  # noqa: B008  # never changes
    sample: bool = False,
    # Number of the shard, from 1, and of all shards; None: all of it
    shard: tuple[int, int] | None = None,
    ray: bool = False,
    trust: bool = False,
) -> None:
    """Make a data set, or what is missing of it.

    Raises:
        EyasError: The recipe is wrong or cannot be met, the folder is taken, or something cannot be
            written; one line.
        KeyboardInterrupt: The user stopped it; every file that exists is complete.
    """
    if "://" in out:
        raise ConfigError(f"--out: {out!r} is not allowed: a folder on this machine")
    if isinstance(named, str):
        recipe, source = read_recipe(named, trust=trust), named
    else:
        recipe, source = validated(Recipe, named), RECIPE_FILE
    if asked != Asked():
        recipe, source = asked.of(recipe), RECIPE_FILE
    plan = Plan.of(recipe, source, sample=sample, shard=shard)
    for part in plan.parts():  # refuses a recipe that cannot be met, before anything begins
        check_flight(part.config)
    with ExitStack() as stack:
        recorded = None
        if ray:
            from eyas.datasets.making.spread import on_ray

            recorded = stack.enter_context(on_ray())
        make(plan, Path(out), making, recorded)
    report(plan, out, quiet=making.quiet)
