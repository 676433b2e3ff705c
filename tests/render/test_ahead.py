"""The first start: what the second process compiles is what the first will need."""

from eyas.render import ahead
from eyas.render.kernels.draw import draw_views

from .small_city import looking


def test_drawing_nothing_compiles_what_drawing_a_city_needs(city, drawn, monkeypatch):
    renderer, traffic = city

    def compiled_by(draw):
        monkeypatch.setattr(draw_views, "_compiled", {})  # other tests have drawn already
        draw()
        return set(draw_views._compiled)

    needed = compiled_by(lambda: drawn(renderer, looking([(0, 0, 20)]), traffic))
    assert needed
    assert compiled_by(ahead.draw_nothing) == needed


def test_only_a_first_start_is_told_and_shared(tmp_path, monkeypatch, caplog):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))
    monkeypatch.setattr(ahead, "_PROGRAM", "import eyas; raise SystemExit(7)")
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: 2)
    wait = ahead.compile_ahead()
    assert "first start" in caplog.text
    wait()
    assert ahead._started.pop().returncode == 7
    assert ahead.compile_ahead() is None  # another process of those that start together
    (tmp_path / "kernels" / "draw.eyk").touch()
    caplog.clear()
    assert ahead.compile_ahead() is None
    assert not caplog.text
