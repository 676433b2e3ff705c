"""The frames of a recording as a PyTorch data set."""

from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from eyas.engine.core.errors import MissingExtraError

if TYPE_CHECKING:
    from eyas.engine.recordings.recording import Recording

try:
    from torch.utils.data import Dataset
except ImportError as error:
    raise MissingExtraError("a recording as a PyTorch data set", "train") from error


class TorchFrames(Dataset[dict[str, Any]]):
    """Items are dictionaries of NumPy arrays, which `torch.utils.data.default_collate` makes
    tensors of, and `label`, which it cannot: use `collate_fn=list`, or take what is needed.

    Args:
        recording: The recording.
        outputs: Names of methods of `RecordedFrame`: `masks`, `depth`, ...
    """

    def __init__(self, recording: "Recording", outputs: Sequence[str]) -> None:
        self._episodes, self._outputs = recording.episodes, outputs
        self._ends = list(accumulate(len(episode) for episode in recording.episodes))

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    def __getitem__(self, index: int) -> dict[str, Any]:
        index = range(len(self))[index]
        which = bisect_right(self._ends, index)
        first = self._ends[which - 1] if which else 0
        frame = self._episodes[which][index - first]
        arrays = {output: getattr(frame, output)() for output in self._outputs}
        return {"picture": frame.picture(), "label": frame.label, **arrays}
