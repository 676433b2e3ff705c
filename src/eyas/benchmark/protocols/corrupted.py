"""`corrupted`: three seconds behind faults of the camera and in bad air, at five strengths.

The fifteen are those of Hendrycks and Dietterich, "Benchmarking neural network robustness to common
corruptions and perturbations" (ICLR 2019), each as a camera on a drone has it: not changes of
finished pictures, but of what the camera and the air do to light.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.protocols.published import STANDARD
from eyas.benchmark.records.record import EpisodeRecord

CLEAN = "clean"  # The variant without faults

Settings = Mapping[str, Any]


def _camera(**settings: Any) -> Settings:  # noqa: ANN401  # settings of any type
    return {"camera": settings}


def _between(low: float, high: float) -> Settings:
    return {"uniform": (low, high)}


def _exposed(seconds: float) -> Settings:
    """Return a sensor of tiny photosites whose exposure is too short to catch many photons."""
    short = {"time": (seconds, seconds), "iso": (100.0, 1e7)}
    return _camera(imager={"pixel_pitch": 0.5, "read_noise": 0.0}, exposure=short)


def _open_for(seconds: float) -> dict[str, Any]:
    """Return a sensor so dim, by its iris and a grey filter, that it may be exposed for a time."""
    return {
        "imager": {"f_number": 32.0, "transmission": 0.25},
        "exposure": {"time": (seconds, seconds), "iso": (1.0, 1e6)},
        "shutter": {"blur": True, "most_samples": 16},
    }


def _brighter(steps: float) -> Settings:
    return _camera(exposure={"compensation": steps, "speed": 0.0, "time": (1e-6, 0.02)})


CORRUPTIONS: Mapping[str, tuple[Settings, ...]] = {
    # Noise.
    "read-noise": tuple(
        _camera(imager={"read_noise": electrons})
        for electrons in (60.0, 120.0, 240.0, 400.0, 700.0)
    ),
    "shot-noise": tuple(map(_exposed, (5e-5, 2e-5, 8e-6, 3e-6, 1.2e-6))),
    "hot-pixels": tuple(
        _camera(imager={"hot_pixels": share}) for share in (0.01, 0.03, 0.07, 0.13, 0.22)
    ),
    # Blur.
    "defocus": tuple(_camera(defocus=share) for share in (0.02, 0.035, 0.05, 0.075, 0.11)),
    "drops": tuple(
        _camera(dirt={"spots": 0, "drops": count, "drop_size": _between(0.05, 0.15)})
        for count in (4, 8, 14, 22, 32)
    ),
    "motion-blur": tuple(
        _camera(**_open_for(seconds)) for seconds in (0.02, 0.04, 0.06, 0.08, 0.1)
    ),
    "vibration": tuple(
        _camera(vibration={"angle": angle}, **_open_for(0.02))
        for angle in (0.004, 0.008, 0.016, 0.03, 0.05)
    ),
    # Weather.
    "snow": tuple(
        {"world": {"weather": "snow", "precipitation": much}} for much in (0.5, 1.0, 1.5, 2.25, 3.0)
    ),
    "dirt": tuple(
        _camera(
            dirt={"spots": count, "spot_size": _between(0.06, 0.14), "opacity": _between(0.5, 0.9)}
        )
        for count in (4, 8, 14, 22, 32)
    ),
    "fog": tuple(
        {"world": {"weather": "foggy"}, "light": {"visibility": metres}}
        for metres in (200.0, 100.0, 60.0, 40.0, 25.0)
    ),
    "overexposure": tuple(map(_brighter, (1.0, 2.0, 3.0, 4.0, 5.0))),
    # What becomes of the picture.
    "underexposure": tuple(map(_brighter, (-2.0, -3.0, -4.0, -5.0, -6.0))),
    "rolling-shutter": tuple(
        _camera(shutter={"readout": seconds}, vibration={"angle": 0.01})
        for seconds in (0.01, 0.02, 0.04, 0.07, 0.1)
    ),
    "lost-slices": tuple(
        _camera(link={"quality": None, "slices": 12, "slice_loss": share})
        for share in (0.1, 0.2, 0.35, 0.5, 0.7)
    ),
    "compression": tuple(_camera(link={"quality": quality}) for quality in (20, 10, 6, 3, 1)),
}
"""Changes of the settings, from the weakest to the strongest."""

_VARIANTS = {
    CLEAN: {},
    **{
        f"{name}-{strength}": settings
        for name, strengths in CORRUPTIONS.items()
        for strength, settings in enumerate(strengths, 1)
    },
}


def _corruption(record: EpisodeRecord) -> str:
    return record.variant.rpartition("-")[0] or CLEAN


def _strength(record: EpisodeRecord) -> str:
    return record.variant.rpartition("-")[2]


def in_all_variants(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the episodes of `standard`, each with every fault.

    Those with the same fault follow each other: a batch then has few simulations, of many drones
    each, which takes less than half the time.
    """
    episodes = STANDARD.choose(places, STANDARD, count, first_seed)
    return [each._replace(variant=own) for own in protocol.variants for each in episodes]


CORRUPTED = STANDARD.like(
    "corrupted",
    "3 s: as standard, behind fifteen faults of camera and air at five strengths",
    {"camera": {"imager": {}}},
    episodes=4,
    columns=("tsr", "fall", "flawless", "seen"),
    gaps=("fall",),
    tells_solvable=False,
    choose=in_all_variants,
    variants=_VARIANTS,
    reference=CLEAN,
    groups={"corruption": _corruption, "strength": _strength},
)
