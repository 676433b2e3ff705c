"""Draw docs/images/air.jpg: smoke, spray, birds and a drone on citystreet.

python tools/air_sheet.py
"""

from pathlib import Path

import numpy as np
from PIL import Image
from weather_sheet import rotation

from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.catalogue import KINDS

SIZE = (240, 320)
WIND = {"speed": 5.0, "direction": 0.4}


def started(**settings: object) -> Simulation:
    """Return a simulation of one tracker."""
    config = SimConfig(camera={"samples": 4}, **settings)
    simulation = build_simulation(config, each_alone(1))
    simulation.reset()
    return simulation


def seen(simulation: Simulation, eye: np.ndarray, yaw: float, pitch: float) -> np.ndarray:
    """Return what is seen from a place [m]."""
    cameras = simulation.snapshot.cameras
    first = {name: getattr(cameras, name)[:1].copy() for name in cameras._fields}
    first |= {"position": eye[None], "rotation": rotation(yaw, pitch)[None]}
    first["field_of_view"] = np.array([1.1])
    picture = Picture.create(1, *SIZE)
    simulation.view.pictures.draw_from(np.zeros(1, np.int32), CameraState(**first), picture, None)
    return picture.rgb[0]


def around(simulation: Simulation, name: str, which: int) -> np.ndarray:
    """Return the place of an actor of a kind [m], which is there."""
    state = simulation.view.actors(0).state
    kinds = np.array([KINDS[k].name for k in simulation.traffic.motion.kind.tolist()])
    return state.position[0, np.flatnonzero((kinds == name) & state.present[0])[which]]


def behind_the_fastest(simulation: Simulation) -> np.ndarray:
    """Return what is seen behind the fastest vehicle."""
    state = simulation.view.actors(0).state
    actor = int(np.argmax(state.speed[0] * state.present[0]))
    yaw = float(state.yaw[0, actor])
    turned = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    eye = state.position[0, actor] + [*(turned @ [-13.0, 3.0]), 5.5]
    return seen(simulation, eye, yaw - 0.2, 0.33)


def main() -> None:
    """Draw the four pictures side by side."""
    air = started(airborne={"birds": 60, "drones": 8}, world={"wind": WIND, "smoke": 4})
    # The second chimney of the standard map, from the street before it.
    smoke = seen(air, np.array([30.0, 80.0, 24.0]), 0.45, 0.12)
    birds = seen(air, around(air, "bird", 2) + np.array([-9.0, -3.0, 3.0]), 0.3, 0.25)
    drone = seen(air, around(air, "Quadrotor", 1) + np.array([-2.2, -0.5, 1.0]), 0.22, 0.4)
    spray = behind_the_fastest(started(world={"wind": WIND, "weather": "rain", "spray": True}))
    sheet = np.concatenate([np.concatenate([smoke, spray], 1), np.concatenate([birds, drone], 1)])
    Image.fromarray(sheet).save(Path("docs/images/air.jpg"), quality=85, optimize=True)


if __name__ == "__main__":
    main()
