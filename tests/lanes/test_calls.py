"""Parallel kernels: every worker does its share, and bundles are found whatever their kind."""

import gc
import multiprocessing
import os
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from eyas.lanes import CompiledCall, PackedBundle, ParallelCall, calls, compiled, parallel


@parallel
def add_up(worker, workers, factor, values, sums, other):
    for row in range(worker, len(values), workers):
        for column in range(values.shape[1]):
            sums[row] += factor * values[row, column] + other


def summed(values, workers=3, more=0) -> np.ndarray:
    sums = np.zeros(len(values))
    add_up(workers, 2.0, values, sums, more)
    return sums


def test_each_row_is_added_up_once_whatever_the_number_of_workers():
    values = np.arange(20.0).reshape(10, 2)
    np.testing.assert_array_equal(summed(values, 0), 0.0)
    for workers in (1, 2, 7, 50):
        np.testing.assert_array_equal(summed(values, workers), 2.0 * values.sum(axis=1))


def test_arrays_of_other_kinds_are_read_as_what_they_are():
    whole = np.arange(40, dtype=np.int32).reshape(10, 4)
    still = whole.astype(np.float32)
    still.flags.writeable = False
    for values in (whole, still, whole[:, ::2], whole.T.astype(np.float64)):
        np.testing.assert_array_equal(summed(values), 2.0 * values.sum(axis=1))
    np.testing.assert_array_equal(summed(whole, more=1), 2.0 * whole.sum(axis=1) + 4)
    np.testing.assert_array_equal(summed(whole, more=0.5), 2.0 * whole.sum(axis=1) + 2)


def test_what_is_written_into_a_held_array_later_is_seen():
    values, sums = np.ones((4, 2)), np.zeros(4)
    held = PackedBundle(values)
    values[:] = 5.0
    add_up(2, 1.0, held, sums, 0)
    np.testing.assert_array_equal(sums, 10.0)


def test_a_bound_kernel_does_all_shares_and_keeps_what_it_works_on():
    values, sums = np.ones((5, 2)), np.zeros(5)
    add = add_up.bind(2.0, values, sums, 1.0)
    gc.collect()
    filler = [np.full(4096, 7, np.uint8) for _ in range(50)]  # where a lost bundle would have been
    add()
    values[:] = 3.0
    add()
    np.testing.assert_array_equal(sums, (2.0 + 1.0) * 2 + (6.0 + 1.0) * 2)
    assert len(filler) == 50


def test_a_bundle_of_many_arrays_is_held_whole():
    many = tuple(np.full(1, float(i)) for i in range(120))
    last = np.zeros((1, 1))

    @compiled
    def take_last(bundle, out):
        out[0, 0] = bundle[119][0]

    take_last(many, last)
    assert last[0, 0] == 119.0


def test_threads_may_call_at_once():
    values = np.ones((300, 50))
    with ThreadPoolExecutor(4) as threads:
        results = list(threads.map(summed, [values] * 16))
    assert len(results) == 16
    for result in results:
        np.testing.assert_array_equal(result, 100.0)


class SlowWorker:
    """Stands for a compiled kernel whose worker 1, in another thread, does not end until told."""

    def __init__(self, monkeypatch):
        self.told, self.begun, self.ended = (threading.Event() for _ in range(3))
        monkeypatch.setattr(CompiledCall, "_load", lambda kernel, parts: self.work)
        self.kernel = ParallelCall(None)

    def work(self, table, worker, workers):
        if worker == 0:  # so that a thread, not this one, takes the other share
            assert self.begun.wait(10)
            return
        self.begun.set()
        assert self.told.wait(10)
        time.sleep(0.2)
        self.ended.set()

    def call_and_interrupt(self, times, then=lambda: None):
        """Call, and press Ctrl-C while the call waits for the worker."""

        def press():
            self.begun.wait(10)
            for _ in range(times):
                time.sleep(0.2)
                os.kill(os.getpid(), signal.SIGINT)
            then()

        presser = threading.Thread(target=press)
        presser.start()
        with pytest.raises(KeyboardInterrupt):
            self.kernel(2, 0)
        presser.join()


def test_a_process_that_is_forked_during_a_call_may_call_too(monkeypatch):
    values = np.ones((300, 50))
    summed(values)  # compiled, before the kernel of the slow call takes the place of what compiles
    slow = SlowWorker(monkeypatch)
    call = threading.Thread(target=slow.kernel, args=(2, 0))
    call.start()
    try:
        assert slow.begun.wait(10)
        with multiprocessing.get_context("fork").Pool(2) as pool:
            results = pool.map_async(summed, [values] * 2).get(timeout=20)
        assert not slow.ended.is_set()  # or nothing was under way
    finally:
        slow.told.set()
        call.join()
    for result in results:
        np.testing.assert_array_equal(result, 100.0)


def test_an_interrupted_call_ends_after_its_workers(monkeypatch):
    slow = SlowWorker(monkeypatch)
    slow.call_and_interrupt(times=1, then=slow.told.set)
    assert slow.ended.is_set()


def test_after_two_interrupts_workers_still_end_before_what_they_use_is_free(monkeypatch):
    slow = SlowWorker(monkeypatch)
    slow.call_and_interrupt(times=2, then=slow.told.set)
    assert slow.ended.is_set()


def test_a_call_that_could_not_even_end_is_kept_and_the_next_waits_for_its_workers(monkeypatch):
    slow = SlowWorker(monkeypatch)
    whole = calls._Job.end

    def cut_off(call):  # a second Ctrl-C at the first instant of the end
        monkeypatch.setattr(calls._Job, "end", whole)
        raise KeyboardInterrupt

    monkeypatch.setattr(calls._Job, "end", cut_off)
    slow.call_and_interrupt(times=1)
    assert not slow.ended.is_set()  # or there would be nothing to wait for
    assert calls._POOL.job is not None

    seen = []

    def work(*_):
        seen.append(slow.ended.is_set())

    monkeypatch.setattr(CompiledCall, "_load", lambda kernel, parts: work)
    threading.Timer(0.2, slow.told.set).start()
    ParallelCall(None)(3, 0)
    assert seen == [True] * 3
    assert calls._POOL.job is None


def test_an_interrupt_before_a_share_begins_leaves_it_undone(monkeypatch):
    done = []

    def work(table, worker, workers):
        if worker == 0:
            raise KeyboardInterrupt
        time.sleep(0.1)  # or the threads could keep up with the one that hands out shares
        done.append(worker)

    monkeypatch.setattr(CompiledCall, "_load", lambda kernel, parts: work)
    with pytest.raises(KeyboardInterrupt):
        ParallelCall(None)(2000, 0)
    count = len(done)
    time.sleep(0.2)
    assert len(done) == count < 1999
