"""A card of NVIDIA as a device, tried without one: its driver is `driver.c`, whose memory is this
processor's, so that kernels compiled for this processor can run on what was put there.
"""

import ctypes
import gc
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from eyas.gpu.cuda import CudaDevice, CudaError, code, cuda_device, device, gpu_line
from eyas.gpu.cuda.code import Ptx, archive_of
from eyas.gpu.cuda.device import function_of
from eyas.gpu.cuda.driver import VARIABLE, driver
from eyas.gpu.cuda.memory import capsule_of
from eyas.lanes import PackedBundle, parallel
from eyas.lanes.calls import _ENTRY
from eyas.lanes.device import HostDevice
from eyas.lanes.entry import entry_address
from eyas.lanes.trusted import read_trusted, write_trusted

DRIVER = Path(__file__).parents[2] / "tools" / "emulated_card" / "driver.c"


class Inner(NamedTuple):
    share: float
    values: np.ndarray
    small: np.int8
    pair: tuple[bool, np.float32]


class Outer(NamedTuple):
    flag: bool
    inner: Inner
    count: np.int32
    empty: np.ndarray
    plane: np.ndarray
    found: np.ndarray


@parallel
def add(worker, workers, outer, factor, offsets):
    inner = outer.inner
    for i in range(worker, outer.count, workers):
        sums = inner.values[i] * inner.share + inner.small + inner.pair[1] + outer.empty.shape[0]
        outer.found[i] = factor * (sums + outer.plane[i, 1]) + offsets[i] + outer.flag


def outer_of(device, values):
    plane = np.arange(24, dtype=np.float32).reshape(6, 4)[:, 1:3]  # not contiguous
    plane.flags.writeable = False
    inner = Inner(0.5, values, np.int8(-3), (True, np.float32(0.25)))
    return Outer(True, inner, np.int32(6), np.zeros((0, 2)), plane, device.zeros(6, np.float64))


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    path = tmp_path_factory.mktemp("cuda") / "libcuda.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", path, DRIVER], check=True)
    return path


class Fake:
    """The driver's own side."""

    def __init__(self, path):
        self.path, self.library = path, ctypes.CDLL(path)
        self.library.fake_told.restype = ctypes.c_char_p
        self.library.fake_memory.argtypes = [ctypes.c_size_t]
        self.library.card_owns.argtypes = [ctypes.c_uint64, ctypes.c_size_t]
        self._kernel = None

    def told(self, name=""):
        """Return what was called since the last time, of one function or of all."""
        lines = self.library.fake_told().decode().splitlines()
        self.library.fake_forget()
        return [line for line in lines if line.startswith(name)]

    def runs(self, call, *bundles):
        """Have launches run a kernel as compiled for this processor."""
        held = tuple(
            bundle if isinstance(bundle, PackedBundle) else PackedBundle(bundle)
            for bundle in bundles
        )
        entry = _ENTRY(entry_address(call.function, held, over_workers=True))

        def run(_, parts, first, workers):
            for worker in range(first, workers):
                assert entry(parts, worker, workers) == 0

        number = ctypes.c_uint64
        self._kernel = ctypes.CFUNCTYPE(None, ctypes.c_char_p, number, number, number)(run)
        self.library.fake_kernel(self._kernel)

    def fails(self, name, error):
        self.library.fake_fail(name.encode(), error)

    def owns(self, address, size):
        return bool(self.library.card_owns(address, size))

    @property
    def pieces(self):
        return self.library.fake_pieces()


@pytest.fixture
def fake(library, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(library))
    monkeypatch.setattr(device, "_devices", {})
    driver.cache_clear()
    fake = Fake(library)
    fake.told()
    yield fake
    assert fake.library.fake_depth() == 0  # the context of others is current again
    fake.library.fake_kernel(None)
    fake.fails("", 0)
    fake.library.fake_cards(1, 9)
    fake.library.fake_memory(1 << 30)
    driver.cache_clear()


@pytest.fixture
def card(fake):
    return CudaDevice()


