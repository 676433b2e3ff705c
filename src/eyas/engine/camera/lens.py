"""The lens of the camera: how it bends, darkens and colours the edges of pictures."""

from enum import StrEnum
from functools import lru_cache
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, model_validator

from eyas.engine.core.config import Config
from eyas.engine.core.optics.lens import BROWN, FISHEYE, NO_LENS, Lens, lens_of, widest
from eyas.engine.core.optics.pinhole import focal_length
from eyas.engine.core.variation import Variation, bounds, sample, within
from eyas.engine.state.snapshot import CameraState
from eyas.lanes import exact

Floats = NDArray[np.float64]

Coefficient = Annotated[Variation, AfterValidator(within(-10.0, 10.0))]
Offset = Annotated[Variation, AfterValidator(within(-0.4, 0.4))]
Fringe = Annotated[Variation, AfterValidator(within(-0.05, 0.05))]


class LensModel(StrEnum):
    """How directions are shown, see `eyas.engine.core.optics.lens`."""

    PINHOLE = "pinhole"
    BROWN = "brown"
    FISHEYE = "fisheye"


_ALLOWED = {
    LensModel.PINHOLE: (),
    LensModel.BROWN: ("k1", "k2", "k3", "p1", "p2"),
    LensModel.FISHEYE: ("k1", "k2", "k3", "k4"),
}


class LensConfig(Config):
    """The camera's lens, by default a pinhole. Coefficients are OpenCV's, for a camera matrix with
    the focal length of a pinhole of `camera.field_of_view`. Each may be sampled anew for each
    tracker at each reset.
    """

    model: LensModel = LensModel.PINHOLE
    """How the lens bends pictures: `brown` is Brown-Conrady's model with k1, k2, k3, p1 and p2,
    `fisheye` Kannala-Brandt's with k1 to k4, up to a quarter turn aside. Coefficients are
    OpenCV's, for the focal length of a pinhole of `camera.field_of_view`."""
    k1: Coefficient = 0.0
    """Radial distortion; of `brown`, below 0 is a barrel. This and the following are sampled for
    each tracker at each reset."""
    k2: Coefficient = 0.0
    """The same."""
    k3: Coefficient = 0.0
    """The same."""
    k4: Coefficient = 0.0
    """The same, of `fisheye` only."""
    p1: Annotated[Variation, AfterValidator(within(-0.2, 0.2))] = 0.0
    """Tangential distortion, of lenses that are not centred."""
    p2: Annotated[Variation, AfterValidator(within(-0.2, 0.2))] = 0.0
    """The same."""
    right: Offset = 0.0
    """Principal point right of the middle of the picture, as a share of its width."""
    below: Offset = 0.0
    """The same below it, as a share of its height."""
    vignetting: Annotated[Variation, AfterValidator(within(0.0, 0.99))] = 0.0
    """Share of the light that is missing in the corners; less towards the principal point, by the
    law of cos⁴."""
    red: Fringe = 0.0
    """How much larger than green red is shown, as a share: lateral chromatic aberration."""
    blue: Fringe = 0.0
    """The same of blue."""

    @model_validator(mode="after")
    def _coefficients_of_the_model(self) -> Self:
        allowed = _ALLOWED[self.model]
        for name in ("k1", "k2", "k3", "k4", "p1", "p2"):
            if name not in allowed and getattr(self, name) != 0.0:
                those = ", ".join(allowed) or "none"
                raise ValueError(f"{name} must be 0; coefficients of {self.model.value}: {those}")
        return self

    @property
    def bends(self) -> bool:
        """Whether the picture is not that of a pinhole, or not centred."""
        moved = (self.right, self.below) != (0.0, 0.0)
        return self.model is not LensModel.PINHOLE or moved

    @property
    def changes_light(self) -> bool:
        """Whether it darkens or colours edges."""
        return (self.vignetting, self.red, self.blue) != (0.0, 0.0, 0.0)


_NUMBERS = ("k1", "k2", "k3", "k4", "p1", "p2", "right", "below", "vignetting", "red", "blue")


class LensSet:
    """The lenses of N trackers.

    Attributes:
        numbers: See `eyas.engine.core.optics.lens.Lens`, shape (N, 10).
        vignetting: See `LensConfig`, shape (N,).
        fringes: Its `red` and `blue`, shape (N, 2).
        vary: Whether they differ from episode to episode.

    Args:
        config: The settings.
        count: N.
    """

    def __init__(self, config: LensConfig, count: int) -> None:
        self._config = config
        self.numbers = np.tile(np.array(NO_LENS, np.float64), (count, 1))
        self.vignetting, self.fringes = np.zeros(count), np.zeros((count, 2))
        self.vary = any(not isinstance(getattr(config, name), float) for name in _NUMBERS)
        middle = {name: 0.5 * sum(bounds(getattr(config, name))) for name in _NUMBERS}
        self._set(slice(None), middle)

    @classmethod
    def of(cls, config: LensConfig, count: int) -> "LensSet | None":
        """Return the lenses of some settings; None: they are pinholes that lose no light."""
        return cls(config, count) if config.bends or config.changes_light else None

    @property
    def bend(self) -> bool:
        """Whether they bend the picture."""
        return self._config.bends

    @property
    def change_light(self) -> bool:
        """Whether they darken or colour edges."""
        return self._config.changes_light

    def begin(self, tracker: int, rng: np.random.Generator) -> None:
        """Begin an episode."""
        if self.vary:
            self._set(
                tracker, {name: sample(getattr(self._config, name), rng) for name in _NUMBERS}
            )

    def of_tracker(self, tracker: int) -> Lens:
        """Return the lens of a tracker."""
        row = self.numbers[tracker].tolist()
        return Lens(int(row[0]), *row[1:])

    def seeing(
        self,
        trackers: NDArray[np.integer],  # The trackers, shape (V,)
        cameras: CameraState,  # V cameras
        aspect: float,  # Height of the pictures over their width
    ) -> CameraState:
        """Return cameras without lenses that see all that cameras see through theirs."""
        numbers, fields = self.numbers[trackers], cameras.field_of_view
        if (numbers == numbers[:1]).all() and (fields == fields[:1]).all():
            numbers, fields = numbers[:1], fields[:1]  # mostly all are alike
        keys = zip(numbers.tolist(), fields.tolist(), strict=True)
        wide = [_field_around(tuple(row), field, aspect) for row, field in keys]
        return cameras._replace(field_of_view=np.zeros(len(trackers)) + wide)

    def _set(self, tracker: int | slice, value: dict[str, Any]) -> None:
        model = FISHEYE if self._config.model is LensModel.FISHEYE else BROWN
        radial = value["k1"], value["k2"], value["k3"], value["k4"]
        tangential = value["p1"], value["p2"]
        self.numbers[tracker] = lens_of(model, radial, tangential, value["right"], value["below"])
        self.vignetting[tracker] = value["vignetting"]
        self.fringes[tracker] = value["red"], value["blue"]


@lru_cache(maxsize=4096)
def _field_around(numbers: tuple[float, ...], field: float, aspect: float) -> float:
    """Return a horizontal field of view [rad] for `LensSet.seeing`."""
    lens = Lens(int(numbers[0]), *numbers[1:])
    focal = focal_length(1, field)
    tangent = widest(lens, (1.0, aspect), (focal, focal))
    return float(2.0 * exact.atan(max(tangent, tangent / aspect)))
