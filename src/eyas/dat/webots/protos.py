"""The PROTO files of a project: the drone, the vehicles, the interface to SUMO."""

from collections.abc import Iterator

from eyas.dat.webots.vrml import Is, Node, Value, proto
from eyas.dat.webots.world import VrmlShapes
from eyas.engine.exports.resting import resting_mesh
from eyas.engine.targets.catalogue import VEHICLE_KINDS
from eyas.engine.targets.kind import Kind, Model
from eyas.engine.targets.quadrotor import quadrotor_levels
from eyas.engine.trackers.gimbal import PITCH_JOINT, ROLL_JOINT, YAW_JOINT

DRONE, INTERFACE = "Drone", "SumoInterface"

_DETAIL = 1
_POSE = (
    ("SFVec3f", "translation", (0.0, 0.0, 0.0)),
    ("SFRotation", "rotation", (0.0, 0.0, 1.0, 0.0)),
)
_AWAY = 10_000.0
"""East coordinate of what is not on the map now, as in the original [m]; it waits as high as it
drives, which tells the controller its height."""
_MOST = {"passenger": 40}  # How many of a class a world holds, and of any other
_OTHERS = 10


def vehicle_protos(
    shapes: dict[str, VrmlShapes],  # Filled with the maker of each file, which tells its textures
) -> Iterator[tuple[str, str]]:
    """Yield the name and text of the PROTO of each model of a vehicle.

    The origin is where the original's is: at the reference point, as high as the wheels' middles.
    """
    for model in (model for kind in VEHICLE_KINDS for model in kind.models):
        shapes[model.name] = VrmlShapes("../worlds/textures", "color")
        mesh = resting_mesh(model.name, _DETAIL)
        body = Node(
            "Pose",
            {
                "translation": Is("translation"), "rotation": Is("rotation"),
                "children": [
                    Node(
                        "Pose",
                        {
                            "translation": (0.0, 0.0, -model.rise),
                            "children": shapes[model.name].of(mesh),
                        },
                    )
                ],
            },
        )  # fmt: skip
        fields = [*_POSE, ("SFColor", "color", (0.62, 0.62, 0.62))]
        yield model.name, proto(model.name, f"{model.name} of Eyas", fields, body)


def pool() -> Iterator[tuple[Node, str]]:
    """Yield the vehicles that a world holds, far away, and the class that SUMO has for each."""
    number = 0
    for kind in VEHICLE_KINDS:
        for k in range(_MOST.get(kind.name, _OTHERS)):
            model = kind.models[k % len(kind.models)]
            yield _vehicle(number, k, kind, model), kind.name
            number += 1


def _vehicle(number: int, k: int, kind: Kind, model: Model) -> Node:
    # Steps that share no factor with the number of colours give each model every one.
    colour = kind.colours[(k * 3 + k // len(kind.models)) % len(kind.colours)]
    length, width, height = model.size
    box = Node(
        "Pose",
        {
            "translation": (kind.ahead, 0.0, 0.5 * height - model.rise),
            "children": [Node("Box", {"size": (length, width, height)})],
        },
    )
    return Node(
        "Solid",
        {
            "translation": (_AWAY, 10.0 * number, model.rise), "name": f"SUMO vehicle {number}",
            "model": kind.name, "children": [Node(model.name, {"color": colour})],
            "boundingObject": box,
        },
        f"SUMO_VEHICLE{number}",
    )  # fmt: skip


def interface_proto() -> str:
    """Return the PROTO of the interface to SUMO: a supervisor whose controller reads its fields."""
    fields: list[tuple[str, str, Value]] = [
        ("SFString", "name", "sumo interface"),
        ("SFInt32", "maxVehicles", 40),
        ("SFInt32", "step", 100),
        ("SFInt32", "seed", 1),
        ("SFString", "networkFiles", ""),
    ]
    body = Node("Robot", {"name": Is("name"), "controller": "sumo_supervisor", "supervisor": True})
    return proto(INTERFACE, "Drives the vehicles by SUMO", fields, body)


def drone_proto(
    width: int,  # Of the picture [pixels]
    height: int,  # Of the picture [pixels]
    field_of_view: float,  # Horizontal [rad]
) -> str:
    """Return the PROTO of the drone, with its sensors and its camera on a gimbal of three axes.

    It has no `Physics`: its controller puts it where its commands lead, as in the original's mode
    under a supervisor. Joints and their places are the original's.
    """
    body = Node(
        "Robot",
        {
            "translation": Is("translation"), "rotation": Is("rotation"), "name": Is("name"),
            "controller": Is("controller"), "controllerArgs": Is("controllerArgs"),
            "customData": Is("customData"), "supervisor": True, "synchronization": True,
            "children": [
                Node("Group", {"children": VrmlShapes("").of(quadrotor_levels()[0])}),
                Node("GPS"), Node("InertialUnit"), Node("Gyro"),
                Node("Accelerometer"),
                _lidar(), _gimbal(),
            ],
            "boundingObject": Node("Box", {"size": (0.806, 0.806, 0.366)}),
        },
    )  # fmt: skip
    fields: list[tuple[str, str, Value]] = [
        *_POSE,
        ("SFString", "name", "DRONE0"), ("SFString", "controller", "drone"),
        ("MFString", "controllerArgs", []), ("SFString", "customData", ""),
        ("SFInt32", "cameraWidth", width), ("SFInt32", "cameraHeight", height),
        ("SFFloat", "fieldOfView", field_of_view),
    ]  # fmt: skip
    return proto(DRONE, "The drone, with the original's places of its camera", fields, body)


def _gimbal() -> Node:
    """Return the joints of the gimbal, with the camera on the last."""
    camera = Node(
        "Camera",
        {
            "width": Is("cameraWidth"),
            "height": Is("cameraHeight"),
            "fieldOfView": Is("fieldOfView"),
        },
    )
    roll = _joint("roll", (1.0, 0.0, 0.0), ROLL_JOINT, 0.5, [camera])
    pitch = _joint("pitch", (0.0, 1.0, 0.0), PITCH_JOINT, 1.7, [roll])
    return _joint("yaw", (0.0, 0.0, 1.0), YAW_JOINT, 1.7, [pitch])


def _lidar() -> Node:
    """Return the lidar of the original's drone."""
    lidar: dict[str, Value] = {
        "translation": (0.0, 0.0, 0.031), "horizontalResolution": 400,
        "fieldOfView": 6.283185307, "verticalFieldOfView": 0.01, "numberOfLayers": 1,
        "near": 0.05, "minRange": 0.2, "maxRange": 12.0, "noise": 0.000833, "resolution": 0.01,
    }  # fmt: skip
    return Node("Lidar", lidar)


def _joint(
    name: str, axis: tuple[float, ...], anchor: tuple[float, ...], limit: float, carried: list[Node]
) -> Node:
    """Return a joint of the gimbal; what it carries has its origin in the joint."""
    motor: dict[str, Value] = {
        "name": f"camera {name}", "maxVelocity": 1e4, "minPosition": -limit, "maxPosition": limit,
    }  # fmt: skip
    link: dict[str, Value] = {
        "translation": anchor,
        "name": f"camera {name} link",
        "children": carried,
    }
    return Node(
        "HingeJoint",
        {
            "jointParameters": Node("HingeJointParameters", {"axis": axis, "anchor": anchor}),
            "device": [
                Node("RotationalMotor", motor),
                Node("PositionSensor", {"name": f"camera {name} sensor"}),
            ],
            "endPoint": Node("Solid", link),
        },
    )
