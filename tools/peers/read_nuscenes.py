"""nuscenes-devkit loads the tables of each split, and projects all boxes into their pictures."""

import sys
from pathlib import Path

from nuscenes.nuscenes import NuScenes
from nuscenes.utils.geometry_utils import BoxVisibility

exports = Path(sys.argv[1], "exports", "nuscenes")
for tables in sorted(exports.glob("v1.0-*")):
    data = NuScenes(tables.name, str(exports), verbose=False)
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
    print(f"nuscenes: {len(data.scene)} scenes, {len(data.sample)} samples, {boxes} boxes")
