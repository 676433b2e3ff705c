"""Machine code that comes with Eyas: used only where it is that of these sources and processors."""

import lzma
import re
import runpy
import shutil
from pathlib import Path
from types import SimpleNamespace

import llvmlite.binding as llvm
import numpy as np
import pytest

from eyas.gpu.cuda import code as ptx
from eyas.gpu.render import stages as stages_of_cards
from eyas.lanes import CompiledCall, ParallelCall, VariableError, entry, shipped
from eyas.lanes.container import unpacked
from eyas.lanes.identity import code_name
from eyas.lanes.machine_code import SUFFIX
from eyas.lanes.shipped import KernelLibrary

V3 = shipped.LEVELS["x86_64"]

TOOL = runpy.run_path(str(Path(__file__).parents[2] / "tools" / "ship_kernels.py"))


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
    has = SimpleNamespace(features=V3.needs | {"avx512f"}, platform="linux", machine="x86_64")
    monkeypatch.setattr(shipped, "features", lambda: has.features)
    monkeypatch.setattr(shipped.platform, "machine", lambda: has.machine)
    monkeypatch.setattr(shipped, "sys", SimpleNamespace(platform=has.platform))
    for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", shipped.VARIABLE):
        monkeypatch.delenv(name, raising=False)
    shipped._shipped.cache_clear()
    yield has
    shipped._shipped.cache_clear()


@pytest.fixture
def codes(tmp_path, monkeypatch, compiled, machine):
    """Return the machine code of `double`, by name; nothing is cached, and nothing ships."""
    cache = tmp_path / "cache"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(cache))
    monkeypatch.setattr(shipped, "FOLDER", tmp_path)
    cache.mkdir()
    doubled()
    made = TOOL["codes_in"](cache.glob(f"*{SUFFIX}"))
    for file in cache.iterdir():
        file.unlink()
    compiled.clear()
    return made


@pytest.fixture
def ships(tmp_path, monkeypatch, codes):
    """Return a library in which the code of `double` ships."""
    TOOL["link"](codes, V3.library)
    shipped._shipped.cache_clear()
    return V3.library


def test_shipped_code_is_used_and_nothing_is_compiled_or_cached(ships, compiled, tmp_path):
    assert doubled() == 2.0
    assert not compiled
    assert not list((tmp_path / "cache").iterdir())
    assert shipped.is_shipped(code_name(double))
    assert not shipped.is_shipped(code_name(doubled))


def test_code_of_another_language_of_kernels_is_passed_over(ships, compiled, monkeypatch):
    monkeypatch.setattr(shipped, "language_hash", lambda: "0123456789abcdef")
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_code_for_other_bundles_is_passed_over(ships, compiled):
    assert doubled(np.float32) == 2.0
    assert len(compiled) == 1


@pytest.mark.parametrize("content", [b"", b"no library", b"\x7fELF\x02" + 99 * b"x"])
def test_a_damaged_library_is_told_and_kernels_are_compiled(ships, compiled, caplog, content):
    ships.unlink()  # its own content stays mapped
    ships.write_bytes(content)
    assert doubled() == 2.0
    assert len(compiled) == 1
    assert len(caplog.records) == 1


def test_a_library_of_others_is_told_and_kernels_are_compiled(ships, compiled, caplog, monkeypatch):
    shutil.copy(next(Path("/lib").rglob("libm.so.6")), ships)
    assert doubled() == 2.0
    assert [len(compiled), len(caplog.records)] == [1, 1]


def test_on_a_processor_that_lacks_something_kernels_are_compiled(ships, compiled, machine):
    machine.features = V3.needs - {"fma"}
    assert doubled() == 2.0
    assert len(compiled) == 1


def test_what_draws_has_code_of_its_own_where_there_is_avx_512(
    ships, codes, monkeypatch, machine, tmp_path
):
    (name,) = codes
    wide = shipped.WIDE.library
    TOOL["link"](codes, wide)
    usual = shipped.shipped_address(name)
    machine.features = V3.needs | shipped.WIDE.needs
    shipped._shipped.cache_clear()
    assert shipped.shipped_address(name) == KernelLibrary.opened(wide).address(name) != usual
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "other")  # a library that was opened stays
    V3.library.parent.mkdir()
    TOOL["link"](codes, V3.library)
    shipped._shipped.cache_clear()
    assert shipped.shipped_address(name) == KernelLibrary.opened(V3.library).address(name)


def test_all_that_draws_ships_for_avx_512():
    names = {name for name in KernelLibrary.opened(V3.library).names if TOOL["draws"](name)}
    assert names
    assert KernelLibrary.opened(shipped.WIDE.library).names == names


def test_aarch_64_has_the_kernels_of_x86_64():
    content = shipped.LEVELS["aarch64"].library.read_bytes()
    library = KernelLibrary.opened(V3.library)
    assert "\n".join([library.language, *sorted(library.names)]).encode() in content


def test_on_other_machines_kernels_are_compiled(ships, compiled, machine):
    machine.machine = "riscv64"
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


def test_a_library_is_the_same_bytes_whatever_the_order(codes, tmp_path):
    ((name, double),) = codes.items()
    half = double._replace(code=bytes(double.code).replace(b"double_", b"halved_"))
    codes = {name: double, name.replace("double-", "halved-"): half}
    for file, some in (("a.so", codes), ("b.so", dict(reversed(codes.items())))):
        TOOL["link"](some, tmp_path / file)
    assert (tmp_path / "a.so").read_bytes() == (tmp_path / "b.so").read_bytes()
    assert KernelLibrary.opened(tmp_path / "a.so").names == codes.keys()


def test_what_a_library_calls_outside_is_refused_when_it_is_made(codes, tmp_path):
    code = llvm.parse_assembly(
        "declare void @outside() define void @e() { call void @outside() ret void }"
    )
    target = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(reloc="pic")
    outside = next(iter(codes.values()))._replace(code=target.emit_object(code))
    with pytest.raises(SystemExit, match=r"none\.so: calls outside outside"):
        TOOL["link"]({"e": outside}, tmp_path / "none.so")
    assert not (tmp_path / "none.so").exists()


def test_what_a_card_draws_with_ships():
    (_, table), _ = unpacked(lzma.decompress(ptx.ARCHIVE.read_bytes()))
    ships = [name.partition("-")[0].strip("_") for name, _ in table]
    stages = [one for one in vars(stages_of_cards).values() if isinstance(one, ParallelCall)]
    filters = {"filter_rows", "filter_columns"}
    assert sum(name.startswith("each_view") for name in ships) == len(stages) - len(filters) == 7
    assert {*filters, "list_actors", "stack_pictures", "command_numbers"} <= set(ships)


def test_machine_code_names_no_file_of_the_machine_that_made_it():
    """numba would put the path of a file beside each exception that may be raised in it."""
    codes = [library.read_bytes() for library in shipped.FOLDER.glob("*.so")]
    assert len(codes) == 3
    codes += map(bytes, unpacked(lzma.decompress(ptx.ARCHIVE.read_bytes())).pieces)
    assert len(codes) > 20
    assert not {name for code in codes for name in re.findall(rb"[\w./-]*/[\w.-]+\.py\b", code)}


@pytest.mark.parametrize("named", ["x", "+avx2,sse", ",", "+", "+" * 3000])
def test_features_of_which_llvm_would_end_the_process_are_refused(monkeypatch, named):
    monkeypatch.setenv("NUMBA_CPU_FEATURES", named)
    shipped._shipped.cache_clear()
    with pytest.raises(VariableError, match=r"^NUMBA_CPU_FEATURES: '"):
        shipped._shipped()
