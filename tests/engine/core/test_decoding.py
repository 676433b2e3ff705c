"""Content that may come from anyone: numbers, texts, sizes and claims of sizes within limits."""

import gzip
import io
import zipfile

import numpy as np
import pytest
from PIL import Image

from eyas.engine.core.decoding import (
    decoded_arrays,
    decoded_json,
    decoded_picture,
    gunzipped,
    npz_arrays,
    read_json,
)
from eyas.engine.core.errors import DataFileError


def test_numbers_below_2_64_are_read_exactly():
    assert decoded_json(b"[18446744073709549568, -9223372036854775808, 1e19, 0.5]") == [
        18446744073709549568,
        -(2**63),
        1e19,
        0.5,
    ]


@pytest.mark.parametrize(
    "text", ["18446744073709551616", "-18446744073709551616", "1e20", "1E+020", "NaN", "-Infinity"]
)
def test_larger_numbers_and_those_that_are_none_are_refused(text):
    with pytest.raises(ValueError, match="is not allowed"):
        decoded_json(f"[{text}]".encode())


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"\xff", "not a text in UTF-8"),
        (b"[" * 100_000, "nested too deep"),
        (rb'["\ud83d"]', "half a character"),
        (b"[1,]", "line 1 column"),
    ],
)
def test_what_is_no_json_is_told(content, told):
    with pytest.raises(ValueError, match=told):
        decoded_json(content)


def test_a_file_of_json_is_named_with_what_it_should_be(tmp_path):
    file = tmp_path / "plan.json"
    file.write_bytes(b"\xef\xbb\xbf{}")  # with a byte order mark
    assert read_json(file, 10) == {}
    file.write_text("{")
    with pytest.raises(DataFileError, match=r"plan\.json: not a plan: "):
        read_json(file, 10, "a plan")


def test_what_unpacks_stops_at_its_budget():
    packed = gzip.compress(bytes(1 << 20))
    assert len(gunzipped(packed, 1 << 20)) == 1 << 20
    with pytest.raises(ValueError, match="larger than 1 MiB when unpacked"):
        gunzipped(gzip.compress(bytes((1 << 20) + 1)), 1 << 20)
    with pytest.raises(ValueError, match="end-of-stream"):
        gunzipped(packed[:-9], 1 << 20)


def packed(**arrays) -> bytes:
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


def test_arrays_are_read_as_numpy_does_and_are_read_only():
    rows = np.arange(6.0).reshape(2, 3)
    found = npz_arrays(packed(rows=rows, columns=np.asfortranarray(rows)), 1000)
    np.testing.assert_array_equal(found["rows"], rows)
    np.testing.assert_array_equal(found["columns"], rows)
    assert not found["rows"].flags.writeable
    assert npz_arrays(packed(rows=rows, other=rows), 1000, ["other"]).keys() == {"other"}


def test_arrays_larger_than_allowed_or_than_they_are_get_no_memory():
    with pytest.raises(ValueError, match="allowed: 1000 bytes"):
        npz_arrays(packed(zeros=np.zeros(1 << 20)), 1000)
    claim = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": (1 << 40,)}
    np.lib.format.write_array_header_1_0(claim, header)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("huge.npy", claim.getvalue() + bytes(8))
    with pytest.raises(ValueError, match="in 8 bytes"):
        npz_arrays(file.getvalue(), 1000)


def test_objects_are_never_unpickled():
    file = io.BytesIO()
    np.savez(file, evil=np.array([{}], object))
    with pytest.raises(ValueError, match="an array of object"):
        npz_arrays(file.getvalue(), 10_000)


def test_arrays_of_another_kind_or_missing_are_named(tmp_path):
    file = tmp_path / "network.npz"
    file.write_bytes(packed(points=np.zeros((3, 2))))
    found = decoded_arrays(file, 10_000, "a network", {"points": ("f", 2)})
    assert found["points"].shape == (3, 2)
    with pytest.raises(DataFileError, match="not a network: it has no 'lanes'"):
        decoded_arrays(file, 10_000, "a network", {"lanes": ("f", 2)})
    with pytest.raises(DataFileError, match=r"'points' is float64 with shape \(3, 2\)"):
        decoded_arrays(file, 10_000, "a network", {"points": ("i", 2)})


def test_pictures_of_another_size_or_kind_are_refused_before_they_are_decoded(tmp_path):
    file = tmp_path / "mask.png"
    Image.fromarray(np.zeros((4, 6, 3), np.uint8)).save(file)
    assert decoded_picture(file, 1000, (6, 4), 3).shape == (4, 6, 3)
    with pytest.raises(DataFileError, match="has 6x4 pixels, not 4x6"):
        decoded_picture(file, 1000, (4, 6), 3)
    with pytest.raises(DataFileError, match="has 3 colours, not 1"):
        decoded_picture(file, 1000, (6, 4), 1)
    file.write_bytes(b"no picture")
    with pytest.raises(DataFileError, match=r"mask\.png: cannot read: not a picture$"):
        decoded_picture(file, 1000, (6, 4), 3)
