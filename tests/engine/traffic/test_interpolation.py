import numpy as np
import pytest

from eyas.engine.state.motion import SAMPLE, ActorState, Motion, SampledMotion
from eyas.engine.traffic.interpolation import ActorPose, interpolate_actor, interpolate_actors
from eyas.engine.traffic.smoothing import smooth


@pytest.fixture(scope="module")
def motion(wandering, flat_motion) -> Motion:
    return flat_motion(wandering)


def test_half_the_samples_give_the_same_motion(wandering, motion):
    tracks = smooth(wandering)
    half = motion.of(motion.table[::2])._replace(rate=5.0)
    for actor in range(2):
        for sample in range(1, 201, 2):
            pose = interpolate_actor(half, actor, sample / 10.0)
            # A curve of 10 Hz is off by a sixteenth of this.
            error = np.hypot(*(tracks.position[sample, actor] - (pose.x, pose.y)))
            assert error < 0.01, f"actor {actor} at sample {sample}"


def test_many_times_at_once_equal_one_by_one(motion):
    time = np.random.default_rng(5).uniform(0.0, 20.0, 4096)
    out = ActorState.create(4096, 3)
    interpolate_actors(motion, time, out)
    actor = np.arange(4096) % 3
    for world in range(4096):
        pose = interpolate_actor(motion, int(actor[world]), time[world])
        here = world, actor[world]
        moving = out.yaw[here], out.slope[here], out.speed[here], *out.velocity[here]
        same = (
            *out.position[here],
            *moving,
            out.yaw_rate[here],
            out.hitch[here],
            out.travelled[here],
            out.present[here],
        )
        assert tuple(pose) == same


def test_every_number_is_the_samples_at_its_time():
    """Each field of a pose comes from the field of that name, at both ends of a step."""
    table = np.zeros((2, 2), SAMPLE)
    for sample in range(2):
        for k, name in enumerate(SAMPLE.names):
            table[name][sample, 1] = 100.0 * sample + k + 1.0
    motion = SampledMotion(table, np.zeros(2, np.int32), 2.0, 7.0).packed()
    for sample, time in enumerate((7.0, 7.5)):
        pose = interpolate_actor(motion, 1, time)
        speed = np.hypot(table["velocity_x"][sample, 1], table["velocity_y"][sample, 1])
        velocity = ("velocity_x", "velocity_y", "velocity_z")
        for name in ("x", "y", "z", "yaw", "slope", *velocity, "yaw_rate", "hitch", "travelled"):
            assert getattr(pose, name) == pytest.approx(float(table[name][sample, 1])), name
        assert pose.speed == pytest.approx(float(speed))
        assert pose.present
    assert interpolate_actor(motion, 0, 7.0) == ActorPose(*[0] * 12, present=False)


def test_times_before_the_first_sample_and_after_the_last_are_held(motion):
    later = motion._replace(first_time=100.0)
    for actor in range(3):
        assert interpolate_actor(later, actor, 99.0) == interpolate_actor(motion, actor, 0.0)
        assert interpolate_actor(later, actor, 107.25) == interpolate_actor(motion, actor, 7.25)
        assert interpolate_actor(later, actor, 999.0) == interpolate_actor(motion, actor, 20.0)
