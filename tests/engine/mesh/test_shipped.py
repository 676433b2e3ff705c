"""Files of shapes: what is damaged is told in a line."""

import shutil

import pytest

from eyas.engine.core.errors import DataFileError
from eyas.engine.mesh import shipped
from eyas.engine.mesh.shipped import Meshes, index_of, read_block
from eyas.engine.targets.shapes import FILE, SHA256, read_index


@pytest.fixture
def copy(tmp_path):
    """A copy of a file that ships."""
    yield shutil.copy(FILE, tmp_path / "copy.eya")
    shipped._opened.cache_clear()


def test_a_file_with_a_wrong_bit_or_cut_off_is_refused(copy):
    content = bytearray(copy.read_bytes())
    content[len(content) // 2] ^= 1
    for damaged in (bytes(content), content[:1000], b""):
        copy.write_bytes(damaged)
        shipped._opened.cache_clear()
        with pytest.raises(DataFileError, match=r"copy\.eya: cannot read: .*; install Eyas again"):
            index_of(copy, SHA256)


def test_another_index_and_another_block_than_the_code_knows_are_refused(copy):
    with pytest.raises(DataFileError, match="damaged; install Eyas again"):
        index_of(copy, 64 * "0")
    block = read_index().kinds[0].shapes.meshes
    assert read_block(copy, block, Meshes).split()
    for other in (block._replace(number=block.number + 2), block._replace(number=9999)):
        with pytest.raises(DataFileError, match="install Eyas again"):
            read_block(copy, other, Meshes)


def test_meshes_may_be_changed_by_who_reads_them():
    """For numba, arrays that cannot be written have another type."""
    (mesh, *_) = read_block(FILE, read_index().kinds[0].shapes.meshes, Meshes).split()[0]
    assert mesh.positions.flags.writeable
