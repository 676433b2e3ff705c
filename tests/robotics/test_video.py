import socket
import threading

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.robotics.mavlink.video import RtpPacker

av = pytest.importorskip("av")

SDP = """v=0
o=- 0 0 IN IP4 127.0.0.1
s=Eyas
c=IN IP4 127.0.0.1
t=0 0
m=video {port} RTP/AVP 96
a=rtpmap:96 H264/90000
"""


def test_ffmpeg_shows_the_pictures_of_the_camera(make_bench, tmp_path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as some:
        some.bind(("127.0.0.1", 0))
        port = some.getsockname()[1] & ~1  # RTP takes an even one
    settings = {"video": f"127.0.0.1:{port}", "picture_rate": 50.0, "video_quality": 10}
    bench = make_bench(mavlink=settings)
    (tmp_path / "eyas.sdp").write_text(SDP.format(port=port))
    done = threading.Event()

    def fly():
        while not done.wait(0.01):
            bench.loop.step()

    flight = threading.Thread(target=fly)
    flight.start()
    try:
        options = {"protocol_whitelist": "file,udp,rtp", "analyzeduration": "500000"}
        with av.open(str(tmp_path / "eyas.sdp"), options=options) as stream:
            frames = stream.decode(video=0)
            pictures = [next(frames).to_ndarray(format="rgb24") for _ in range(5)]
    finally:
        done.set()
        flight.join()
    shown = bench.fleet._picture.rgb[0].astype(float)
    assert pictures[-1].shape == shown.shape == (54, 96, 3)
    assert np.abs(pictures[-1] - shown).mean() < 12.0  # colours are shared among pixels
    assert np.abs(pictures[-1] - shown[::-1]).mean() > 12.0


def test_what_the_camera_says_of_its_video(make_bench):
    bench = make_bench(mavlink={"video": "127.0.0.1:5600"})
    assert bench.command("REQUEST_MESSAGE", 269, component=100) == 0
    told = bench.answers[-1]
    assert (told.uri, told.encoding, told.type) == ("5600", 1, 1)
    assert (told.resolution_h, told.resolution_v) == (96, 54)
    assert bench.command("REQUEST_MESSAGE", 259, component=100) == 0
    assert bench.answers[-1].flags & 0x100


def test_a_large_picture_is_cut_into_packets_that_fit():
    body = bytes(range(256)) * 20
    unit = b"\0\0\0\1\x67small" + b"\0\0\0\1\x65" + body.replace(b"\0", b"\7")
    first, *rest = RtpPacker(7).packets(unit, 1.0)
    assert first[12:] == b"\x67small"
    assert all(len(packet) <= 1212 for packet in rest)
    assert b"".join(packet[14:] for packet in rest) == body.replace(b"\0", b"\7")
    assert [packet[1] >> 7 for packet in rest] == [0] * (len(rest) - 1) + [1]
    assert [packet[13] >> 6 for packet in rest] == [2, *[0] * (len(rest) - 2), 1]
    numbers = [int.from_bytes(packet[2:4], "big") for packet in (first, *rest)]
    assert numbers == list(range(len(numbers)))


@pytest.mark.parametrize("address", ["5600", "host:", "127.0.0.1:70000", ":5600"])
def test_an_address_that_is_none_is_told(make_bench, address):
    with pytest.raises(ConfigError, match=r"mavlink\.video: .*HOST:PORT"):
        make_bench(mavlink={"video": address})
