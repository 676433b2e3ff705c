"""Motion that is made here and now, of recordings that no file holds."""

from eyas.engine.state.motion import SampledMotion
from eyas.engine.traffic import recorded


def recorded_motion(recording, terrain, kind):
    """Return the smoothed motion of a recording, on the ground of its map."""
    assert kind.shape == (recording.actors,)
    table = recorded.table_of(recorded.smooth(recording), terrain)
    return SampledMotion(table, kind, float(recording.rate)).packed()
