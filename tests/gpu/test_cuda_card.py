"""A card of NVIDIA, or, where there is none, one that this processor emulates: memory, PyTorch, and
kernels with the bytes of this processor.
"""

import subprocess
import sys
from typing import NamedTuple

import numpy as np
import pytest

from eyas.gpu.cuda import CudaError, cuda_device, gpu_line
from eyas.gpu.cuda.code import Ptx
from eyas.gpu.cuda.device import function_of
from eyas.lanes import claim, parallel
from eyas.lanes.device import HostDevice
from eyas.lanes.elementary import (
    acos,
    asin,
    atan,
    atan2,
    cos,
    exp,
    hypot,
    log,
    power,
    sin,
    tan,
    tanh,
)  # fmt: skip
from eyas.lanes.vector import WIDTH, load, root, select, store


@pytest.fixture(scope="module")
def there():
    """Whether there is a card."""
    try:
        cuda_device()
    except CudaError:
        return False
    return True


@pytest.fixture(scope="module")
def card(there, emulated):
    if there:
        yield cuda_device()
    else:
        with emulated(1):
            yield cuda_device()


@pytest.fixture
def real_card(there):
    if not there:
        pytest.skip("there is no graphics processor of NVIDIA")
    return cuda_device()


class Points(NamedTuple):
    x: np.ndarray
    y: np.ndarray


class Halves(NamedTuple):
    single: np.float32
    numbers: np.ndarray
    place: tuple[int, float]


class Task(NamedTuple):
    flag: bool
    count: int
    points: Points
    halves: Halves
    nothing: np.ndarray
    found: np.ndarray
    singles: np.ndarray
    claimed: np.ndarray


@parallel
def compute(worker, workers, task):
    points, halves, found, singles = task.points, task.halves, task.found, task.singles
    for i in range(worker, task.count, workers):
        x, y = points.x[i], points.y[i]
        inner = x / (1.0 + abs(x))
        found[i, 0], found[i, 1], found[i, 2] = sin(x), cos(x), tan(x)
        found[i, 3], found[i, 4], found[i, 5] = asin(inner), acos(inner), atan(x)
        found[i, 6], found[i, 7], found[i, 8] = exp(inner), log(abs(x)), tanh(x)
        found[i, 9], found[i, 10] = atan2(x, y), hypot(x, y)
        found[i, 11] = power(abs(x), inner)
        found[i, 12] = x * y + x / y - np.sqrt(abs(x)) + task.nothing.shape[0] + halves.place[0]
        found[i, 13] = np.floor(x) * halves.place[1] + np.ceil(y) + task.flag
        a, b = halves.numbers[i], halves.single
        singles[i, 0], singles[i, 1] = a * b + b, a / b - a
        singles[i, 2] = np.sqrt(abs(a)) * np.float32(x)
        claim(task.claimed)


def task_of(device, count):
    random = np.random.default_rng(3)
    x, y = random.normal(0.0, 30.0, (2, count))
    numbers = random.normal(0.0, 1.0, (2, count)).astype(np.float32)[1]
    halves = Halves(np.float32(1.1), numbers, (3, 0.1))
    outputs = device.zeros((count, 14), "f8"), device.zeros((count, 3), "f4"), device.zeros(1, "i8")
    return Task(True, count, Points(x, y), halves, np.zeros((0, 3)), *outputs)


@pytest.mark.parametrize("workers", [1, 1_000, 20_000])
def test_kernels_give_the_bytes_of_this_processor(card, workers):
    found = []
    for device in (HostDevice(), card):
        task = task_of(device, 20_000 if workers > 1 else 500)
        device.launch(compute, workers, device.held(task))
        found.append([device.read(one) for one in (task.found, task.singles, task.claimed)])
    assert np.isfinite(found[0][0]).all()
    for here, there in zip(*found, strict=True):
        np.testing.assert_array_equal(here.view(np.uint8), there.view(np.uint8))


class Rows(NamedTuple):
    a: np.ndarray
    b: np.ndarray
    out: np.ndarray


