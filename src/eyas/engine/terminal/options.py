"""The options that several commands share, each typed once.

An option whose help differs from command to command is a function of the help, such as `to_write`.
"""

import json
import re
from pathlib import Path
from typing import Annotated, Any

import typer

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.settings.preset import PRESETS

ConfigFile = Annotated[
    Path | None,
    typer.Option(
        "--config", help="Settings in JSON: native, or the DAT benchmark's env_config.json."
    ),
]
Preset = Annotated[
    str | None,
    typer.Option(
        "--preset",
        help=f"Settings that come with Eyas, for worlds and trainings: {', '.join(PRESETS)}.",
    ),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change a setting; may be given several times."
    ),
]
POLICIES = (
    "random, hover, follow (an oracle), sighted, constant-velocity, wait-20, wait-45, wait-90, "
    "road-graph, relay, servo, gimbal-servo, attribute-servo, salient-servo, csrt, kcf, mosse, "
    "medianflow, nano, stay, eyas, eyas-flown, eyas-words, fast"
)
"""The policies that come with Eyas, for help, which must not load what knows them; a test holds
the two equal."""
SEVERAL = "may be given several times"

PushToHub = Annotated[
    str | None,
    typer.Option(
        "--push-to-hub", metavar="NAME", help="Publish it as ACCOUNT/NAME on the Hugging Face hub."
    ),
]
Private = Annotated[
    bool, typer.Option("--private", help="Only you may see a repository that is made there.")
]

