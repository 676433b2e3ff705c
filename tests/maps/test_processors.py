"""A map, and who walks on it, has the same bytes on a processor with other instructions.

The other processor is this one, in a process of its own in which numpy, BLAS and the C library are
told to do without its newer instructions: their sines, logarithms and products of matrices then
differ in the last bits.
"""

import dataclasses
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.sim.assets import _traffic
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.crowd import crowd_of
from eyas.maps.buildings.facades import mesh_of
from eyas.maps.citystreet import CITYSTREET
from eyas.maps.citystreet.layout import lay_out
from eyas.maps.desert import DESERT, DESERT_BARE
from eyas.maps.desert.layout import lay_out as plan_of_dunes
from eyas.maps.plan.build import build_scene
from eyas.maps.plants.shrubs import PLANTS
from eyas.maps.plants.trees import street_tree_levels


def of_the_plan():
    plan = lay_out(CITYSTREET.shipped_network(), 0)
    rng = stream(0, "test")
    plants = [street_tree_levels(rng, 0), *(make(rng) for make in PLANTS.values())]
    return plan, [mesh_of(building) for building in plan.buildings[:20]], plants


def of_the_desert():
    network = DESERT.shipped_network()
    return plan_of_dunes(network, 0), build_scene(DESERT_BARE.plan(network, 0), network)


def of_the_scene():
    network = CITYSTREET.shipped_network()
    return build_scene(CITYSTREET.plan(network, 0), network)


def of_the_people():
    """The ways of pedestrians, and those of the vehicles that they let pass."""
    config = SimConfig(traffic={"signals": "working"})
    # What is drawn takes most of the time in which `load_assets` makes all.
    traffic = _traffic(config.world.map, 0, config.traffic, 1, crowd_of(config))
    table = traffic.motion.sampled().table
    return [np.ascontiguousarray(table[name]) for name in table.dtype.names]


def of_the_processor():
    return [float(value) for value in np.exp(np.linspace(0.0, 9.0, 9999))]


MAKERS = {
    "plan": of_the_plan,
    "desert": of_the_desert,
    "scene": of_the_scene,
    "people": of_the_people,
    "processor": of_the_processor,
}
NEWER = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])


def elsewhere(*names):
    """Return what makers make on the other processor, by their names."""
    other = {
        "NPY_DISABLE_CPU_FEATURES": " ".join(NEWER),
        "OPENBLAS_CORETYPE": "Nehalem",
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F",
    }
    run = subprocess.run(
        [sys.executable, "-W", "ignore", __file__, *names],
        env=os.environ | other,
        capture_output=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr.decode()
    return pickle.loads(run.stdout)


@pytest.fixture(scope="module")
def there():
    """What needs no cache, made in one process."""
    return elsewhere("plan", "desert", "scene", "processor")


def differences(here, there, path=""):
    """Yield where two things differ at all."""
    if dataclasses.is_dataclass(here):
        for field in dataclasses.fields(here):
            name = field.name
            yield from differences(getattr(here, name), getattr(there, name), f"{path}.{name}")
    elif isinstance(here, (list, tuple)) and len(here) == len(there):
        for index, (one, other) in enumerate(zip(here, there, strict=True)):
            yield from differences(one, other, f"{path}[{index}]")
    elif isinstance(here, shapely.Geometry):
        if shapely.to_wkb(here) != shapely.to_wkb(there):
            yield path
    elif isinstance(here, np.ndarray) and here.dtype != object:
        if here.shape != there.shape or here.tobytes() != there.tobytes():
            yield path
    elif isinstance(here, np.ndarray):
        yield from differences(here.tolist(), there.tolist(), path)
    elif here != there:
        yield path


@pytest.mark.slow
@pytest.mark.parametrize("name", ["plan", "desert", "scene"])
def test_a_map_is_the_same_on_another_processor(name, there):
    assert list(differences(MAKERS[name](), there[name])) == []


@pytest.mark.slow
def test_people_walk_the_same_ways_on_another_processor(empty_cache, monkeypatch):
    here = MAKERS["people"]()
    # With nothing in the cache: it would hold what this processor has made.
    monkeypatch.setenv("EYAS_CACHE_DIR", str(empty_cache))
    assert list(differences(here, elsewhere("people")["people"])) == []


@pytest.mark.slow
@pytest.mark.skipif(not NEWER, reason="this processor has no newer instructions to do without")
def test_the_other_processor_computes_other_last_bits(there):
    here, other = np.array(of_the_processor()), np.array(there["processor"])
    assert (here != other).any()
    np.testing.assert_allclose(here, other, rtol=1e-12)


if __name__ == "__main__":
    sys.stdout.buffer.write(pickle.dumps({name: MAKERS[name]() for name in sys.argv[1:]}))
