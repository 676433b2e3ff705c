from eyas.dat.wire.exchange import Pause


def test_the_longer_it_waits_the_less_often_it_looks(monkeypatch):
    now, slept = [50.0], []

    def sleep(seconds):
        slept.append(seconds)
        now[0] += seconds

    monkeypatch.setattr("time.monotonic", lambda: now[0])
    monkeypatch.setattr("time.sleep", sleep)
    pause = Pause()
    while now[0] < 60.0:
        pause.sleep()
    assert slept[0] < 0.001
    assert slept == sorted(slept)
    assert len(slept) < 600  # in 10 s
    pause.restart()
    pause.sleep()
    assert slept[-1] < 0.001