@pytest.mark.parametrize("kind", ["?", "u1", "i4", "f4", "f8", [("a", "i4"), ("b", "f8")]])
def test_arrays_come_back_as_they_went(card, kind):
    values = np.arange(30).reshape(10, 3).astype(np.dtype(kind))
    array = card.upload(values.T[::-1].T)
    np.testing.assert_array_equal(card.read(array), values[:, ::-1])
    assert (array.shape, array.dtype, array.nbytes) == (values.shape, values.dtype, values.nbytes)
    card.write(array, values[:2], 4)
    rows = array[3:6]
    np.testing.assert_array_equal(card.read(rows)[1:], values[:2])
    assert (len(rows), rows.address) == (3, array.address + 3 * array.strides[0])
    np.testing.assert_array_equal(card.read(rows.reshape(-1)), card.read(rows).ravel())
    card.clear(rows)
    assert not card.read(rows).tobytes().strip(b"\0")
    assert card.read(array)[2] == pytest.approx(values[2, ::-1]) if kind == "f8" else True
    assert card.read(card.upload(values[:0])).shape == (0, 3)
    assert card.read(card.zeros(4, kind)).tobytes() == bytes(4 * values.itemsize)


def test_numbers_are_written_as_numpy_would_and_shapes_must_fit(card):
    array = card.zeros((4, 2), np.float32)
    card.write(array, np.arange(4).reshape(2, 2), 2)
    np.testing.assert_array_equal(card.read(array)[2:], [[0, 1], [2, 3]])
    for values, first in ((np.zeros((2, 3)), 0), (np.zeros((2, 2)), 3)):
        with pytest.raises(ValueError, match="cannot write"):
            card.write(array, values, first)
    with pytest.raises(TypeError, match="rows only"):
        array[0]
    with pytest.raises(TypeError, match=r"device\.read\(array\)"):
        np.asarray(array)
    with pytest.raises(TypeError, match="objects"):
        card.empty(3, object)


def test_memory_goes_back_with_its_last_reference(fake, card):
    before = fake.pieces
    array = card.zeros((8, 8), np.float64)
    rows = array[2:4].reshape(16)
    del array
    assert fake.pieces == before + 1
    del rows
    assert fake.pieces == before


def test_what_comes_from_numpy_is_uploaded_once_and_kept_as_long_as_it_is_used(fake, card):
    before = fake.pieces
    values, more = np.ones(1000), np.ones(2000)
    first = card.held((1, values))
    assert fake.told("cuMemcpyHtoD") == ["cuMemcpyHtoD 8000", "cuMemcpyHtoD 64"]
    second = card.held((2, values, more))
    assert fake.told("cuMemcpyHtoD") == ["cuMemcpyHtoD 16000", "cuMemcpyHtoD 120"]
    assert fake.pieces == before + 3  # two arrays, and memory for bundles
    del values
    assert fake.pieces == before + 3  # the bundles use them
    del first, second
    assert fake.pieces == before + 2
    del more
    assert fake.pieces == before + 1


def test_another_array_in_the_place_of_one_is_not_taken_for_it(card):
    for number in range(20):
        bundle = card.held((np.full(50, float(number)),))
        assert card.read(bundle.bundle[0])[0] == number


def test_memory_of_bundles_is_used_again(fake, card):
    addresses = {card.held((number, float(number))).address for number in range(100)}
    assert len(addresses) == 1
    kept = [card.held((number,)) for number in range(5000)]
    assert len({bundle.address for bundle in kept}) == 5000
    assert len(fake.told("cuMemAlloc 1048576")) == 2


