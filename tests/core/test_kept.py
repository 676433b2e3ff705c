"""What is kept on disk from run to run."""

import numpy as np

from eyas.core.kept import kept


def test_a_thing_is_made_once_and_again_for_other_inputs(tmp_path):
    made = []

    def make():
        made.append(1)
        return {"ground": np.arange(5, dtype=np.float32), "name": "town"}

    first = kept("thing", ("core/rng.py",), (1,), make, tmp_path)
    again = kept("thing", ("core/rng.py",), (1,), make, tmp_path)
    np.testing.assert_array_equal(first["ground"], again["ground"])
    assert again["name"] == "town"
    assert len(made) == 1
    kept("thing", ("core/rng.py",), (2,), make, tmp_path)
    kept("thing", ("core/rng.py", "core/clock.py"), (1,), make, tmp_path)
    assert len(made) == len(list(tmp_path.iterdir())) == 3


def test_a_damaged_file_is_made_anew(tmp_path):
    def thing():
        return kept("thing", ("core",), (), lambda: list(range(1000)), tmp_path)

    whole = thing()
    (file,) = tmp_path.iterdir()
    good = file.read_bytes()
    flipped = bytearray(good)
    flipped[len(good) // 2] ^= 255
    for damaged in (b"", b"no pickle", good[:-7], bytes(flipped)):
        file.write_bytes(damaged)
        assert thing() == whole
        assert file.read_bytes() == good


def test_a_folder_that_cannot_be_written_does_not_matter(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    assert kept("thing", ("core",), (), lambda: 7, blocked / "cache") == 7
