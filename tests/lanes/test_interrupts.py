"""What is shielded is not cut off, and what was held back comes later."""

import os
import signal
import threading

import pytest

from eyas.lanes.interrupts import let_in, shielded


def press():
    os.kill(os.getpid(), signal.SIGINT)


def test_what_is_shielded_ends_before_the_interrupt_comes():
    done = []

    def work():
        with shielded():
            press()
            done.append(1)

    with pytest.raises(KeyboardInterrupt):
        work()
    assert done == [1]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_shields_inside_shields_hold_until_the_outer_one_ends():
    done = []

    def work():
        with shielded():
            with shielded():
                press()
            done.append(1)

    with pytest.raises(KeyboardInterrupt):
        work()
    assert done == [1]


def test_an_interrupt_can_be_let_in():
    let_in()  # there is no shield

    def work():
        with shielded():
            let_in()  # nothing came
            press()
            let_in()
            done.append(1)

    done = []
    with pytest.raises(KeyboardInterrupt):
        work()
    assert not done


def test_an_error_in_a_shield_is_what_the_interrupt_came_after():
    def work():
        with shielded():
            press()
            raise ValueError

    with pytest.raises(KeyboardInterrupt) as caught:
        work()
    assert isinstance(caught.value.__context__, ValueError)


def test_in_other_threads_a_shield_changes_nothing():
    def work():
        with shielded():
            handlers.append(signal.getsignal(signal.SIGINT))
            let_in()

    handlers = []
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert handlers == [signal.default_int_handler]
