"""Road networks on disk."""

from dataclasses import fields

import numpy as np
import pytest

from eyas.engine.core.errors import DataFileError
from eyas.engine.world.roads.network_file import load_network, save_network
from eyas.maps.citystreet import CITYSTREET


def test_a_network_comes_back_as_it_was(tmp_path):
    network = CITYSTREET.shipped_network()
    save_network(tmp_path / "roads.npz", network)
    loaded = load_network(tmp_path / "roads.npz")
    for field in fields(network):
        before, after = getattr(network, field.name), getattr(loaded, field.name)
        assert type(before) is type(after)
        assert np.array_equal(before, after)
        assert getattr(before, "dtype", None) == getattr(after, "dtype", None)


def test_the_same_network_gives_the_same_bytes(tmp_path):
    network = CITYSTREET.shipped_network()
    for name in ("a.npz", "b.npz"):
        save_network(tmp_path / name, network)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


@pytest.mark.parametrize("damage", ["missing", "empty", "cut", "other"])
def test_what_cannot_be_read_is_told_in_one_line(tmp_path, damage):
    path = tmp_path / "roads.npz"
    save_network(path, CITYSTREET.shipped_network())
    whole = path.read_bytes()
    match damage:
        case "missing":
            path.unlink()
        case "empty":
            path.write_bytes(b"")
        case "cut":
            path.write_bytes(whole[: len(whole) // 2])
        case "other":
            np.savez(path, something=np.zeros(3))
    with pytest.raises(DataFileError, match=r"roads\.npz") as caught:
        load_network(path)
    assert "\n" not in str(caught.value)
