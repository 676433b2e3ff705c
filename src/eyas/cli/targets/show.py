"""Pictures of targets: a sheet from several sides and from the height of a tracker, or a film."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from eyas.cli.targets.stage import Camera, TargetPose, TargetStage
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.files import atomic_path
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.kind import as_custom, kind_name_of
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, kind_of, models_of
from eyas.engine.targets.words import words_of

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


def _around(model: int, bearing: float, elevation: float) -> Camera:
    """Return a camera near a model, which fills the picture."""
    size = MODELS[model].size
    distance = max(5.0, 2.0 * max(size))
    field = 2.0 * np.arctan(0.56 * float(np.linalg.norm(size)) / distance)
    return Camera(bearing=bearing, elevation=elevation, distance=distance, field_of_view=field)


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
            Camera(bearing=turn, elevation=1.1, distance=_HEIGHT, field_of_view=_FIELD),
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