@parallel
def by_lanes(worker, workers, rows):
    for i in range(worker, len(rows.a) // WIDTH, workers):
        a, b = load(rows.a, WIDTH * i), load(rows.b, WIDTH * i)
        store(rows.out, WIDTH * i, select(a > b, root(a * a + b), a / b - b))


def test_kernels_on_lanes_give_the_bytes_of_this_processor(card):
    a, b = np.random.default_rng(4).uniform(0.5, 2.0, (2, 8_000)).astype(np.float32)
    found = []
    for device in (HostDevice(), card):
        rows = Rows(a, b, device.zeros(8_000, np.float32))
        device.launch(by_lanes, 300, device.held(rows), threads=WIDTH)
        found.append(device.read(rows.out))
    assert found[0].any()
    np.testing.assert_array_equal(found[0].view(np.uint32), found[1].view(np.uint32))


@pytest.mark.parametrize("kind", ["?", "u1", "i4", "f4", "f8", [("a", "i4"), ("b", "f8")]])
def test_arrays_come_back_as_they_went(card, kind):
    values = np.arange(30).reshape(10, 3).astype(np.dtype(kind))
    array = card.upload(values)
    np.testing.assert_array_equal(card.read(array), values)
    card.write(array, values[:2], 4)
    np.testing.assert_array_equal(card.read(array[4:6]), values[:2])
    card.clear(array[1:])
    assert not card.read(array)[1:].astype(bool if kind == "?" else kind).tobytes().strip(b"\0")
    assert card.read(card.upload(values[:0])).shape == (0, 3)


@pytest.mark.card
def test_pytorch_shares_memory_and_order(real_card):
    torch = pytest.importorskip("torch")
    if not torch.cuda.is_available():
        pytest.skip("this PyTorch is for the CPU only")
    task = task_of(real_card, 20_000)
    host = task_of(HostDevice(), 20_000)
    HostDevice().launch(compute, 1, HostDevice().held(host))
    for share in (torch.from_dlpack, lambda array: torch.as_tensor(array, device="cuda")):
        found = share(task.found)
        assert found.shape == (20_000, 14)
        assert found.data_ptr() == task.found.address
        for _ in range(3):
            found.fill_(-1.0)
            real_card.launch(compute, 20_000, real_card.held(task))
            doubled = found * 2.0  # comes after the kernel without waiting for it
            np.testing.assert_array_equal(doubled.cpu().numpy(), host.found * 2.0)
    rows = torch.from_dlpack(task.found[5:7])
    rows.zero_()
    assert not real_card.read(task.found)[5:7].any()
    with torch.cuda.stream(torch.cuda.Stream()):
        real_card.launch(compute, 20_000, real_card.held(task))
        other = torch.from_dlpack(task.found).clone()
    torch.cuda.synchronize()
    np.testing.assert_array_equal(other.cpu().numpy(), host.found)


def test_recorded_launches_are_done_again_by_one_call(card):
    task = task_of(card, 500)
    held = card.held(task)
    card.launch(compute, 500, held)
    expected = card.read(task.found)

    def work():
        card.clear(task.found)
        card.launch(compute, 500, held)

    graph = card.recorded(work)
    begin = card.event()
    for _ in range(2):
        card.clear(task.found)
        graph()
        np.testing.assert_array_equal(card.read(task.found), expected)
    assert card.event().since(begin) > 0.0


@pytest.mark.card
def test_what_cannot_be_is_said_in_a_line(real_card):
    with pytest.raises(CudaError, match=r"too little memory: 9\d+\.\d\d GiB were asked for"):
        real_card.empty(10**15 // 1000, np.uint8)
    text = b".version 8.0\n.target sm_80\n.address_size 64\n.entry f() { nonsense; }\n"
    with pytest.raises(CudaError, match=r"compiling broken for .*INVALID_PTX.*\n.*nonsense"):
        function_of(real_card.context, Ptx("f", text), "broken")
    assert real_card.name in gpu_line()


@pytest.mark.card
def test_a_process_that_holds_shared_arrays_ends_quietly(real_card):
    program = """
import numpy as np
from eyas.gpu.cuda import cuda_device
kept = cuda_device().zeros(1000, np.float32)
try:
    import torch
    shared = torch.from_dlpack(kept) if torch.cuda.is_available() else None
except ImportError:
    pass
capsule = kept.__dlpack__()
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
