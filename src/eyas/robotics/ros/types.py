"""The types of messages of ROS 2, from the library `rosbags`, and those of vision_msgs."""

from functools import cache
from typing import TYPE_CHECKING

from eyas.engine.core.errors import MissingExtraError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_VISION = {
    "Point2D": "float64 x\nfloat64 y\n",
    "Pose2D": "vision_msgs/Point2D position\nfloat64 theta\n",
    "BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y\n",
    "BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size\n",
    "ObjectHypothesis": "string class_id\nfloat64 score\n",
    "ObjectHypothesisWithPose": (
        "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose\n"
    ),
    "Detection2D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox2D bbox\nstring id\n"
    ),
    "Detection3D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox3D bbox\nstring id\n"
    ),
    "Detection2DArray": "std_msgs/Header header\nvision_msgs/Detection2D[] detections\n",
    "Detection3DArray": "std_msgs/Header header\nvision_msgs/Detection3D[] detections\n",
}
"""Fields of vision_msgs 4, as in ROS 2 from Humble on; `rosbags` does not have them."""


def message_types(
    purpose: str,  # What needs them, for the message of the error
) -> "Typestore":
    """Return the types: those of ROS 2 Jazzy, which are the same from Humble to Lyrical.

    Raises:
        MissingExtraError: The extra `ros` is not installed.
    """
    try:
        return _registered()
    except ImportError as error:
        raise MissingExtraError(purpose, "ros") from error


@cache
def _registered() -> "Typestore":
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    for name, fields in _VISION.items():
        store.register(get_types_from_msg(fields, f"vision_msgs/msg/{name}"))
    return store
