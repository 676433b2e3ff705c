"""H.264 on the socket decodes, whatever is dropped, resized or chosen; the server is real."""

import io

import numpy as np
import pytest
from PIL import Image

from .conftest import Viewer

pytestmark = pytest.mark.slow  # what its tests share takes long to make

av = pytest.importorskip("av")


class Decoder:
    """Decodes the pictures of a viewer, as a page does."""

    def __init__(self):
        self.kinds = []

    def take(self, state, data):
        """Return the picture, shape (H, W, 3)."""
        self.kinds.append(state["picture"])
        if state["picture"] == "jpeg":
            return np.asarray(Image.open(io.BytesIO(data)))
        if state["picture"] == "key":
            self.coder = av.CodecContext.create("h264", "r")
        (picture,) = self.coder.decode(av.Packet(data))  # each gives one, at once
        return picture.to_ndarray(format="rgb24")


@pytest.fixture
def watch(viewer):
    """Reads frames of a viewer, and their pictures."""
    decoder = Decoder()

    def read(wanted=lambda state: True):
        while True:
            state = viewer.frame()
            picture = decoder.take(state, viewer.picture)
            if wanted(state):
                return state, picture

    read.decoder = decoder
    return read


def is_h264(state):
    return state["picture"] != "jpeg"


def test_both_codings_show_the_same_picture(viewer, watch):
    viewer.say("look", width=320, height=180)
    viewer.say("pace", speed=0)
    watch(lambda s: s["speed_of_time"] == 0 and s["size"][0] >= 320)
    state, jpeg = watch()
    viewer.say("pictures", coding="h264")
    _, h264 = watch(lambda s: is_h264(s) and s["size"] == state["size"])
    difference = h264.astype(int) - jpeg
    assert abs(difference.mean(axis=(0, 1))).max() < 2.0  # no shift of any colour
    assert abs(difference).mean() < 8.0


def test_a_stream_begins_with_a_whole_picture_and_is_small_then(viewer, watch):
    viewer.say("pictures", coding="h264")
    state, _ = watch(is_h264)
    assert state["picture"] == "key"
    whole = len(viewer.picture)
    for _ in range(10):
        state, _ = watch()
        assert state["picture"] == "delta"
        assert len(viewer.picture) < 0.5 * whole


def test_what_is_chosen_again_begins_again(viewer, watch):
    viewer.say("pictures", coding="h264")
    watch(is_h264)
    viewer.say("pictures", coding="h264")
    watch(lambda s: s["picture"] == "key")
    viewer.say("pictures", coding="jpeg")
    watch(lambda s: s["picture"] == "jpeg")


def test_another_size_begins_again_and_decodes(viewer, watch):
    viewer.say("pictures", coding="h264")
    state, _ = watch(is_h264)
    viewer.say("look", width=640, height=200)
    new, picture = watch(lambda s: s["size"] != state["size"])
    assert new["picture"] == "key"
    assert picture.shape[:2] == tuple(reversed(new["size"]))


def test_frames_that_a_slow_viewer_misses_leave_the_stream_whole(served, viewer, watch):
    slow, decoder = Viewer(served.socket), Decoder()
    slow.say("pictures", coding="h264")
    first = viewer.frame()["frame"]
    viewer.until(lambda s: s["frame"] > first + 30, while_waiting=lambda: viewer.hold("turn_left"))
    viewer.say("pace", speed=0)
    _, still = watch(lambda s: s["speed_of_time"] == 0)
    seen = []
    while len(seen) < 3 or not seen[-1]["speed_of_time"] == 0:
        state = slow.frame()
        picture = decoder.take(state, slow.picture)
        seen.append(state)
        viewer.frame()
    assert decoder.kinds.count("key") == 1
    numbers = [state["frame"] for state in seen]
    assert max(np.diff(numbers)) > 20
    assert abs(picture.astype(int) - still).mean() < 8.0
    slow.close()


def test_who_chooses_nothing_gets_jpeg(viewer, watch):
    for _ in range(5):
        assert watch()[0]["picture"] == "jpeg"
