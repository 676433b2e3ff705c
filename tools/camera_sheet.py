"""One picture with each effect of the camera's sensor, front glass and link, off beside on.

python tools/camera_sheet.py docs/images

Writes camera-models.jpg, camera-flood.jpg, camera-mosaic.jpg, camera-dirt.jpg, camera-link.jpg,
camera-spectra.jpg, camera-focus.jpg, camera-further.jpg, and corruptions.jpg of the protocol
`corrupted`.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from eyas.benchmark.protocols.corrupted import CORRUPTIONS
from eyas.engine.core.config import updated, validated
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture

SIDE, MARGIN, LABEL = (320, 240), 6, 22

Pixels = NDArray[np.uint8]
Camera = Mapping[str, Any]
NOTHING: Mapping[str, Any] = {}


def main() -> None:
    """Write the sheets."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="folder to write to")
    folder = parser.parse_args().folder
    sheet(folder / "camera-models.jpg", models())
    sheet(folder / "camera-flood.jpg", [flood()])
    sheet(folder / "camera-mosaic.jpg", [mosaics()])
    sheet(folder / "camera-dirt.jpg", [dirt()])
    sheet(folder / "camera-link.jpg", [link()])
    sheet(folder / "camera-spectra.jpg", spectra())
    sheet(folder / "camera-focus.jpg", [focus()])
    sheet(folder / "camera-further.jpg", [further()])
    sheet(folder / "corruptions.jpg", corruptions())


Row = list[tuple[str, Pixels]]


def models() -> list[Row]:
    """Return one row for each weather, one column for each model."""
    names = (None, "small-drone", "global-shutter", "analogue-video")
    return [
        [(f"{name or 'no model'}, {weather}", picture({"model": name}, weather)) for name in names]
        for weather in ("day", "night", "snow")
    ]


def flood() -> Row:
    """Return what a camera shows that comes out of a tunnel, where it was 16 times darker."""
    simulation = simulation_of({"imager": {}, "exposure": {"speed": 0.2}})
    drawn(simulation)
    exposure = simulation.view.exposure
    assert exposure is not None
    exposure.value[:] += 4.0
    exposure.error[:] = 0.0
    shown: Row = []
    for step in range(1, 5):
        simulation.advance(np.zeros((1, 4)), 50)
        shown.append((f"after {0.1 * step:.1f} s", drawn(simulation)))
    return shown


def mosaics() -> Row:
    """Return a part of a picture, enlarged, without and with a mosaic."""
    return [
        (kind, enlarged(picture({"samples": 4, "imager": {"mosaic": kind}}), 4))
        for kind in ("none", "bilinear", "malvar")
    ]


def dirt() -> Row:
    """Return a clean glass, a dirty and a wet one."""
    return [
        ("clean", picture({})),
        ("12 spots", picture({"dirt": {"spots": 12, "opacity": 0.5}})),
        ("10 drops", picture({"dirt": {"spots": 0, "drops": 10}})),
    ]


def link() -> Row:
    """Return what is left of a picture by links of different quality."""
    row = [("not coded", picture({}))]
    row += [(f"quality {q}", picture({"link": {"quality": q}})) for q in (40, 10)]
    lost = simulation_of({"link": {"quality": 40, "slice_loss": 0.4}})
    for _ in range(3):
        drawn(lost)
        lost.advance(np.tile([8.0, 0.0, 0.0, 0.4], (1, 1)), 40)
    return [*row, ("40 % of 8 slices lost", drawn(lost))]


def spectra() -> list[Row]:
    """Return one row for each hour, one column for each spectrum."""
    spectra = ("colour", "grey", "near-infrared", "thermal")
    return [
        [
            (f"{name}, {hour:g} h", drawn(simulation_of({"spectrum": name}, hour=hour)))
            for name in spectra
        ]
        for hour in (9.0, 14.0, 23.0)
    ]


def focus() -> Row:
    """Return a sharp picture, two out of focus, and one with broken photosites."""
    return [
        ("sharp", picture({})),
        ("defocus 0.03", picture({"defocus": 0.03})),
        ("defocus 0.1", picture({"defocus": 0.1})),
        ("3 % hot pixels", picture({"imager": {"hot_pixels": 0.03}})),
    ]


