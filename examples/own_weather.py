"""A weather of your own, added without changes to Eyas: haze that glows in the sun.

    PYTHONPATH=examples python examples/own_weather.py

A weather that Python can import needs no registration: `world.weather` takes its path,
`own_weather:HAZE`. To give it a short name, call `WEATHERS.register("haze", HAZE)` (for one
process), or define an entry point in the group `eyas.weathers` (wherever the package is installed);
it then has environments like `eyas/lake-haze-v0`, on all maps. Each map adds what is special about
it: lamps that burn by day in the farmland, dust in the desert.
"""

from dataclasses import replace

import gymnasium

import eyas  # noqa: F401  # registers the environments
from eyas import CLEAR_DAY, DAY

HAZE = replace(
    DAY,  # a summer's day, whose hours after sunset are those of a clear night
    name="haze",
    day=replace(
        CLEAR_DAY,
        sun_colour=(0.78, 0.68, 0.50),
        zenith_colour=(0.20, 0.27, 0.40),
        horizon_colour=(0.86, 0.78, 0.64),
        ambient_up=(0.40, 0.40, 0.40),
        fog_colour=(0.78, 0.71, 0.59),
        fog_density=1.0 / 450.0,
        foggy=True,  # so `light.visibility` may change it
        clouds=0.1,
    ),
)


def main() -> None:
    """Fly through haze on a summer evening for a second."""
    env = gymnasium.make(
        "eyas/citystreet-day-v0", weather="own_weather:HAZE", config={"world": {"hour": 18.5}}
    )
    observation, _ = env.reset(seed=1)
    for _ in range(125):
        observation, reward, ended, cut, _ = env.step(env.action_space.sample())
        if ended or cut:
            break
    print(f"mean of the last picture {observation.mean():.0f}, reward {reward:.2f}")


if __name__ == "__main__":
    main()
