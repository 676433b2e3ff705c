"""A map of your own, added without changes to Eyas: a field with a ring road around a hill.

    PYTHONPATH=examples python examples/own_map.py

A map that Python can import needs no registration: `world.map` takes its path, `own_map:FIELD`. To
give it a short name, call `MAPS.register("field", FIELD)` (for one process), or define an entry
point in the group `eyas.maps` (wherever the package is installed). Roads and traffic are made with
SUMO on first use; `eyas traffic record --map own_map:FIELD --canonical` writes them into the map's
package, so that they ship with it.
"""

import math

import gymnasium

from eyas import (
    Hills,
    MapPlan,
    MapRecipe,
    Mound,
    RoadEdge,
    RoadGraph,
    RoadNetwork,
    RoadNode,
    Survey,
    register_map,
)

HILL = Mound(x=0.0, y=0.0, radius=75.0, height=30.0)
CORNERS = 8


def roads(seed: int) -> RoadGraph:
    """Return a ring of two lanes each way; other seeds make it wider."""
    radius = 110.0 + 5.0 * (seed % 5)
    angles = [2 * math.pi * k / CORNERS for k in range(CORNERS)]
    nodes = tuple(
        RoadNode(f"n{k}", round(radius * math.cos(a), 3), round(radius * math.sin(a), 3))
        for k, a in enumerate(angles)
    )
    links = [(f"n{k}", f"n{(k + 1) % CORNERS}") for k in range(CORNERS)]
    both = [pair for a, b in links for pair in ((a, b), (b, a))]
    edges = tuple(RoadEdge(name=f"{a}-{b}", start=a, end=b) for a, b in both)
    return RoadGraph("field", seed, nodes, edges)


def plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the hill; with a survey of nothing else, Eyas adds the road, grass and lamps."""
    return MapPlan(
        name="field",
        seed=seed,
        size=(400.0, 400.0),
        layers=(Hills(mounds=(HILL,), smooth=True),),
        survey=Survey(),
    )


FIELD = MapRecipe(
    name="field",
    title="A field with a hill",
    roads=roads,
    plan=plan,
    without=("night", "snow"),
    package=__package__ or None,
)


def main() -> None:
    """Fly over the field for a second."""
    register_map("own_map:FIELD")
    env = gymnasium.make("eyas/field-day-v0", config={"traffic": {"max_vehicles": 3}})
    observation, _ = env.reset(seed=1)
    for _ in range(125):
        observation, reward, ended, cut, _ = env.step(env.action_space.sample())
        if ended or cut:
            break
    print(f"{observation.shape} pixels, reward {reward:.2f}")


if __name__ == "__main__":
    main()
