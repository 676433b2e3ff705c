"""Environments as notebooks show them."""

import base64
import io
import re

import gymnasium
import numpy as np
from PIL import Image

import eyas
from eyas.engine.envs.notebook import strip_html

SMALL = {"camera": {"width": 64, "height": 48}}
PICTURE = re.compile(r'src="data:image/png;base64,([^"]+)"')


def pictures(html):
    return [
        np.asarray(Image.open(io.BytesIO(base64.b64decode(text)))) for text in PICTURE.findall(html)
    ]


def test_one_environment_shows_what_it_renders():
    env = gymnasium.make("eyas/citystreet-day-v0", config=SMALL, render_mode="rgb_array").unwrapped
    assert "call reset" in env._repr_html_()
    env.reset(seed=3)
    (shown,) = pictures(env._repr_html_())
    assert np.array_equal(shown, env.render())
    env.close()
    assert "closed" in env._repr_html_()


def test_several_show_the_first_as_a_strip():
    envs = eyas.make_vec("citystreet-day", num_envs=7, config=SMALL, render_mode="rgb_array")
    assert pictures(envs._repr_html_()) == []
    envs.reset(seed=3)
    shown = pictures(envs._repr_html_())
    assert len(shown) == 6
    assert all(np.array_equal(one, of) for one, of in zip(shown, envs.render(), strict=False))
    envs.close()


def test_to_be_shown_changes_nothing():
    def flown(shows):
        env = gymnasium.make("eyas/citystreet-day-v0", config=SMALL)
        env.reset(seed=4)
        told = []
        for action in (0, 4, 2):
            if shows:
                env.unwrapped._repr_html_()
            told.append(env.step(action)[0])
        env.close()
        return np.stack(told)

    assert np.array_equal(flown(shows=False), flown(shows=True))


def test_words_are_not_taken_for_markup():
    assert "&lt;b&gt;" in strip_html([], "<b>")
