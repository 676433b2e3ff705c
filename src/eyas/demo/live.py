"""What the drone's camera sees in the demo, with labels, in Rerun's viewer."""

from pathlib import Path

import numpy as np

from eyas.demo.flight import DemoFlight
from eyas.engine.core.optics.lens import NO_LENS, camera_matrix
from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.exports.writer import Episode
from eyas.engine.recordings.rerun import LiveView
from eyas.engine.state.draw import Picture

RATE = 10.0  # Pictures a second; each takes as long as one of the page, or less
_NONE = RecordedAction(number=-1, command=None)  # The page shows who flies, and how


class LiveDemo:
    """Shows a flight of the demo in Rerun's viewer, ten times a second.

    Its pictures have the size and the labels of what `eyas video` records with the same settings,
    whatever view the page shows.
    """

    def __init__(self, view: LiveView) -> None:
        self._view, self._due = view, 0.0

    def show(self, flight: DemoFlight, now: float) -> None:
        """Show a flight at a time [s], if a picture is due."""
        if now < self._due:
            return
        self._due = now + 1.0 / RATE
        simulation, camera = flight.simulation, flight.config.camera
        picture = Picture.create(
            *(1, camera.height, camera.width),
            depth=True,
            object_id=True,
            subject=True,
            actors=simulation.actors,
        )
        simulation.view.draw(np.zeros(1, np.int32), picture)
        moment = moment_of(simulation, 0, picture, 0, self._view.wants)
        frame = frame_of(moment, 0, picture, 0, 0, _NONE, self._view.wants)
        lens = moment.lens or NO_LENS
        field = frame.camera.field_of_view
        episode = Episode(
            folder=Path(),
            tracker=f"{flight.config.tracker.original_name}0",
            number=int(simulation.snapshot.episodes.number[0]),
            width=camera.width,
            height=camera.height,
            intrinsics=camera_matrix(lens, camera.width, camera.height, field),
            fps=RATE,
        )
        self._view.show(frame, episode)
