"""The entry of a target of one's own in the catalogue, and its rig."""

import hashlib
import logging
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError, DataFileError, UnknownNameError
from eyas.engine.core.files import user_path
from eyas.engine.custom.config import ENDINGS, CustomConfig
from eyas.engine.custom.mesh_file import loaded
from eyas.engine.custom.own import OwnTarget, Ride, Shaped
from eyas.engine.custom.problems import of_shape, worst
from eyas.engine.custom.shape import levels_of_detail, simplified
from eyas.engine.custom.user_class import made, posed
from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import KINDS, MODELS, register
from eyas.engine.targets.colour_names import with_article
from eyas.engine.targets.kind import Group, Kind, Looks, Model
from eyas.lanes import exact

_LOG = logging.getLogger("eyas")


def kind_name_of(config: CustomConfig) -> str:
    """Return the kind of a user's target, put into the catalogue when it is asked for first.

    Its name holds a hash of its parts, so that nothing that was kept of others is used for it.

    Raises:
        EyasError: The target cannot be used: one line.
    """
    if config.mesh is None and config.path is None:
        names = [kind.name for kind in KINDS]
        if config.body not in names:
            raise UnknownNameError("custom.body", config.body, names)
        return config.body
    target, word, path = own_target(config), _word(config), config.path or ""
    words = config.words or _spoken(word)
    meshes = [mesh for levels in OwnRig(target, path).part_levels() for mesh in levels]
    name = f"{word}-{_digest(meshes, word, words)}"
    if name not in (kind.name for kind in KINDS):
        # Labels tell the model's name.
        model = f"{name}-model" if word in (one.name for one in MODELS) else word
        register(
            Kind(
                name=name,
                models=(_model(model, word, name, target.size, words),),
                colours=((1.0, 1.0, 1.0),),
                object_class=ObjectClass.ROBOT,
                rig=lambda: OwnRig(target, path),
                keeps_colours=True,
            )
        )
    return name


def _model(name: str, word: str, kind: str, size: tuple[float, float, float], words: str) -> Model:
    return Model(
        name=name,
        typename=word,
        kind=kind,
        size=size,
        rise=size[2] / 2,
        words=(words,),
        motion="moves as its settings say",
        speed=1.0,
        stride=4.0 * size[0],
    )


def as_custom(what: str, config: CustomConfig) -> CustomConfig | None:
    """Return the settings of a mesh file or a `package.module:Class`; None for another name."""
    if user_path(what).suffix.lower() in ENDINGS:
        return config.model_copy(update={"mesh": what, "path": None})
    return config.model_copy(update={"path": what}) if ":" in what else None


def own_target(config: CustomConfig) -> OwnTarget:
    """Return the target that settings describe by a mesh or a class.

    Raises:
        EyasError: It cannot be used: one line.
    """
    if config.path is not None:
        return made(config.path)
    try:
        shape = loaded(config)
    except DataFileError as error:
        raise ConfigError(f"custom.mesh: {error}") from None
    if shape.left_out:
        _warn(f"custom.mesh: {config.mesh}: {shape.left_out}")
    if config.most_triangles is not None and np.isfinite(shape.points).all():
        shape = simplified(shape, config.most_triangles)
    if problem := worst(of_shape(shape)):
        raise ConfigError(f"custom.mesh: {config.mesh}: {problem}")
    return Shaped(shape.size, levels_of_detail(shape))


@cache
def _warn(line: str) -> None:
    """Warn once in a process."""
    _LOG.warning("%s", line)


def _word(config: CustomConfig) -> str:
    """Return what packets and labels call it."""
    if config.path is not None:
        return config.path.partition(":")[2]
    assert config.mesh is not None
    return Path(user_path(config.mesh)).stem


def _spoken(word: str) -> str:
    """Return what people would call it: `DeliveryRobot` and `delivery_robot` is that."""
    runs = re.findall(r"\d+|[^\W\d_]+", word)
    return with_article(" ".join(map(_parted, runs)).lower() or word)


def _parted(letters: str) -> str:
    """Return letters with a space before each capital that begins a word."""
    out = letters[:1]
    for before, letter, after in zip(letters, letters[1:], [*letters[2:], ""], strict=False):
        begins = letter.isupper() and (before.islower() or after.islower())
        out += f" {letter}" if begins else letter
    return out


def _digest(meshes: Sequence[Mesh], *texts: str) -> str:
    digest = hashlib.sha256(repr(texts).encode())
    for mesh in meshes:
        for array in (mesh.positions, mesh.normals, mesh.triangles, mesh.materials):
            digest.update(f"{array.dtype.str} {array.shape}".encode() + array.tobytes())
        digest.update(repr(mesh.palette).encode())
    return digest.hexdigest()[:12]


_TRIED = np.linspace(0.0, 20.0, 64)
"""Distances at which the farthest place of each part is looked for [m]."""

_MARGIN = 1.5  # Factor on it: parts may go farther in between


class OwnRig:
    """Parts that are posed by a user's function, on the ground and along its slope.

    Attributes:
        slots: As in `Rig`.
        part_count: As in `Rig`.

    Args:
        target: The target.
        path: Its class, as users name it; empty for a mesh file.
    """

    def __init__(self, target: OwnTarget, path: str) -> None:
        self._target, self._path = target, path
        parts = target.parts()
        self._levels = [target.levels] if isinstance(target, Shaped) else [(p,) for p in parts]
        self.slots = self.part_count = len(parts)

    def part_levels(self) -> Sequence[tuple[Mesh, ...]]:
        """Return the meshes, see `Rig`."""
        return self._levels

    def reach(self, parts: NDArray[np.float64]) -> float:
        """Return how far any point may be from the reference point, see `Rig` [m]."""
        still = np.zeros_like(_TRIED)
        poses = self._poses(Ride(_TRIED, still + 1.0, still))
        away = np.linalg.norm(poses[..., 3], axis=-1).max(axis=0)
        return float((_MARGIN * away + parts).max())

    def pose(self, group: Group, actors: ActorState, looks: Looks, out: DrawList) -> None:
        """Write the slots of all actors, see `Rig`."""
        who = group.actor
        shape = actors.yaw[:, who].shape
        numbers = (actors.travelled, actors.speed, actors.yaw_rate)
        local = self._poses(Ride(*(array[:, who].ravel() for array in numbers)))
        local = np.reshape(local, (*shape, self.slots, 3, 4))
        body = _frames(actors.yaw[:, who], actors.slope[:, who])[..., None, :, :]
        poses = exact.product(body, local)
        poses[..., 3] += actors.position[:, who, None]
        present = actors.present[:, who]
        for part in range(self.slots):
            slot = group.slot + part
            out.part[:, slot] = np.where(present, group.first_part + part, -1)
            out.pose[:, slot] = poses[:, :, part]
            out.colour[:, slot] = looks.colour[:, who]

    def _poses(self, ride: Ride) -> NDArray[np.float64]:
        if not self._path:
            return self._target.pose(ride)
        return posed(self._target, self._path, ride, self.slots)


def _frames(yaw: NDArray[np.float64], slope: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return rotations, shape (..., 3, 3): x along the heading and the slope."""
    cosine, sine, rise = exact.cos(yaw), exact.sin(yaw), exact.sin(slope)
    level, none = exact.cos(slope), np.zeros_like(yaw)
    columns = [
        np.stack([cosine * level, sine * level, rise], axis=-1),
        np.stack([-sine, cosine, none], axis=-1),
        np.stack([-cosine * rise, -sine * rise, level], axis=-1),
    ]
    return np.stack(columns, axis=-1)