def further() -> Row:
    """Return a tracker's own camera and three further ones."""
    size = {"width": SIDE[0], "height": SIDE[1]}
    cameras = (
        {"name": "right", "mount": {"y": -0.3}, "field_of_view": 0.9, **size},
        {"name": "wide", "field_of_view": 1.7, **size},
        {"name": "front", "on": "body", "mount": {"x": 0.1, "pitch": 0.1}, **size},
    )
    simulation = simulation_of({}, cameras=cameras)
    row = [("own", drawn(simulation))]
    for name, camera in simulation.view.further.items():
        made = Picture.create(1, SIDE[1], SIDE[0])
        camera.draw(np.zeros(1, np.int32), made)
        assert made.rgb is not None
        row.append((name, made.rgb[0]))
    return row


def corruptions() -> list[Row]:
    """Return the faults of the protocol `corrupted`, from the weakest to the strongest."""
    rows = []
    for name, strengths in CORRUPTIONS.items():
        row = [("clean", small(drawn(simulation_of({"imager": {}}))))]
        for number, changes in enumerate(strengths, 1):
            simulation = simulation_of({"imager": {}}, changes=changes)
            for _ in range(3):
                drawn(simulation)
                simulation.advance(np.tile([8.0, 0.0, 0.0, 0.8], (1, 1)), 20)
            row.append((f"{name} {number}", small(drawn(simulation))))
        rows.append(row)
    return rows


def small(pixels: Pixels) -> Pixels:
    """Return a picture at half its size."""
    return np.asarray(Image.fromarray(pixels).resize((SIDE[0] // 2, SIDE[1] // 2), Image.BOX))


def simulation_of(
    camera: Camera,
    weather: str = "day",
    hour: float | None = None,
    cameras: Sequence[Camera] = (),
    changes: Mapping[str, Any] = NOTHING,
) -> Simulation:
    """Return a simulation of one tracker."""
    size = {"width": SIDE[0], "height": SIDE[1]}
    values = {
        "world": {"weather": weather, "hour": hour},
        "cameras": cameras,
        "camera": {**size, "field_of_view": 0.9, **camera},
        "start": {"height": 13.0, "pitch": 0.75},
    }
    config = updated(validated(SimConfig, values), changes)
    simulation = build_simulation(config, each_alone(1))
    simulation.reset()
    return simulation


def drawn(simulation: Simulation) -> Pixels:
    """Return what its tracker sees."""
    made = Picture.create(1, SIDE[1], SIDE[0])
    simulation.draw(np.zeros(1, np.int32), made)
    assert made.rgb is not None
    return made.rgb[0]


def picture(camera: Camera, weather: str = "day") -> Pixels:
    """Return what a camera sees at the start."""
    return drawn(simulation_of(camera, weather))


def enlarged(pixels: Pixels, times: int) -> Pixels:
    """Return the middle of a picture, enlarged."""
    height, width = SIDE[1] // times, SIDE[0] // times
    top, left = (SIDE[1] - height) // 2, (SIDE[0] - width) // 2
    part = pixels[top : top + height, left : left + width]
    return part.repeat(times, axis=0).repeat(times, axis=1)


def sheet(path: Path, rows: list[Row]) -> None:
    """Write rows of pictures of one size with their names below."""
    height, width = rows[0][0][1].shape[:2]
    across, down = width + MARGIN, height + LABEL
    size = (max(map(len, rows)) * across + MARGIN, len(rows) * down + MARGIN)
    made = Image.new("RGB", size, (24, 25, 27))
    pen, font = ImageDraw.Draw(made), ImageFont.load_default(14)
    for i, row in enumerate(rows):
        for j, (name, pixels) in enumerate(row):
            left, top = MARGIN + j * across, MARGIN + i * down
            made.paste(Image.fromarray(pixels), (left, top))
            pen.text((left, top + height + 2), name, (200, 201, 203), font=font)
    made.save(path, quality=85)


if __name__ == "__main__":
    main()