def test_a_bundle_lies_there_as_it_does_here_but_for_addresses(fake, card):
    there = card.held(outer_of(card, np.arange(6.0)))
    plain = outer_of(HostDevice(), np.arange(6.0))
    empty = np.ndarray((0, 2), np.float64, bytearray())  # strides as on the card, in any numpy
    plain = plain._replace(plane=plain.plane.copy(), empty=empty)
    here = PackedBundle(plain)
    content = ctypes.string_at(here.address, here.size)
    for name in ("inner", "empty", "plane", "found"):
        found, known = getattr(there.bundle, name), getattr(plain, name)
        if name == "inner":
            found, known = found.values, known.values
        old = PackedBundle((known,))
        address = ctypes.string_at(old.address + 32, 8)  # after two words, size and size of one
        assert content.count(address) == 1
        content = content.replace(address, found.address.to_bytes(8, "little"))
        assert fake.owns(found.address, max(found.nbytes, 4096 if name == "empty" else 0))
    assert ctypes.string_at(there.address, here.size) == content
    assert there.kind == here.kind
    assert fake.owns(there.address, here.size)


def test_kernels_find_all_of_nested_bundles_numbers_and_arrays(fake, card):
    values, offsets = np.linspace(0.0, 1.0, 6), np.arange(6.0)[::-1]
    host = HostDevice()
    expected = outer_of(host, values)
    host.launch(add, 1, *map(host.held, (expected, 2.0, offsets)))
    plain = expected._replace(plane=expected.plane.copy())
    fake.runs(add, plain, 2.0, offsets.copy())
    bundle = outer_of(card, values)
    card.launch(add, 4, *map(card.held, (bundle, 2.0, offsets)))
    assert expected.found.all()
    np.testing.assert_array_equal(card.read(bundle.found), expected.found)


@parallel
def nothing(worker, workers, number):
    pass


@pytest.mark.parametrize(
    ("workers", "options", "grid", "block"),
    [
        (1, {}, 1, 128),
        (128, {}, 1, 128),
        (129, {}, 2, 128),
        (33, {"threads": 8}, 9, 32),
        (100_000, {"threads": 8, "block": 256}, 3125, 256),
    ],
)
def test_threads_are_enough_for_all_workers(fake, card, workers, options, grid, block):
    card.launch(nothing, workers, card.held(1), **options)
    assert fake.told("cuLaunchKernel") == [
        f"cuLaunchKernel grid {grid} 1 1 block {block} 1 1 shared 0 stream (nil) workers {workers}"
    ]


def test_no_workers_are_no_launch_and_blocks_are_whole_warps(fake, card):
    card.launch(nothing, 0, card.held(1))
    assert not fake.told("cuLaunch")
    with pytest.raises(ValueError, match="a block of 100 threads; allowed: multiples of 32"):
        card.launch(nothing, 1, card.held(1), block=100)


def test_a_kernel_is_compiled_once_for_the_kinds_of_its_bundles(fake, card):
    for number in (1, 2, 3.0, np.float32(4.0), 5.0):
        card.launch(nothing, 1, card.held(number))
    card.launch(nothing, 1, card.held(1), threads=8)
    card.launch(parallel(nothing.function), 1, card.held(1))
    assert len(fake.told("cuModuleLoad")) == 4
    handles = [card.function(nothing, card.held(1), threads=n).handle.value for n in (8, 1)]
    assert len(set(handles)) == 2
    assert card.function(nothing, card.held(1)).registers == 40


def test_a_launch_that_is_repeated_uploads_nothing(fake, card):
    bundles = card.held(outer_of(card, np.arange(6.0))), card.held(2.0), card.held(np.zeros(6))
    card.launch(add, 1, *bundles)
    fake.told()
    card.launch(add, 2, *bundles)
    assert len(fake.told()) == 1


def test_kernels_that_differ_by_what_they_close_over_are_not_mixed_up(fake, card):
    def adding(amount):
        @parallel
        def write(worker, workers, found):
            found[0] = amount

        return write

    for amount in (1.0, 2.0):
        card.launch(adding(amount), 1, card.held(card.zeros(1, np.float64)))
    entries = {line.split()[1] for line in fake.told("cuModuleGetFunction")}
    assert len(entries) == 1
    assert len(card._functions._loaded) == 2


