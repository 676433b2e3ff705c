"""vot-toolkit loads all sequences: pictures, boxes, tags and values."""

import sys
import typing
from pathlib import Path

# attributee 0.1.10 uses the bare decorator, which is a function in Python 3.11 and later.
transform = typing.dataclass_transform
typing.dataclass_transform = lambda *given, **options: given[0] if given else transform(**options)

from vot.dataset import load_sequence
from vot.region import Special

exports = Path(sys.argv[1], "exports", "vot")
for own in sorted(path.parent for path in exports.glob("*/*/sequence")):
    sequence = load_sequence(str(own))
    lines = (own / "groundtruth.txt").read_text().splitlines()
    assert len(sequence) == len(lines)
    for number, line in enumerate(lines):
        region = sequence.groundtruth(number)
        if "nan" in line:
            assert isinstance(region, Special), (own, number)
        else:
            box = [region.x, region.y, region.width, region.height]
            assert box == [float(value) for value in line.split(",")], (own, number)
        for tag in ("occlusion", "camera_motion", "size_change"):
            stored = (own / f"{tag}.tag").read_text().split()[number]
            assert (tag in sequence.tags(number)) == (stored == "1"), (own, number, tag)
        stored = (own / "visibility.value").read_text().split()[number]
        assert float(sequence.values(number)["visibility"]) == float(stored)
    assert sequence.frame(0).image().shape == (sequence.size[1], sequence.size[0], 3)
    print(f"vot: {own.name}: {len(sequence)} frames, tags {sorted(sequence.tags())}")
