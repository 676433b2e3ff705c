"""What shares of recorded frames show their targets how, beside what was asked."""

from collections.abc import Iterator
from dataclasses import dataclass

from eyas.engine.exports.frame import Frame
from eyas.engine.settings.video import VideoConfig
from eyas.engine.sim.flights.shares import SMALL

__all__ = ["ReachedShares", "missed"]

_NEAR = 0.05  # A share that differs by no more from what was asked is reached


@dataclass(slots=True)
class ReachedShares:
    """Numbers of frames, of those that were drawn."""

    frames: int = 0
    in_view: int = 0
    hidden: int = 0
    cut: int = 0
    small: int = 0

    def add(self, frame: Frame) -> None:
        """Count a frame."""
        target = frame.target
        left, top, right, bottom = target.box.tolist()
        pixels = (right - left) * (bottom - top)
        self.frames += 1
        if not pixels:
            return
        self.in_view += 1
        self.hidden += target.visible_fraction <= 0.5
        self.cut += target.truncated(frame.camera) > 0.0
        self.small += pixels < SMALL

    def shares(self) -> dict[str, float]:
        """Return the shares by their settings."""
        names = ("in_view", "hidden", "cut", "small")
        return {name: getattr(self, name) / max(self.frames, 1) for name in names}

    def plus(self, other: "ReachedShares") -> "ReachedShares":
        """Return both together."""
        return ReachedShares(
            self.frames + other.frames,
            self.in_view + other.in_view,
            self.hidden + other.hidden,
            self.cut + other.cut,
            self.small + other.small,
        )


def missed(reached: ReachedShares, video: VideoConfig) -> Iterator[str]:
    """Yield a line for each share that was asked of camera paths and is not reached."""
    for name, share in reached.shares().items():
        asked = getattr(video, name)
        if reached.frames and asked is not None and abs(share - asked) > _NEAR:
            yield (
                f"note: video.{name}: {asked:.0%} of the frames were asked, the flights came to "
                f"{share:.0%}; other heights, pitches, maps or longer episodes may come nearer"
            )
