"""Pictures of targets alone on a street: sheets from several sides and from above, or films."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.files import atomic_path
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.kind import as_custom, kind_name_of
from eyas.engine.render.renderer import build_renderer
from eyas.engine.sim.scenes import load_geometry, load_scene
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, kind_of, models_of
from eyas.engine.targets.kind import Colour, Looks
from eyas.engine.targets.rig import Rigs
from eyas.engine.targets.words import words_of
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import DAY

ALL = "all"  # Name by which all targets are shown in one picture
_NEAR = 256  # Side of a picture from near [pixels]
_SMALL = 168  # Side of a picture on the sheet of all [pixels]
_HEIGHT = 22.0  # Distance of a tracker's camera [m]
_FIELD = np.deg2rad(45.0)
_TURNS = 8
_MOST = 16  # Models of a kind on the sheet of all
_FRAMES, _RATE = 72, 24  # Frames of a film, and frames a second
_BACK, _INK, _DIM = (24, 25, 27), (230, 230, 228), (160, 161, 163)

Rgb = NDArray[np.uint8]


_MAP = "simpleway-lake"


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetPose:
    """How the target is at an instant; it heads along the street."""

    travelled: float = 0.0  # [m]
    speed: float = 0.0  # [m/s]
    yaw_rate: float = 0.0  # [rad/s]
    individual: int = 0  # Which of the vehicles of its model: they differ in details


@dataclass(frozen=True, slots=True, kw_only=True)
class StageCamera:
    """A camera that looks at the target's middle."""

    bearing: float
    """Direction from the target to the camera, counter-clockwise from straight ahead [rad]."""
    elevation: float  # Angle of that direction above the horizon [rad]
    distance: float  # [m]
    field_of_view: float  # Horizontal, and vertical if the picture is square [rad]


class TargetStage:
    """Draws targets, one at a time."""

    def __init__(self, kinds: Sequence[str]) -> None:
        recipe = MAPS.get(_MAP)
        self._kinds = sorted(kind_index(kind) for kind in kinds)
        season = recipe.season(DAY.name)
        scene = load_scene(_MAP, 0, season)
        geometry = load_geometry(_MAP, 0, season, tuple(self._kinds))
        self._renderer = build_renderer(scene, geometry, recipe.light(DAY.name))
        self._rigs = Rigs(np.array(self._kinds, np.int32))
        lane = scene.network.lane_points[: scene.network.lane_first[1]]
        self._spot = np.array([*lane.mean(axis=0), 0.0])
        """The middle of a lane, far from its ends [m]."""
        self._ahead = np.array([*(lane[-1] - lane[0]), 0.0])
        self._ahead /= np.linalg.norm(self._ahead)

    def draw(
        self,
        model: int,
        colour: Colour,
        shots: Sequence[tuple[TargetPose, StageCamera]],
        size: tuple[int, int],
        samples: int = 4,
    ) -> NDArray[np.uint8]:
        """Return a picture of each shot, height and width `size`, sRGB, shape (V, *size, 3)."""
        count, kinds = len(shots), len(self._kinds)
        actor = self._kinds.index(kind_index(MODELS[model].kind))
        actors, movers = ActorState.create(count, kinds), self._rigs.draw_list(count)
        actors.yaw[:] = np.arctan2(self._ahead[1], self._ahead[0])
        actors.present[:, actor] = True
        for v, (pose, _) in enumerate(shots):
            actors.position[v] = self._spot + pose.travelled * self._ahead
            actors.travelled[v], actors.speed[v] = pose.travelled, pose.speed
            actors.yaw_rate[v] = pose.yaw_rate
            movers.object_id[v] += pose.individual
        models = np.array([MODELS.index(KINDS[kind].models[0]) for kind in self._kinds], np.int32)
        models[actor] = model
        colours = np.tile(np.array(colour, np.float32), (count, kinds, 1))
        self._rigs.pose(actors, Looks(np.tile(models, (count, 1)), colours), movers)
        movers.object_id[:] = self._rigs.draw_list(1).object_id
        picture = Picture.create(count, *size)
        middles = actors.position[:, actor] + kind_of(model).ahead * self._ahead
        middles[:, 2] += MODELS[model].size[2] / 2
        views = self._views(middles, actor, [camera for _, camera in shots])
        self._renderer.draw(views, movers, picture, samples)
        assert picture.rgb is not None  # asked for
        return picture.rgb

    def _views(
        self, middles: NDArray[np.float64], actor: int, cameras: Sequence[StageCamera]
    ) -> Views:
        yaw = float(np.arctan2(self._ahead[1], self._ahead[0]))
        looks = np.array([_rotation(camera, yaw) for camera in cameras])
        away = np.array([camera.distance for camera in cameras])
        return Views(
            position=middles - away[:, None] * looks[:, :, 0],
            rotation=looks,
            world=np.arange(len(cameras), dtype=np.int32),
            subject=np.full(len(cameras), ACTOR_OBJECT + actor, np.int32),
            field_of_view=np.array([camera.field_of_view for camera in cameras]),
            instant=np.zeros(len(cameras)),
        )