def test_ptx_is_kept_and_found_again_in_the_folder_or_in_what_ships(
    fake, card, tmp_path, monkeypatch
):
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path))
    held = card.held(1)
    card.launch(nothing, 1, held)
    (path,) = tmp_path.rglob("*.eyp")
    kept = read_trusted(path)
    text = bytes(kept.pieces[0])
    assert text.decode().count(f".entry {kept.header}(") == 1
    assert b".target sm_80" in text

    def launched():
        other = CudaDevice()
        other.launch(nothing, 1, other.held(1))
        return {line.split()[1] for line in fake.told("cuModuleGetFunction")}

    fake.told()
    write_trusted(path, "other", [text.replace(kept.header.encode(), b"other")])
    assert launched() == {"other"}
    path.unlink()
    ships = tmp_path / "ships.eyp"
    monkeypatch.setattr(code, "ARCHIVE", ships)
    ptx = Ptx("shipped", text.replace(kept.header.encode(), b"shipped"))
    for made_of, entry in (("another language", kept.header), (None, "shipped")):
        code._shipped.cache_clear()
        path.unlink(missing_ok=True)
        with monkeypatch.context() as patch:
            if made_of:
                patch.setattr(code, "_made_of", lambda made_of=made_of: made_of)
            ships.write_bytes(archive_of({path.stem.rpartition("-")[0]: ptx}))
        assert launched() == {entry}
    code._shipped.cache_clear()


def test_errors_say_what_was_attempted_and_what_the_driver_says(fake, card):
    held = card.held(1)
    card.launch(nothing, 1, held)
    illegal = "error 700, CUDA_ERROR_ILLEGAL_ADDRESS: an illegal memory access was encountered: .*"
    array = card.zeros(3, np.float64)
    for function, work, text in (
        ("cuLaunchKernel", lambda: card.launch(nothing, 3, held), "launching nothing for 3 w.*"),
        ("cuStreamSynchronize", card.synchronise, "waiting for Fake 40, whose last .* nothing"),
        ("cuMemcpyDtoH", lambda: card.read(array), "waiting for Fake 40, whose last .* nothing"),
        ("cuMemcpyHtoD", lambda: card.upload(np.ones(3)), "copying to Fake 40"),
        ("cuDevicePrimaryCtxRetain", CudaDevice, "beginning to use Fake 40"),
    ):  # fmt: skip
        fake.fails(function, 700)
        with pytest.raises(CudaError, match=f"^{text}: {illegal}$") as caught:
            work()
        assert caught.value.code == 700
    with pytest.raises(CudaError, match=r"^compiling broken for Fake 40: error 218.*\nptxas fatal"):
        function_of(card.context, Ptx("broken", b"nothing"), "broken")


def test_too_little_memory_is_told_in_numbers(fake, card):
    fake.library.fake_memory(2**28)
    line = "Fake 40 has too little memory: 2.00 GiB were asked for, 0.25 GiB of 1.00 GiB are free"
    with pytest.raises(CudaError, match=f"^{re.escape(line)}$"):
        card.empty((2**21, 1024), np.uint8)


def test_without_a_driver_or_a_card_or_with_an_old_one_a_line_says_so(fake, monkeypatch):
    def line(**settings):
        for name, value in settings.items():
            monkeypatch.setenv(name, value)
        driver.cache_clear()
        with pytest.raises(CudaError) as caught:
            cuda_device()
        assert gpu_line() == str(caught.value)
        assert "\n" not in gpu_line()
        return gpu_line()

    fake.library.fake_cards(1, 7)
    assert line() == "Fake 40 has compute capability 7.0; needed is 8.0 or more"
    fake.library.fake_cards(0, 9)
    assert line() == "there is no graphics processor of NVIDIA"
    fake.library.fake_cards(1, 9)
    fake.fails("cuInit", 3)
    driver.cache_clear()
    assert "was this process forked" in gpu_line()
    with pytest.raises(CudaError, match="there is no graphics processor 1; the driver shows 1"):
        CudaDevice(1)
    assert "the driver of NVIDIA is too old" in line(**{VARIABLE: "libm.so.6"})
    assert line(**{VARIABLE: "libnone.so"}).startswith("there is no driver of NVIDIA: libnone.so")


