"""What the commands of this house do, as functions of Python; `eyas` offers them by these names."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypedDict, Unpack


def track(
    recording: Path | str,
    tracker: str,
    out: Path | str,
    *,
    split: str | None = None,
    restarts: bool = False,
    only: str | None = None,
    truth: Path | str | None = None,
    box: tuple[float, float, float, float] | None = None,
    overwrite: bool = False,
) -> dict[str, Any]:
    """Score a box tracker on recordings or sequences, like `eyas track`; return `results.json`.

    Args:
        recording: Folder of a recording, a data set or sequences of others; or a film.
        tracker: `csrt`, `kcf`, `nano`, `stay`, or `package.module:Class`.
        out: Folder for its boxes and figures.
        split: Only `train`, `val` or `test` of a data set.
        restarts: Whether it gets the true box again after a failure.
        only: Pattern of the names of clips that are used, as `car*`.
        truth: File of the true boxes of a film, or of a folder of pictures.
        box: The target in the first picture: left, top, width, height [pixels], for no truth.
        overwrite: Whether what is in the folder is replaced.

    Raises:
        EyasError: The tracker is wrong, or the recording, or the folder; one line.
    """
    from eyas.datasets.tracking.run import Scoring, run

    scoring = Scoring(
        tracker, Path(recording), split, restarts, only, Path(truth) if truth else None, box
    )
    return run(scoring, Path(out), overwrite=overwrite)


class DatasetChoices(TypedDict, total=False):
    """How a data set is made, by keyword."""

    workers: int
    """Number of processes; by default one for each core."""
    sample: bool
    """Whether only a hundredth is made."""
    shard: str
    """`3/100`: only the third of a hundred shards."""
    ray: bool
    """Whether the processes of a Ray cluster record."""
    trust: bool
    """Whether the recipe may name code."""


def make_dataset(
    recipe: Mapping[str, Any] | Path | str,
    out: Path | str,
    *,
    resume: bool = False,
    quiet: bool = True,
    **choices: Unpack[DatasetChoices],
) -> Path | str:
    """Make a data set, like `eyas dataset make`; return its folder.

    A script that calls it with more than one worker must do so under
    `if __name__ == "__main__":`, as with all processes that Python starts.

    Args:
        recipe: `detect`, `follow`, `sot`, the path of a recipe, or one as nested dictionaries.
        out: The folder.
        resume: Whether an interrupted data set in the folder is continued.
        quiet: Whether nothing is printed.
        choices: `workers`, `sample`, `shard`, `ray`, `trust`: see `DatasetChoices` in this module.

    Raises:
        EyasError: The recipe is wrong or cannot be met, or the folder is taken; one line.
    """
    from eyas.datasets.making.make import Making
    from eyas.datasets.making.run import run
    from eyas.engine.core.errors import UnknownNameError
    from eyas.engine.terminal.options import parsed_shard

    for name in choices:
        if name not in DatasetChoices.__annotations__:
            raise UnknownNameError("keyword", name, DatasetChoices.__annotations__)
    making = Making(workers=choices.get("workers"), resume=resume, quiet=quiet)
    named = recipe if isinstance(recipe, Mapping) else str(recipe)
    run(
        named,
        str(out),
        making,
        sample=choices.get("sample", False),
        shard=parsed_shard(choices.get("shard")),
        ray=choices.get("ray", False),
        trust=choices.get("trust", False),
    )
    return out
