"""Machine code that comes with Eyas: used only where it is that of these sources and processors."""

import lzma
import re
from types import SimpleNamespace

import llvmlite.binding as llvm
import numpy as np
import pytest

from eyas.gpu.cuda import code
from eyas.gpu.render import stages as stages_of_cards
from eyas.lanes import CompiledCall, ParallelCall, VariableError, entry, shipped
from eyas.lanes.container import unpacked
from eyas.lanes.machine_code import SUFFIX, MachineCode, read_code
from eyas.lanes.shipped import archive_of, read_archive

CODE = {"double-a-b": MachineCode("double_a_b", ("memcpy",), b"code")}


def double(values):
    for k in range(len(values)):
        values[k] *= 2.0


def doubled(dtype=np.float64) -> float:
    values = np.ones(1, dtype)
    CompiledCall(double)(values)
    return float(values[0])


@pytest.fixture
def compiled(monkeypatch):
    """Return the kernels that were compiled."""
    found, before = [], entry._compiled

    def counted(function, *others, **options):
        found.append(function)
        return before(function, *others, **options)

    monkeypatch.setattr(entry, "_compiled", counted)
    return found


@pytest.fixture
def machine(monkeypatch):
    """A machine whose processor can be changed; it does run the code of the real one."""
    has = SimpleNamespace(features=shipped.needed | {"avx512f"}, platform="linux", machine="x86_64")
    monkeypatch.setattr(shipped, "features", lambda: has.features)
    monkeypatch.setattr(shipped.platform, "machine", lambda: has.machine)
    monkeypatch.setattr(shipped, "sys", SimpleNamespace(platform=has.platform))
    for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", shipped.VARIABLE):
        monkeypatch.delenv(name, raising=False)
    shipped._shipped.cache_clear()
    yield has
    shipped._shipped.cache_clear()


@pytest.fixture
def ships(tmp_path, monkeypatch, compiled, machine):
    """Return an archive in which the code of `double` is shipped; nothing is cached."""
    cache, archive = tmp_path / "cache", tmp_path / "shipped.eyk"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    monkeypatch.setattr(shipped, "ARCHIVE", archive)
    cache.mkdir()
    doubled()
    (file,) = cache.glob(f"*{SUFFIX}")
    archive.write_bytes(archive_of({file.stem.rpartition("-")[0]: read_code(file)}))
    for file in cache.iterdir():
        file.unlink()
    compiled.clear()
    shipped._shipped.cache_clear()
    return archive


def test_shipped_code_is_used_and_nothing_is_compiled_or_cached(ships, compiled, tmp_path):
    assert doubled() == 2.0
    assert not compiled
    assert not list((tmp_path / "cache").iterdir())
    assert not entry.nothing_compiled(double)
    assert entry.nothing_compiled(doubled)


def test_code_of_another_language_of_kernels_is_passed_over(ships, compiled, monkeypatch):
    with monkeypatch.context() as other:
        other.setattr(shipped, "language_hash", lambda: "0123456789abcdef")
        ships.write_bytes(archive_of(read_archive(ships) or CODE))
        assert read_archive(ships)
    assert read_archive(ships) == {}
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_code_for_other_bundles_is_passed_over(ships, compiled):
    assert doubled(np.float32) == 2.0
    assert len(compiled) == 1


@pytest.mark.parametrize("damage", [lambda b: b[:-1], lambda b: b[:9] + b"x" + b[10:]])
def test_a_damaged_archive_is_told_and_kernels_are_compiled(ships, compiled, caplog, damage):
    ships.write_bytes(damage(ships.read_bytes()))
    assert doubled() == 2.0
    assert len(compiled) == 1
    assert len(caplog.records) == 1


