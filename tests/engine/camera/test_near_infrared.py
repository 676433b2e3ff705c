"""Near infrared: leaves shine, the sky and water are dark, paint is not taken for leaves."""

import numpy as np

from eyas.engine.camera.near_infrared import near_infrared
from eyas.engine.state.scene import ObjectClass

GREEN, BLUE, GREY = (0.08, 0.16, 0.05), (0.05, 0.15, 0.45), (0.2, 0.2, 0.2)
SIZE = 3, 7  # not a multiple of eight lanes


def _shown(colour: tuple[float, float, float], kind: ObjectClass) -> float:
    radiance = np.tile(np.array(colour, np.float32)[:, None, None], (2, 1, 1, 1))
    radiance = np.broadcast_to(radiance, (2, 3, *SIZE)).copy()
    near_infrared(radiance, np.full((2, *SIZE), kind, np.uint8))
    assert (radiance == radiance[0, 0, 0, 0]).all()
    return float(radiance[0, 0, 0, 0])


def test_leaves_and_lawns_are_bright():
    assert _shown(GREEN, ObjectClass.TREE) > 4.0 * GREEN[1]
    assert _shown(GREEN, ObjectClass.GROUND) > 4.0 * GREEN[1]


def test_a_green_car_is_as_bright_as_in_red_light():
    assert _shown(GREEN, ObjectClass.CAR) == np.float32(GREEN[0])


def test_sky_and_water_are_dark():
    assert _shown(BLUE, ObjectClass.SKY) < 0.3 * BLUE[2]
    assert _shown(GREY, ObjectClass.WATER) < 0.3 * GREY[0]
    assert _shown(GREY, ObjectClass.SKY) == np.float32(GREY[0])  # clouds and fog stay
