import numpy as np
import pytest

from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_of
from eyas.engine.targets.kind import Kind, Model


class WalkerRig:
    """So many parts one on the other, each a triangle."""

    def __init__(self, parts: int) -> None:
        self.slots = self.part_count = parts

    def part_levels(self):
        corners = np.eye(3, dtype=np.float32)
        mesh = Mesh(
            corners, corners, corners[:, :2], np.array([[0, 1, 2]], np.int32),
            np.zeros(1, np.int32), (Material(),),
        )  # fmt: skip
        return [(mesh,)] * self.part_count

    def reach(self, parts):
        return parts.max() + self.slots

    def pose(self, group, actors, looks, out):
        for actor, first in zip(group.actor, group.slot, strict=True):
            for k in range(self.slots):
                present = actors.present[:, actor]
                out.part[:, first + k] = np.where(present, group.first_part + k, -1)
                out.pose[:, first + k] = np.eye(3, 4)
                out.pose[:, first + k, :, 3] = actors.position[:, actor] + [0.0, 0.0, k]
                out.colour[:, first + k] = looks.colour[:, actor]


@pytest.fixture
def walker():
    """A kind that a test may register; it is gone after the test."""
    kinds, models = len(KINDS), len(MODELS)
    yield walker_of(2)
    del KINDS[kinds:], MODELS[models:]
    kind_of.cache_clear()


def walker_of(parts: int, name: str = "walker") -> Kind:
    return Kind(
        name=name,
        models=(
            Model(
                name=f"{name} of {parts} parts",
                typename="Pedestrian",
                kind=name,
                size=(0.5, 0.5, 1.75),
                rise=0.0,
                words=(f"a {{}} {name}",),
                motion="stands",
                speed=0.0,
                stride=1.0,
            ),
        ),
        colours=((0.2, 0.3, 0.4), (0.5, 0.1, 0.1)),
        object_class=ObjectClass.PERSON,
        rig=lambda: WalkerRig(parts),
    )
