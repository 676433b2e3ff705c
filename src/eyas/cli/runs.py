"""What runs for long: `eyas video`, `serve`, and `run`, which is one of those or of other
houses.
"""

import json
import logging
import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.options import (
    SEVERAL,
    ConfigFile,
    MapName,
    Out,
    Overrides,
    Overwrite,
    Preset,
    Quiet,
    Rerun,
    RerunAt,
    Resume,
    Seed,
    Trust,
    UntilIdle,
    Weather,
    by_policy,
    chosen_file,
    followed,
    gathered,
    recorded,
    to_write,
)
from eyas.engine.terminal.stderr import say

if TYPE_CHECKING:
    from eyas.engine.settings.config import EyasConfig


def video(
    out: Out = Path("runs/video"),
    config: ConfigFile = None,
    preset: Preset = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    trust: Trust = False,
    policy: Annotated[str | None, by_policy("Let a policy fly: ")] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            "--camera",
            help="How the drones fly (video.flight): follow, orbit, fly-by, rise, zoom, "
            "hover-and-pan, search, exact, random, or package.module:Class; policy: as --policy.",
        ),
    ] = None,
    frames: Annotated[
        int | None, typer.Option("--frames", min=1, help="Frames of each drone's episode.")
    ] = None,
    episodes: Annotated[
        int | None, typer.Option("--episodes", min=1, help="Episodes of each drone.")
    ] = None,
    drones: Annotated[
        int | None, typer.Option("--drones", min=1, help="Drones that record together.")
    ] = None,
    size: Annotated[
        str | None, typer.Option("--size", metavar="WxH", help="Size of the pictures, 640x480.")
    ] = None,
    fps: Annotated[float | None, typer.Option("--fps", help="Pictures a second.")] = None,
    target: Annotated[
        str | None,
        typer.Option(
            "--target",
            help="What is followed: Pedestrian, BB-8, ..., see eyas targets list; or car, bus, "
            "truck, trailer, motorcycle.",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers",
            min=1,
            max=1024,
            help="Processes; by default half the cores from four on, else one.",
        ),
    ] = None,
    rerun: Rerun = False,
    rerun_at: RerunAt = None,
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Record labelled pictures and videos of drones that film their targets."""
    from eyas.engine.settings.config import Mode
    from eyas.engine.settings.file import load_settings

    if quiet:
        logging.getLogger("eyas").setLevel(logging.ERROR)
    overrides = [] if target is None else followed(target)
    overrides += gathered(set_, map_name, weather, seed)
    overrides += recorded(frames=frames, episodes=episodes, drones=drones, size=size, fps=fps)
    if (camera == "policy") != (policy is not None) and camera is not None:
        raise ConfigError("--camera: 'policy' goes with --policy, and other flights without it")
    if camera is not None and policy is None:
        overrides = ["video.policy=null", *overrides, f"video.flight={json.dumps(camera)}"]
    if policy is not None:
        # The flight of a file gives way to a policy; one that is asked for beside it does not.
        overrides = ["video.flight=null", *overrides, f"video.policy={json.dumps(policy)}"]
    settings = load_settings(chosen_file(config, preset), overrides, trust=trust)
    if config is not None:
        from eyas.engine.settings.dialect import of_a_run
        from eyas.engine.video.folder import recorded_seed

        settings = of_a_run(settings, recorded_seed(out) if resume else None)
    if settings.mode is not Mode.VIDEO and not quiet:
        said = f"mode (Simulation_Mode) is '{settings.mode}'; 'eyas video' records anyway"
        say(f"note: {said}")
    from eyas.engine.recordings.rerun import live_view
    from eyas.engine.video import (
        run as video,  # compiled kernels: slow to import, so only after all checks
    )

    with live_view(wanted=rerun, at=rerun_at) as live:
        if live is not None and (workers or 1) > 1:
            raise ConfigError("--workers: with --rerun, which shows all frames, one process flies")
        workers = workers or (1 if live is not None else video.default_workers(settings))
        video.run(
            settings,
            out,
            overwrite=overwrite,
            resume=resume,
            quiet=quiet,
            workers=workers,
            live=live,
        )


def serve(
    root: Annotated[
        Path | None,
        typer.Option(
            "--root",
            help="Folder of the DAT benchmark, with Webots_Simulation and Alg_Base, or an empty "
            "one. Its env_config.json is used unless --config or --preset is given.",
        ),
    ] = None,
    mavlink: Annotated[
        list[str] | None,
        typer.Option(
            "--mavlink",
            metavar="ADDRESS",
            help="Fly vehicles that speak MAVLink instead: udp:HOST:PORT to send to, "
            f"udpin:HOST:PORT to listen on; {SEVERAL}.",
        ),
    ] = None,
    px4: Annotated[
        str | None,
        typer.Option(
            "--px4",
            metavar="HOST:PORT",
            help="Wait on this TCP port for PX4, which flies the drone's rotors; its own is 4560.",
        ),
    ] = None,
    ardupilot: Annotated[
        str | None,
        typer.Option(
            "--ardupilot",
            metavar="HOST:PORT",
            help="The same for ArduPilot's JSON simulator, on this UDP port; its own is 9002.",
        ),
    ] = None,
    ros: Annotated[
        int | None,
        typer.Option(
            "--ros",
            metavar="DOMAIN",
            min=0,
            max=232,
            help="Fly a drone for nodes of ROS 2 that run in this domain (ROS_DOMAIN_ID), by DDS.",
        ),
    ] = None,
    until_idle: UntilIdle = None,
    config: ConfigFile = None,
    preset: Preset = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    trust: Trust = False,
) -> None:
    """Serve algorithm code of the DAT benchmark in the place of its simulator, until Ctrl-C."""
    overrides = gathered(set_, map_name, weather, seed)
    chosen = (root, mavlink or None, px4, ardupilot, ros)
    if sum(each is not None for each in chosen) != 1:
        raise ConfigError("one of --root, --mavlink, --px4, --ardupilot and --ros must be given")
    if until_idle is not None and root is None:
        raise ConfigError("--until-idle: only with --root")
    if ros is not None:
        _tell_ros(ros, chosen_file(config, preset), overrides, trust=trust)
        return
    if root is None:
        from eyas.engine.settings.file import load_settings
        from eyas.robotics.serving.mavlink import AS_FLOWN

        file = chosen_file(config, preset)
        _fly(load_settings(file, overrides, base=AS_FLOWN, trust=trust), mavlink, px4, ardupilot)
        return
    from eyas.dat.settings.adapter import LIKE_THE_ORIGINAL
    from eyas.dat.wire.exchange import SETTINGS_FILE
    from eyas.engine.settings.config import Mode
    from eyas.engine.settings.file import load_settings

    file = chosen_file(config, preset)
    if file is None and (root / SETTINGS_FILE).exists():
        file = root / SETTINGS_FILE
    # The first start writes a file, which cannot tell all, and serves what the next will read.
    load = partial(load_settings, file, overrides, base=LIKE_THE_ORIGINAL, trust=trust)
    settings = load()
    if preset is None:
        from eyas.dat.settings.dialect import of_a_run

        settings = of_a_run(settings)
        load = partial(_again, load, settings.seed)
    if settings.original is not None and settings.mode is not Mode.TRAIN:
        said = f"mode (Simulation_Mode) is '{settings.mode}'; 'eyas serve' trains anyway"
        say(f"note: {said}")
    from eyas.dat.serve.run import run as serve_clients  # after all checks

    again = load if file == root / SETTINGS_FILE else None
    serve_clients(settings, root, again, until_idle=until_idle or math.inf)


def _again(load: Callable[[], "EyasConfig"], seed: int) -> "EyasConfig":
    """Return the settings of a server as they are now, for the same run."""
    from eyas.dat.settings.dialect import of_a_run

    return of_a_run(load(), seed)


def run(
    config: Annotated[
        Path, typer.Option("--config", help="JSON file, native or the original's env_config.json.")
    ],
    out: Annotated[Path | None, to_write("Folder to write to, of a recording or training.")] = None,
    root: Annotated[
        Path | None,
        typer.Option(
            "--root",
            help="Folder of the DAT benchmark, to serve its clients; by default the one that holds "
            "the file.",
        ),
    ] = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    trust: Trust = False,
    headless: Annotated[
        bool, typer.Option("--headless", help="Fly a demo without its page, as in eyas demo.")
    ] = False,
) -> None:
    """Do what a file's mode says: demo, video or train, as the DAT benchmark does when it starts.

    In mode train, an env_config.json serves the benchmark's clients (eyas serve), and native
    settings teach a network (eyas train).
    """
    from eyas.dat.serve.run import quietly
    from eyas.dat.wire.exchange import SETTINGS_FILE
    from eyas.engine.settings.config import Mode
    from eyas.engine.settings.file import load_settings

    overrides = gathered(set_, map_name, weather, seed)
    settings = quietly(partial(load_settings, config, overrides, trust=trust))
    if settings.mode is Mode.DEMO:
        from eyas.demo.commands import demo

        _announce("demo")
        demo(config, set_=overrides, trust=trust, headless=headless)
    elif settings.mode is Mode.VIDEO:
        _announce("video")
        video(out or Path("runs/video"), config, set_=overrides, trust=trust)
    elif settings.original is None:
        from eyas.learning.commands import train

        _announce("train")
        train(out, config, set_=overrides, trust=trust)
    else:
        above = config.absolute().parents[len(SETTINGS_FILE.parts) - 1 :]
        root = root or (above[0] if above and (above[0] / SETTINGS_FILE).exists() else None)
        if root is None:
            raise ConfigError(
                f"{config}: Simulation_Mode is 'train', and the file is not in a folder of the DAT "
                f"benchmark (.../{SETTINGS_FILE}); give the folder with --root"
            )
        _announce("serve")
        inside = (root / SETTINGS_FILE).exists() and config.samefile(root / SETTINGS_FILE)
        serve(root=root, set_=overrides, trust=trust, config=None if inside else config)


def _announce(command: str) -> None:
    say(f"the mode of the settings is that of 'eyas {command}'")


def _tell_ros(domain: int, file: Path | None, overrides: list[str], *, trust: bool) -> None:
    """Fly a drone for nodes of ROS 2, until Ctrl-C."""
    from eyas.engine.settings.file import load_settings
    from eyas.robotics.serving.ros import AS_FLOWN, run

    run(load_settings(file, overrides, base=AS_FLOWN, trust=trust), domain)


def _fly(
    settings: "EyasConfig", addresses: list[str] | None, px4: str | None, ardupilot: str | None
) -> None:
    """Fly vehicles that speak MAVLink, or let an autopilot fly one, until Ctrl-C."""
    if addresses:
        from eyas.robotics.serving.mavlink import run

        run(settings, addresses)
        return
    from eyas.robotics.serving import hil

    hil.run(settings, px4=px4, ardupilot=ardupilot)