MapName = Annotated[
    str | None,
    typer.Option("--map", help="Name of the map, FILE.plan.json, or package.module:attribute."),
]
Weather = Annotated[
    str | None, typer.Option("--weather", help="Name of the weather, or package.module:attribute.")
]
Seed = Annotated[int | None, typer.Option("--seed", help="The one seed of the run.")]
UntilIdle = Annotated[
    float | None,
    typer.Option(
        "--until-idle",
        metavar="SECONDS",
        min=1.0,
        max=1e9,
        help="End after this time without a client; by default never.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
OnlyMaps = Annotated[list[str] | None, typer.Option("--map", help=f"Only this map; {SEVERAL}.")]
OnlyWeathers = Annotated[
    list[str] | None, typer.Option("--weather", help=f"Only this weather; {SEVERAL}.")
]
Out = Annotated[Path, typer.Option("--out", help="Folder to write to.")]
Resume = Annotated[bool, typer.Option("--resume", help="Continue what was interrupted.")]
Overwrite = Annotated[
    bool, typer.Option("--overwrite", help="Replace what an earlier run has written there.")
]
Rerun = Annotated[
    bool, typer.Option("--rerun", help="Show it in Rerun's viewer as it flies (extra exports).")
]
RerunAt = Annotated[
    str | None,
    typer.Option(
        "--rerun-at", metavar="HOST:PORT", help="The same, in a viewer that listens there."
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=1024, help="Processes; by default one for each core."),
]
Ray = Annotated[
    bool, typer.Option("--ray", help="Spread the work over a Ray cluster (extra cluster).")
]
Shard = Annotated[
    str | None, typer.Option("--shard", metavar="I/N", help="Do one of N shares of the work.")
]
Plots = Annotated[bool, typer.Option("--plots", help="Draw the figures, too (extra plots).")]
Trust = Annotated[
    bool, typer.Option("--trust", help="Let the file of settings name code, which is then run.")
]


def to_write(what: str) -> Any:  # noqa: ANN401  # Typer's
    """Return the option `--out` of a command that writes something else than a folder, or knows
    where to.
    """
    return typer.Option("--out", help=what)


def by_policy(what: str) -> Any:  # noqa: ANN401  # Typer's
    """Return the option `--policy`; `what` says what the policy does."""
    return typer.Option("--policy", help=f"{what}{POLICIES}, a file, or package.module:name.")


def apart(names: list[str] | None) -> tuple[str, ...]:
    """Return the names of an option that takes several, given with commas or several times."""
    return tuple(name for text in names or () for name in text.split(",") if name)


def parsed_shard(text: str | None) -> tuple[int, int] | None:
    """Return number and count of `3/100`.

    Raises:
        ConfigError: It is of another form.
    """
    if text is None:
        return None
    found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
    if not found or not 1 <= int(found[1]) <= int(found[2]):
        raise ConfigError(f"--shard: {text!r} is not allowed: I/N, I from 1 to N, such as 3/100")
    return int(found[1]), int(found[2])


def refuse_both(*, resume: bool, overwrite: bool) -> None:
    """Refuse to continue and to replace at once.

    Raises:
        ConfigError: Both are asked for.
    """
    if resume and overwrite:
        raise ConfigError("--overwrite and --resume cannot be used together")


def chosen_file(config: Path | None, preset: str | None) -> Path | None:
    """Return the file of settings that a user has chosen; None for the defaults.

    Raises:
        ConfigError: There is no such preset, or a file is given as well.
    """
    if preset is None:
        return config
    from eyas.engine.settings.preset import preset_file

    if config is not None:
        raise ConfigError(
            "--preset and --config cannot be used together; change single settings with --set"
        )
    return preset_file(preset)


def gathered(
    overrides: list[str] | None,
    map_name: str | None = None,
    weather: str | None = None,
    seed: int | None = None,
) -> list[str]:
    """Return all changes of settings as `key=value`; short options come last and so win."""
    short = {"world.map": map_name, "world.weather": weather, "seed": seed}
    from_options = [
        f"{key}={json.dumps(value)}" for key, value in short.items() if value is not None
    ]
    return [*(overrides or []), *from_options]


def recorded(
    *,
    frames: int | None,
    episodes: int | None,
    drones: int | None,
    size: str | None,
    fps: float | None,
) -> list[str]:
    """Return what a recording holds, by its options, as changes of settings, `key=value`.

    Raises:
        ConfigError: A size is of another form than 640x480.
    """
    if episodes is not None and frames is None:
        frames = 150  # 6 s at the usual 25 Hz, as long as a recording without either
    changes: dict[str, object] = {
        "video.episode_frames": frames,
        "video.episodes": episodes,
        "video.channels": drones,
        "video.fps": fps,
    }
    if size is not None:
        found = re.fullmatch(r"(\d{1,5})x(\d{1,5})", size)
        if not found:
            raise ConfigError(f"--size: {size!r} is not allowed: WxH in pixels, such as 640x480")
        changes |= {"camera.width": int(found[1]), "camera.height": int(found[2])}
    return [f"{key}={json.dumps(value)}" for key, value in changes.items() if value is not None]


def followed(name: str) -> list[str]:
    """Return the changes of settings, `key=value`, that follow a kind of target or a class of
    vehicles; vehicles other than cars are those of a mixed fleet.

    Raises:
        UnknownNameError: There is no such target.
    """
    from eyas.engine.targets.config import TargetName, vehicle_class
    from eyas.engine.traffic.config import VehicleType

    if name in list(TargetName):
        return [f"target={name}"]
    if not TargetName.elsewhere(name):
        raise UnknownNameError("--target", name, [*TargetName, *VehicleType])
    kind = vehicle_class(name)
    changes = ["target=SUMO_VEHICLE", f"start.vehicles={json.dumps([kind])}"]
    if kind is VehicleType.PASSENGER:
        return changes
    from eyas.engine.settings.video import VideoConfig
    from eyas.engine.traffic.config import TrafficConfig
    from eyas.engine.traffic.fleet import vehicle_types
    from eyas.engine.traffic.library import CANONICAL_MIX

    fleet = vehicle_types(TrafficConfig(vehicle_type=CANONICAL_MIX))
    drones = min(VideoConfig().channels, fleet.count(kind))
    changes += [f"traffic.vehicle_type={CANONICAL_MIX.model_dump_json()}"]
    return [*changes, f"video.channels={drones}"]  # one for each
