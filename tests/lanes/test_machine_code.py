"""Machine code in files."""

import os

import numpy as np
import pytest

from eyas.lanes import CompiledCall, entry, machine_code
from eyas.lanes.machine_code import MachineCode, code_file, load, read_code, write_code
from eyas.lanes.trusted import made_folder, secured


def double(values):
    for k in range(len(values)):
        values[k] *= 2.0


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return tmp_path


@pytest.fixture
def compiled(monkeypatch):
    """Return the kernels that were compiled."""
    found, before = [], entry._compiled

    def counted(function, *others, **options):
        found.append(function)
        return before(function, *others, **options)

    monkeypatch.setattr(entry, "_compiled", counted)
    return found


def doubled() -> float:
    values = np.ones(1)
    CompiledCall(double)(values)
    return float(values[0])


def test_a_kernel_is_compiled_once_and_its_file_is_found_by_the_next(folder, compiled):
    assert [doubled(), doubled(), len(compiled)] == [2.0, 2.0, 1]
    (file,) = folder.glob("*.eyk")
    assert file.name.startswith("double-")


@pytest.mark.parametrize(
    "damage", [lambda b: b[:-1], lambda b: b[:9] + b"x" + b[10:], lambda b: b""]
)
def test_a_damaged_file_is_made_anew(folder, compiled, damage):
    doubled()
    (file,) = folder.glob("*.eyk")
    content = file.read_bytes()
    file.write_bytes(damage(content))
    assert read_code(file) is None
    assert doubled() == 2.0
    assert len(compiled) == 2
    assert read_code(file) is not None


def test_code_that_needs_what_this_process_lacks_is_made_anew(folder, compiled):
    doubled()
    (file,) = folder.glob("*.eyk")
    code = read_code(file)
    assert load(code._replace(needs=("no_such_function",))) is None
    write_code(file, code._replace(needs=("no_such_function",)))
    assert doubled() == 2.0
    assert len(compiled) == 2


def test_each_kind_of_processor_has_its_own_code(folder, compiled, monkeypatch):
    doubled()
    monkeypatch.setattr(machine_code, "cpu", lambda: machine_code.Cpu("other", "", ""))
    path = code_file(folder, "double", ())
    monkeypatch.undo()
    assert path != code_file(folder, "double", ())


def scaled_by(factor):
    def scale(values):
        values[0] *= factor

    values = np.ones(1)
    CompiledCall(scale)(values)
    return float(values[0])


def test_a_function_with_values_of_another_is_not_kept(folder):
    assert [scaled_by(2.0), scaled_by(3.0)] == [2.0, 3.0]
    assert not list(folder.iterdir())


def test_where_nothing_can_be_written_nothing_fails(tmp_path):
    write_code(tmp_path / "no such folder" / "file", MachineCode("entry", (), b"code"))
    assert read_code(tmp_path / "no such folder" / "file") is None


def test_the_code_of_another_kernel_is_not_run(folder, compiled):
    doubled()
    (file,) = folder.glob("*.eyk")
    other = file.with_name(f"other-{file.name.partition('-')[2]}")
    file.rename(other)
    assert read_code(other) is None
    assert doubled() == 2.0
    assert len(compiled) == 2


def stranger(path):
    os.chown(path, 12345, -1)


def open_to_all(path):
    path.chmod(0o777)


UNSAFE = [
    open_to_all,
    pytest.param(
        stranger,
        marks=pytest.mark.skipif(
            not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root gives files away"
        ),
    ),
]


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="files have no such owners here")
@pytest.mark.parametrize("change", UNSAFE)
@pytest.mark.parametrize("what", ["the file", "its folder"])
def test_code_that_someone_else_may_have_written_is_not_run(folder, compiled, change, what, caplog):
    doubled()
    (file,) = folder.glob("*.eyk")
    change(file if what == "the file" else folder)
    assert read_code(file) is None
    assert doubled() == 2.0
    assert len(compiled) == 2
    assert f"{file}: " in caplog.text
    assert "files are not used; so it is made anew" in caplog.text


def test_what_is_written_can_be_changed_by_its_user_only(folder, compiled):
    before = os.umask(0)
    try:
        made_folder(folder / "kernels" / "deep")
        write_code(folder / "kernels" / "deep" / "double.eyk", MachineCode("double", (), b"code"))
    finally:
        os.umask(before)
    made = [folder / "kernels", *(folder / "kernels").rglob("*")]
    assert [oct(path.stat().st_mode & 0o777) for path in made] == ["0o755", "0o755", "0o644"]
    assert read_code(made[-1]) == MachineCode("double", (), b"code")


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="files have no such owners here")
def test_a_folder_of_one_s_own_is_closed_and_another_s_not_used(tmp_path):
    tmp_path.chmod(0o777)
    assert secured(tmp_path) == ""
    assert tmp_path.stat().st_mode & 0o777 == 0o755
    if os.geteuid() == 0:
        stranger(tmp_path)
        assert "belongs to another user" in secured(tmp_path)