def test_one_line_says_what_there_is(fake):
    fake.library.fake_cards(3, 8)
    assert re.fullmatch(
        r"Fake 40, 1\.00 GiB, compute capability 8\.0, (driver [\d.]+ \(CUDA 13\.0\)|CUDA 13\.0), "
        r"number 0 of 3",
        gpu_line(),
    )
    assert not fake.told("cuDevicePrimaryCtxRetain")  # which would take half a gigabyte


def test_there_is_one_device_for_a_card_also_in_threads(fake):
    with ThreadPoolExecutor(8) as threads:
        found = set(threads.map(lambda _: cuda_device(), range(32)))
    assert found == {cuda_device(0)}
    assert len(fake.told("cuDevicePrimaryCtxRetain")) == 1


def test_arrays_of_another_device_are_refused(fake, card):
    fake.library.fake_cards(2, 9)
    other = CudaDevice(1)
    with pytest.raises(ValueError, match="is not on this graphics processor"):
        card.held((other.zeros(3, np.float64),))


class OnHost:
    """A `CudaArray` of the fake driver as what it is, memory of this processor."""

    def __init__(self, array):
        self._array = array

    def __dlpack_device__(self):
        return 1, 0

    def __dlpack__(self, **_):
        return capsule_of(self._array, (1, 0))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["?", "u1", "i8", "f2", "f4", "f8"])
def test_others_share_memory_by_dlpack_and_let_go_of_it(fake, card, kind):
    torch = pytest.importorskip("torch")
    gc.collect()  # of tests before
    before = fake.pieces
    values = np.arange(24).reshape(4, 3, 2).astype(kind)
    array = card.upload(values)
    rows = torch.from_dlpack(OnHost(array[1:3]))
    other = np.from_dlpack(OnHost(array))
    assert rows.data_ptr() == array[1:3].address
    np.testing.assert_array_equal(rows.numpy(), values[1:3])
    np.testing.assert_array_equal(other, values)
    rows.zero_()
    assert not card.read(array)[1:3].any()
    del array
    assert fake.pieces == before + 1
    del rows
    assert fake.pieces == before + 1
    del other
    assert fake.pieces == before


def test_a_capsule_that_nobody_opens_lets_go(fake, card):
    before = fake.pieces
    capsule = card.zeros(3, np.float32).__dlpack__(max_version=(1, 1), dl_device=(2, 0))
    assert fake.pieces == before + 1
    assert "dltensor" in repr(capsule)
    del capsule
    assert fake.pieces == before


def test_the_stream_of_others_waits_for_this_one(fake, card):
    array = card.zeros(3, np.float32)
    fake.told()
    for stream in (None, -1, 1):
        array.__dlpack__(stream=stream)
    assert not fake.told()
    array.__dlpack__(stream=0x42)
    assert fake.told()[1:3] == ["cuEventRecord 0x99 (nil)", "cuStreamWaitEvent 0x42 0x99 0"]


def test_what_dlpack_cannot_tell_is_refused(card):
    array = card.zeros(3, [("a", "i4"), ("b", "f4")])
    with pytest.raises(BufferError, match="no elements of type"):
        array.__dlpack__()
    for wish in ({"copy": True}, {"dl_device": (1, 0)}):
        with pytest.raises(BufferError, match="shared as it is"):
            card.zeros(3, "f4").__dlpack__(**wish)


def test_the_interface_of_cuda_arrays_tells_where_they_are(card):
    array = card.zeros((5, 2), np.float32)[1:3]
    told = array.__cuda_array_interface__
    assert (told["data"], told["shape"], told["typestr"]) == ((array.address, False), (2, 2), "<f4")
    assert (told["strides"], told["version"], told["stream"]) == (None, 3, 1)
    assert card.zeros((0, 2), "f8").__cuda_array_interface__["data"][0] == 0


