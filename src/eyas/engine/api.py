"""What the commands do, as functions of Python; `eyas` offers them by these names."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from eyas.engine.envs.choice import EnvChoices, Source, chosen_settings

if TYPE_CHECKING:
    import gymnasium

    from eyas.benchmark.record import EpisodeRecord
    from eyas.engine.settings.config import EyasConfig

__all__ = [
    "evaluate",
    "export",
    "make",
    "make_config",
    "make_dataset",
    "make_vec",
    "record",
    "track",
    "train",
]

Names = str | Sequence[str]


def make(name: str = "citystreet-day", **choices: Any) -> "gymnasium.Env[Any, Any]":  # noqa: ANN401
    """Return the environment of one drone: `gymnasium.make("eyas/<name>-v0", ...)`.

    Args:
        name: Map and weather, such as `village-night`.
        choices: Settings, as of `TrackingEnv`, and what `gymnasium.make` takes.

    Raises:
        gymnasium.error.Error: There is no such environment.
        EyasError: A setting is wrong; one line.
    """
    import gymnasium

    from eyas.engine.envs.notebook import show_wrapped

    show_wrapped()
    return gymnasium.make(f"eyas/{name}-v0", **choices)


def make_vec(
    name: str = "citystreet-day",
    num_envs: int = 1,
    **choices: Any,  # noqa: ANN401
) -> "gymnasium.vector.VectorEnv[Any, Any, Any]":
    """Return the environment of N drones, each in a world of its own, stepped and drawn together.

    Args:
        name: Map and weather, such as `village-night`.
        num_envs: N.
        choices: Settings, as of `EyasVectorEnv`.

    Raises:
        gymnasium.error.Error: There is no such environment.
        EyasError: A setting is wrong; one line.
    """
    import gymnasium

    return gymnasium.make_vec(f"eyas/{name}-v0", num_envs=num_envs, **choices)


def make_config(source: Source = None, **choices: Unpack[EnvChoices]) -> "EyasConfig":
    """Return settings.

    Args:
        source: The name of a preset, the path of a JSON file (native or the original's
            `env_config.json`), nested dictionaries, whole settings, or None for the defaults.
        choices: Settings by keyword, which override it.

    Raises:
        EyasError: A setting is wrong, or the file, or there is no such keyword; one line.
    """
    return chosen_settings(source, **choices)


def record(
    config: Source = None,
    out: Path | str = "runs/video",
    *,
    resume: bool = False,
    overwrite: bool = False,
    quiet: bool = True,
    **choices: Unpack[EnvChoices],
) -> Path:
    """Record episodes with labels, like `eyas video`; return the folder.

    Args:
        config: The settings, see `make_config`.
        out: The folder; holds `DRONE<i>/episode<j>/` afterwards.
        resume: Whether a recording in the folder is continued.
        overwrite: Whether one in the folder is deleted first.
        quiet: Whether nothing is printed.
        choices: Settings by keyword.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    from eyas.engine.video.run import run

    folder = Path(out)
    settings = chosen_settings(config, **choices)
    run(settings, folder, resume=resume, overwrite=overwrite, quiet=quiet)
    return folder


def export(
    recording: Path | str,
    formats: Names,
    out: Path | str | None = None,
    **choices: Any,  # noqa: ANN401
) -> list[Path]:
    """Export a recording or a data set in other tools' formats, like `eyas export`; return folders.

    Args:
        recording: Its folder.
        formats: A name of `list_formats()`, or `package.module:Class`, or several.
        out: Folder of the exports; by default `exports` in that of the recording.
        choices: `copies`, `least_side`, `least_visible`, `ignore_parked`, `resume`, `overwrite`,
            see `eyas.engine.recordings.export.ExportOptions`.

    Raises:
        EyasError: A name is wrong, or the recording, or the folder; one line.
    """
    from eyas.engine.core.errors import UnknownNameError
    from eyas.engine.recordings.export import ExportOptions
    from eyas.engine.recordings.run import run

    for name in choices:
        if name not in ExportOptions.__slots__:
            raise UnknownNameError("keyword", name, ExportOptions.__slots__)
    names = [formats] if isinstance(formats, str) else list(formats)
    folder = None if out is None else Path(out)
    return run(Path(recording), names, folder, ExportOptions(**choices))


