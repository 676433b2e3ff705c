"""What the commands of the engine do, as functions of Python; `eyas` offers them by these names."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from eyas.engine.core.errors import ConfigError
from eyas.engine.envs.choice import EnvChoices, Source, chosen_settings

if TYPE_CHECKING:
    import gymnasium

    from eyas.engine.settings.config import EyasConfig

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
    return gymnasium.make(_identifier(name), **choices)


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

    return gymnasium.make_vec(_identifier(name), num_envs=num_envs, **choices)


def _identifier(name: object) -> str:
    """Return Gymnasium's name of an environment."""
    if not isinstance(name, str):
        raise ConfigError(
            f"name: a {type(name).__name__} is not allowed; allowed: a map and a weather, such as "
            "'village-night'; other settings are the argument `config`"
        )
    plain = name.removeprefix("eyas/").removesuffix("-v0")  # whole names are taken, too
    return f"eyas/{plain}-v0"


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