def _rotation(camera: StageCamera, yaw: float) -> NDArray[np.float64]:
    """Return camera to world for a target with this heading; columns are forward, left, up."""
    level, bearing = np.cos(camera.elevation), camera.bearing + yaw
    forward = -np.array([
        np.cos(bearing) * level, np.sin(bearing) * level, np.sin(camera.elevation),
    ])  # fmt: skip
    left = np.array([np.sin(bearing), -np.cos(bearing), 0.0])
    return np.stack([forward, left, np.cross(forward, left)], axis=1)


def run(name: str, path: Path, custom: CustomConfig | None = None) -> None:
    """Draw a target into a file.

    Args:
        name: Name of a model or of a kind, `all`, a mesh file, or `package.module:Class`.
        path: A .png for a sheet; a .gif, .webp or .apng for a film.

    Raises:
        EyasError: There is no such target or ending, or the file cannot be written.
    """
    form = {".png": "PNG", ".gif": "GIF", ".webp": "WEBP", ".apng": "PNG"}.get(path.suffix.lower())
    if form is None or (name == ALL and path.suffix.lower() != ".png"):
        allowed = ".png" if name == ALL else ".png, .gif, .webp, .apng"
        raise ConfigError(f"--out: {str(path)!r} is not allowed; allowed endings: {allowed}")
    models = _models(name, custom or CustomConfig(path="-"))
    stage = TargetStage(sorted({MODELS[model].kind for model in models}))
    if path.suffix.lower() != ".png":
        frames = [Image.fromarray(frame) for frame in _film(stage, models[0])]
        with atomic_path(path) as part:
            frames[0].save(
                part, format=form, save_all=True, append_images=frames[1:], loop=0,
                duration=round(1000 / _RATE),
            )  # fmt: skip
        return
    if name == ALL:
        sheet = _all(stage, models)
    else:
        sheet = np.concatenate([_sheet(stage, model) for model in models])
    with atomic_path(path) as part:
        Image.fromarray(sheet).save(part, format=form, optimize=True)


def _models(name: str, custom: CustomConfig) -> list[int]:
    """Return the models that a name stands for."""
    if name == ALL:
        kinds = [models_of(kind) for kind in range(len(KINDS))]
        return [model for models in kinds for model in models[:_MOST]]
    if own := as_custom(name, custom):
        return list(models_of(kind_index(kind_name_of(own))))
    found = [m for m, model in enumerate(MODELS) if name == model.name]
    found = found or [m for m, model in enumerate(MODELS) if name == model.kind]
    if not found:
        known = {model.name for model in MODELS} | {kind.name for kind in KINDS} | {ALL}
        raise UnknownNameError("target", name, known)
    return found


def _colour(model: int) -> tuple[float, float, float]:
    colours = kind_of(model).colours
    return colours[(model - MODELS.index(kind_of(model).models[0])) % len(colours)]


def _around(model: int, bearing: float, elevation: float) -> StageCamera:
    """Return a camera near a model, which fills the picture."""
    size = MODELS[model].size
    distance = max(5.0, 2.0 * max(size))
    field = 2.0 * np.arctan(0.56 * float(np.linalg.norm(size)) / distance)
    return StageCamera(bearing=bearing, elevation=elevation, distance=distance, field_of_view=field)