def track(
    recording: Path | str,
    tracker: str,
    out: Path | str,
    *,
    split: str | None = None,
    restarts: bool = False,
    overwrite: bool = False,
) -> dict[str, Any]:
    """Score a box tracker on recorded episodes, like `eyas track`; return `results.json`.

    Args:
        recording: Folder of a recording or a data set.
        tracker: `csrt`, `kcf`, `nano`, `stay`, or `package.module:Class`.
        out: Folder for its boxes and figures.
        split: Only `train`, `val` or `test` of a data set.
        restarts: Whether it gets the true box again after a failure.
        overwrite: Whether what is in the folder is replaced.

    Raises:
        EyasError: The tracker is wrong, or the recording, or the folder; one line.
    """
    from eyas.datasets.tracking.run import Scoring, run

    scoring = Scoring(tracker, Path(recording), split, restarts)
    return run(scoring, Path(out), overwrite=overwrite)


class EvaluationChoices(TypedDict, total=False):
    """What an evaluation flies, by keyword."""

    map: Names
    """A map, or several; by default citystreet."""
    weather: Names
    """A weather, or several; by default day."""
    target: Names
    """A target, or several; by default SUMO_VEHICLE."""
    episodes: int
    """For each place and start direction; by default the protocol's number."""
    seeds: int | Sequence[int]
    """Seed of the first episode of each set of episodes: one, or several."""
    latency: str
    """Milliseconds, a profile such as `openfly`, a file with one in each line, or `measured`."""
    sampled: bool
    """Whether a network's actions are sampled, not the best ones."""
    env: Mapping[str, Any]
    """Changes of what the policy sees and does, settings of `env`."""
    settings: Mapping[str, Any]
    """Changes of `tracker`, `control`, `camera`, `start.velocity` and `extras`: another
    protocol."""
    batch: int
    """Episodes that are flown together."""


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


def evaluate(
    policy: str,
    protocol: str = "paper",
    out: Path | str | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
    quiet: bool = True,
    **choices: Unpack[EvaluationChoices],
) -> "list[EpisodeRecord]":
    """Fly a policy in the episodes of a protocol, like `eyas evaluate`; return their records.

    Args:
        policy: A name of `list_policies()`, a file, or `package.module:name`.
        protocol: A name of `list_protocols()`, or `package.module:NAME`.
        out: The folder; by default `runs/evaluation/<policy>-<protocol>`.
        resume: Whether an evaluation in the folder is continued.
        overwrite: Whether one in the folder is deleted first.
        quiet: Whether nothing is printed but failures of the policy.
        choices: `map`, `weather`, `target`: a name or several; `episodes`, `seeds`, `latency`,
            `sampled`, `env`, `settings`, `batch`: see `EvaluationChoices` in this module.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    from eyas.benchmark.plan import EvaluationPlan, folder_name
    from eyas.benchmark.run import run
    from eyas.engine.core.config import validated
    from eyas.engine.core.errors import UnknownNameError

    for name in choices:
        if name not in EvaluationChoices.__annotations__:
            raise UnknownNameError("keyword", name, EvaluationChoices.__annotations__)
    said: dict[str, Any] = {"policy": policy, "protocol": protocol, **choices}
    for name in ("map", "weather", "target"):
        if name in said:
            names = said.pop(name)
            said[f"{name}s"] = [names] if isinstance(names, str) else list(names)
    if isinstance(said.get("seeds"), int):
        said["seeds"] = [said["seeds"]]
    plan = validated(EvaluationPlan, said)
    folder = Path(out) if out is not None else Path("runs/evaluation") / folder_name(plan)
    return run(plan, folder, resume=resume, overwrite=overwrite, quiet=quiet)


def train(
    config: Source = None,
    out: Path | str = "runs/train",
    *,
    resume: bool = False,
    quiet: bool = True,
    **choices: Unpack[EnvChoices],
) -> Path:
    """Train a policy, like `eyas train` (extra `train`); return the path of its ONNX file.

    Args:
        config: The settings, see `make_config`.
        out: The folder of the run.
        resume: Whether a run in the folder is continued.
        quiet: Whether no progress is printed.
        choices: Settings by keyword.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    from eyas.learning.run import run

    return run(chosen_settings(config, **choices), Path(out), resume=resume, quiet=quiet, ray=False)


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
        out: The folder, or a URL that fsspec knows.
        resume: Whether an interrupted data set in the folder is continued.
        quiet: Whether nothing is printed.
        choices: `workers`, `sample`, `shard`, `ray`, `trust`: see `DatasetChoices` in this module.

    Raises:
        EyasError: The recipe is wrong or cannot be met, or the folder is taken; one line.
    """
    from eyas.datasets.making.make import Making
    from eyas.datasets.making.run import parsed_shard, run
    from eyas.engine.core.errors import UnknownNameError

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