def test_code_that_this_llvm_cannot_link_is_compiled_anew(ships, compiled):
    ((name, code),) = read_archive(ships).items()
    ships.write_bytes(archive_of({name: code._replace(code=b"no object file")}))
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_on_a_processor_that_lacks_something_kernels_are_compiled(ships, compiled, machine):
    machine.features = shipped.needed - {"fma"}
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_what_draws_has_code_of_its_own_where_there_is_avx_512(
    ships, monkeypatch, machine, tmp_path
):
    ((name, code),) = read_archive(ships).items()
    wide = tmp_path / "wide.eyk"
    wide.write_bytes(archive_of({name: code._replace(needs=("memcpy",))}))
    monkeypatch.setattr(shipped, "WIDE_ARCHIVE", wide)
    assert shipped.shipped_code(name).needs == code.needs
    machine.features = shipped.wide_needed
    shipped._shipped.cache_clear()
    assert shipped.shipped_code(name).needs == ("memcpy",)
    wide.unlink()
    shipped._shipped.cache_clear()
    assert shipped.shipped_code(name).needs == code.needs


def names_in(archive) -> set[str]:
    """Return what an archive holds, though it may be older than the language of kernels."""
    (_, table), _ = unpacked(archive.read_bytes())
    return {name for name, *_ in table}


def test_all_that_draws_ships_for_avx_512():
    names = {name for name in names_in(shipped.ARCHIVE) if name.startswith("draw_views-")}
    assert names
    assert names_in(shipped.WIDE_ARCHIVE) == names


def test_on_other_machines_kernels_are_compiled(ships, compiled, machine):
    machine.machine = "aarch64"
    assert doubled() == 2.0
    assert len(compiled) == 1


@pytest.mark.parametrize(
    ("variable", "value"),
    [("NUMBA_CPU_NAME", ""), ("NUMBA_CPU_FEATURES", ""), (shipped.VARIABLE, "0")],
)
def test_who_names_a_processor_or_wants_none_gets_no_shipped_code(
    ships, compiled, monkeypatch, variable, value
):
    assert shipped._shipped()
    monkeypatch.setenv(variable, value)
    shipped._shipped.cache_clear()
    assert not shipped._shipped()


def test_an_archive_is_the_same_bytes_whatever_the_order():
    other = CODE["double-a-b"]._replace(code=b"other")
    codes = CODE | {"half-a-b": other}
    assert archive_of(codes) == archive_of(dict(reversed(codes.items())))


def test_what_a_card_draws_with_ships():
    (_, table), _ = unpacked(lzma.decompress(code.ARCHIVE.read_bytes()))
    ships = [name.partition("-")[0].strip("_") for name, _ in table]
    stages = [one for one in vars(stages_of_cards).values() if isinstance(one, ParallelCall)]
    assert sum(name.startswith("each_view") for name in ships) == len(stages) == 7
    assert {"list_actors", "stack_pictures", "command_numbers"} <= set(ships)


def test_machine_code_names_no_file_of_the_machine_that_made_it():
    """numba would put the path of a file beside each exception that may be raised in it."""
    folder = shipped.ARCHIVE.parent
    archives = (shipped.ARCHIVE, shipped.WIDE_ARCHIVE)
    codes = [bytes(piece) for one in archives for piece in unpacked(one.read_bytes()).pieces]
    for packed in (*folder.glob("*.xz"), *folder.glob("*.eyp")):
        _, pieces = unpacked(lzma.decompress(packed.read_bytes()))
        bitcode = packed.suffix == ".xz"
        codes += [
            str(llvm.parse_bitcode(bytes(p))).encode() if bitcode else bytes(p) for p in pieces
        ]
    assert len(codes) > 100
    assert not {name for code in codes for name in re.findall(rb"[\w./-]*/[\w.-]+\.py\b", code)}


@pytest.mark.parametrize("named", ["x", "+avx2,sse", ",", "+", "+" * 3000])
def test_features_of_which_llvm_would_end_the_process_are_refused(monkeypatch, named):
    monkeypatch.setenv("NUMBA_CPU_FEATURES", named)
    shipped._shipped.cache_clear()
    with pytest.raises(VariableError, match=r"^NUMBA_CPU_FEATURES: '"):
        shipped._shipped()
