"""Have the owners' tools read exports, which do not go into one environment with Eyas.

    eyas export runs/first --format vot --format nuscenes
    python3 -m venv /tmp/vot && /tmp/vot/bin/pip install vot-toolkit
    /tmp/vot/bin/python tools/check_formats.py vot runs/first/exports/vot
    python3 -m venv /tmp/nuscenes && /tmp/nuscenes/bin/pip install nuscenes-devkit
    /tmp/nuscenes/bin/python tools/check_formats.py nuscenes runs/first/exports/nuscenes

It imports nothing of Eyas. It ends with an error where something is not read as it was written.
"""

import sys
import typing
from pathlib import Path


def check_vot(folder: Path) -> None:
    """Load all sequences: pictures, boxes, tags and values."""
    # attributee 0.1.10 uses the bare decorator, which is a function in Python 3.11 and later.
    transform = typing.dataclass_transform
    typing.dataclass_transform = (  # type: ignore[assignment]
        lambda *given, **options: given[0] if given else transform(**options)
    )
    from vot.dataset import load_sequence
    from vot.region import Special

    for own in sorted(path.parent for path in folder.glob("*/*/sequence")):
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
        picture = sequence.frame(0).image()
        assert picture.shape == (sequence.size[1], sequence.size[0], 3)
        print(f"{own}: {len(sequence)} frames, tags {sorted(sequence.tags())}")


def check_nuscenes(folder: Path) -> None:
    """Load the tables of each split, and project all boxes: each is in the picture."""
    from nuscenes.nuscenes import NuScenes
    from nuscenes.utils.geometry_utils import BoxVisibility

    for tables in sorted(folder.glob("v1.0-*")):
        data = NuScenes(tables.name, str(folder), verbose=False)
        boxes = 0
        for sample in data.sample:
            token = sample["data"]["CAM_FRONT"]
            path, inside, matrix = data.get_sample_data(token, BoxVisibility.ANY)
            assert Path(path).is_file()
            assert matrix.shape == (3, 3)
            assert len(inside) == len(sample["anns"]), sample["token"]
            boxes += len(inside)
        for instance in data.instance:
            token, count = instance["first_annotation_token"], 0
            while token:
                count, token = count + 1, data.get("sample_annotation", token)["next"]
            assert count == instance["nbr_annotations"]
        print(f"{tables}: {len(data.scene)} scenes, {len(data.sample)} samples, {boxes} boxes")


if __name__ == "__main__":
    {"vot": check_vot, "nuscenes": check_nuscenes}[sys.argv[1]](Path(sys.argv[2]))