def test_recorded_work_goes_to_a_graph_that_keeps_what_it_uses(fake, card):
    card.launch(nothing, 1, card.held(1))
    before = fake.pieces
    arrays = [card.zeros(4, np.float64)]
    fake.told()
    used = []

    def work():
        card.clear(arrays[0])
        used.append((bundle := card.held(1)).address)
        card.launch(nothing, 1, bundle)

    graph = card.recorded(work)
    assert card.held(1).address not in used
    told = [line.partition(" block")[0] for line in fake.told()]
    assert [line for line in told if "HtoD" not in line] == [
        "cuStreamCreate 1", "cuStreamBeginCapture 0x55 2", "cuMemsetD8Async 32 stream 0x55",
        "cuLaunchKernel grid 1 1 1", "cuStreamEndCapture 0x55", "cuGraphInstantiate 0",
        "cuGraphDestroy ", "cuStreamDestroy 0x55",
    ]  # fmt: skip
    graph()
    card.clear(arrays[0])
    assert fake.told() == ["cuGraphLaunch stream (nil)", "cuMemsetD8Async 32 stream (nil)"]
    arrays.clear()
    assert fake.pieces == before + 1
    del graph
    assert sorted(fake.told()) == ["cuGraphExecDestroy ", "cuMemFree "]
    assert card.held(1).address in used
    fake.told()
    with pytest.raises(ZeroDivisionError):
        card.recorded(lambda: 1 / 0)
    assert fake.told()[-2:] == ["cuGraphDestroy ", "cuStreamDestroy 0x55"]


def test_time_is_measured_between_events(fake, card):
    begin = card.event()
    assert card.event().since(begin) == 0.25
    del begin
    assert len(fake.told("cuEventDestroy")) == 2


FORKS = """
import os, numpy as np
from eyas.gpu.cuda import CudaError, cuda_device, gpu_line
kept = cuda_device().zeros(3, np.float32)
if os.fork():
    os.wait()
    print(cuda_device().read(kept).sum())
else:
    for attempt in (cuda_device, lambda: kept.__dlpack__(stream=5), lambda: print(gpu_line())):
        try:
            attempt()
        except CudaError as error:
            print(error, flush=True)
    del kept
"""

ENDS = """
import atexit, gc, sys
import numpy as np
from eyas.gpu.cuda import cuda_device, memory
from eyas.gpu.cuda.memory import capsule_of

class OnHost:
    def __init__(self, array): self.array = array
    def __dlpack_device__(self): return 1, 0
    def __dlpack__(self, **_): return capsule_of(self.array, (1, 0))

library = np
try:
    if not sys.argv[1:]:
        import torch as library
except ImportError:
    pass
device = cuda_device()
kept, held = device.zeros(1000, np.float32), device.held((1, np.ones(3)))
capsule = kept.__dlpack__()
np.shared = np.from_dlpack(OnHost(device.zeros(5, np.float32)))
library.shared = library.from_dlpack(OnHost(device.zeros(5, np.float32)))
class Cycle: pass
cycle = Cycle()
cycle.own, cycle.kept, cycle.event = cycle, device.zeros(5, np.float64), device.event()
if sys.argv[1:] == ["names first"]:
    numbers, given = np.from_dlpack(OnHost(device.zeros(5, np.float32))), memory._given
    before = len(given)
    atexit.unregister(memory._let_go)
    vars(memory).clear()
    gc.collect()
    del numbers, capsule
    print(before - len(given))
if sys.argv[1:] == ["libraries last"]:
    numbers, before = np.from_dlpack(OnHost(device.zeros(5, np.float32))), len(memory._given)
    memory._let_go()
    del numbers
    print(before - len(memory._given))
"""


def run(program, library, *arguments):
    environment = {**os.environ, VARIABLE: str(library)}
    command = [sys.executable, "-c", program, *arguments]
    found = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
    assert (found.returncode, found.stderr) == (0, "")
    return found.stdout.splitlines()


def test_a_forked_process_is_told_that_it_cannot_use_the_card(library):
    *told, parent = run(FORKS, library)
    assert len(told) == 3
    assert all(line.startswith("a process forked from one that uses") for line in told)
    assert parent == "0.0"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("how", "expected"), [((), []), (("names first",), ["2"]), (("libraries last",), ["0"])]
)
def test_a_process_ends_quietly(library, how, expected):
    assert run(ENDS, library, *how) == expected