def _sheet(stage: TargetStage, model: int) -> Rgb:
    """Return three rows: all round at rest, from the side in motion, and as a tracker sees it."""
    colour, speed, stride = _colour(model), MODELS[model].speed, MODELS[model].stride
    turns = np.arange(_TURNS) * (2.0 * np.pi / _TURNS)
    rest = [(TargetPose(), _around(model, 0.4 + turn, 0.35)) for turn in turns.tolist()]
    steps = np.arange(_TURNS) / _TURNS * stride
    moving = [
        (TargetPose(travelled=step, speed=speed), _around(model, -1.35, 0.12))
        for step in steps.tolist()
    ]
    near = stage.draw(model, colour, rest + moving, (_NEAR, _NEAR))
    tracked = [
        (
            TargetPose(travelled=0.3 * stride, speed=speed),
            StageCamera(bearing=turn, elevation=1.1, distance=_HEIGHT, field_of_view=_FIELD),
        )
        for turn in turns[::2].tolist()
    ]
    far = [
        _enlarged(picture)
        for side in (84, 320)
        for picture in stage.draw(model, colour, tracked, (side, side), samples=1)
    ]
    rows = [near[:_TURNS], near[_TURNS:], np.array(far)]
    name, size = MODELS[model].name, " x ".join(f"{side:.2f}" for side in MODELS[model].size)
    title = f"{name}: {words_of(model, colour)}; {size} m; {MODELS[model].motion}"
    notes = (
        "at rest", f"in motion, {speed:g} m/s",
        f"from {_HEIGHT:.0f} m: the middle of pictures of 84 x 84 and of 320 x 320",
    )  # fmt: skip
    return _captioned(title, notes, [np.concatenate(list(row), axis=1) for row in rows])


def _enlarged(picture: Rgb) -> Rgb:
    """Return the middle third of a picture, enlarged without smoothing."""
    third = len(picture) // 3
    middle = Image.fromarray(picture[third : 2 * third, third : 2 * third])
    return np.asarray(middle.resize((_NEAR, _NEAR), Image.Resampling.NEAREST))


def _captioned(title: str, notes: Sequence[str], rows: Sequence[Rgb]) -> Rgb:
    """Return rows of pictures below each other, with a title and a note over each."""
    head, line = 40, 24
    height = head + sum(line + len(row) for row in rows)
    sheet = Image.new("RGB", (rows[0].shape[1], height), _BACK)
    pen = ImageDraw.Draw(sheet)
    pen.text((10, 8), title, _INK, ImageFont.load_default(20))
    top = head
    for note, row in zip(notes, rows, strict=True):
        pen.text((10, top + 3), note, _DIM, ImageFont.load_default(14))
        sheet.paste(Image.fromarray(row), (0, top + line))
        top += line + len(row)
    return np.asarray(sheet)


def _all(stage: TargetStage, models: Sequence[int]) -> Rgb:
    """Return a picture of each model, with its name."""
    columns, line = 8, 20
    cell = _SMALL + line
    sheet = Image.new("RGB", (columns * _SMALL, -(-len(models) // columns) * cell), _BACK)
    pen = ImageDraw.Draw(sheet)
    for place, model in enumerate(models):
        speed, stride = MODELS[model].speed, MODELS[model].stride
        pose = TargetPose(travelled=0.1 * stride, speed=speed)
        shot = (pose, _around(model, 0.7, 0.4))
        picture = stage.draw(model, _colour(model), [shot], (_SMALL, _SMALL))[0]
        left, top = place % columns * _SMALL, place // columns * cell
        sheet.paste(Image.fromarray(picture), (left, top))
        name = MODELS[model].name.removesuffix("Simple")
        pen.text((left + 6, top + _SMALL + 3), name, _INK, ImageFont.load_default(12))
    return np.asarray(sheet)


def _film(stage: TargetStage, model: int) -> Rgb:
    """Return the frames of a target that moves while the camera goes round it."""
    speed, stride = MODELS[model].speed, MODELS[model].stride
    # Whole strides, so that the film can be repeated.
    duration = _FRAMES / _RATE
    length = max(round(speed * duration / stride), 1) * stride
    shots = [
        (
            TargetPose(travelled=part * length, speed=speed),
            _around(model, 0.4 + 2.0 * np.pi * part, 0.3),
        )
        for part in (np.arange(_FRAMES) / _FRAMES).tolist()
    ]
    return stage.draw(model, _colour(model), shots, (_NEAR, _NEAR))
