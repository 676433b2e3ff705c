"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=True,
    brings={
        "eyas.formats": {
            "coco": "eyas.datasets.formats.coco:Coco",
            "mot": "eyas.datasets.formats.mot:Mot",
            "got10k": "eyas.datasets.formats.sot:Got10k",
            "lasot": "eyas.datasets.formats.sot:Lasot",
            "uav123": "eyas.datasets.formats.sot:Uav123",
            "dtb70": "eyas.datasets.formats.sot:Dtb70",
            "otb": "eyas.datasets.formats.sot:Otb",
            "vot": "eyas.datasets.formats.vot:Vot",
            "kitti": "eyas.datasets.formats.kitti:Kitti",
            "nuscenes": "eyas.datasets.formats.nuscenes:NuScenes",
            "yolo": "eyas.datasets.formats.yolo:Yolo",
            "yolo-seg": "eyas.datasets.formats.yolo:YoloSegments",
            "yolo-obb": "eyas.datasets.formats.yolo:YoloOriented",
            "visdrone-det": "eyas.datasets.formats.visdrone:VisDroneDet",
            "visdrone-sot": "eyas.datasets.formats.visdrone:VisDroneSot",
            "visdrone-mot": "eyas.datasets.formats.visdrone:VisDroneMot",
            "uavdt": "eyas.datasets.formats.uavdt:Uavdt",
            "lerobot": "eyas.datasets.formats.lerobot:LeRobot",
            "webdataset": "eyas.datasets.formats.shards:WebDataset",
            "minari": "eyas.datasets.formats.minari:Minari",
            "rerun": "eyas.datasets.formats.rerun:Rerun",
            "mcap": "eyas.datasets.formats.mcap:Mcap",
        },
        "eyas.commands": {
            "export": "eyas.datasets.commands:export",
            "track": "eyas.datasets.commands:track",
            "dataset": "eyas.datasets.commands:dataset_app",
        },
    },
)
