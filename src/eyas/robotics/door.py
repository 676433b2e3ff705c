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
        "eyas.commands": {"drone": "eyas.robotics.commands:app"},
    },
)
