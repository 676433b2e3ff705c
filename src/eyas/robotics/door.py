"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=True,
    brings={
        "eyas.settings": {"mavlink": "eyas.robotics.mavlink.config:MavlinkConfig"},
        "eyas.writers": {
            "rosbag": "eyas.robotics.ros.bag:RosbagWriter",
            "rosbag-mcap": "eyas.robotics.ros.bag:RosbagMcapWriter",
        },
        "eyas.mesh_files": {".urdf": "eyas.robotics.urdf_file:read_urdf"},
        "eyas.track_files": {
            ".gpx": "eyas.robotics.tracks.geo:read_gpx",
            ".kml": "eyas.robotics.tracks.geo:read_kml",
            ".kmz": "eyas.robotics.tracks.geo:read_kml",
            ".geojson": "eyas.robotics.tracks.geo:read_geojson",
            ".tum": "eyas.robotics.tracks.poses:read_poses",
            ".txt": "eyas.robotics.tracks.poses:read_poses",
            ".ulg": "eyas.robotics.tracks.logs:read_ulg",
            ".bin": "eyas.robotics.tracks.logs:read_bin",
            ".tlog": "eyas.robotics.tracks.logs:read_tlog",
            ".plan": "eyas.robotics.tracks.missions:read_plan",
            ".waypoints": "eyas.robotics.tracks.missions:read_waypoints",
        },
        "eyas.commands": {"drone": "eyas.robotics.commands:app"},
    },
)
