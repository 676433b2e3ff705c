"""CPU time of vehicles that speak MAVLink: cores used at the clock's pace.

    python bench/mavlink.py --vehicles 1 --pictures 30
    python bench/mavlink.py --vehicles 20 --pictures 10 --width 320 --height 240

Each vehicle flies, sends the usual messages, and place, attitude, quaternion and IMU 100 times a
second, and its pictures as H.264 to a port where nobody listens. Time is not waited for, so that
other programs on the machine change little.
"""

import argparse
import math
import socket
import time

from eyas.engine.core.config import updated
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import together
from eyas.robotics.mavlink.endpoint import Endpoint, dialect
from eyas.robotics.mavlink.fleet import Fleet
from eyas.robotics.serving.mavlink import AS_FLOWN

common = dialect()

FAST = (
    "GLOBAL_POSITION_INT",
    "LOCAL_POSITION_NED",
    "ATTITUDE",
    "ATTITUDE_QUATERNION",
    "HIGHRES_IMU",
)


def send(fleet: Fleet, kind: str, **fields: float) -> None:
    """Send a message to a fleet."""
    message = getattr(common, f"MAVLink_{kind}_message")(**fields)
    packet = message.pack(common.MAVLink(None, 255, 190))
    for heard in common.MAVLink(None).parse_buffer(packet):
        fleet.take(heard)


def command(fleet: Fleet, system: int, number: int, *params: float) -> None:
    """Send a command to a vehicle."""
    values = {f"param{at + 1}": value for at, value in enumerate((*params, *[0.0] * 7)[:7])}
    to = {"target_system": system, "target_component": 1, "confirmation": 0}
    send(fleet, "command_long", command=number, **to, **values)


def step(fleet: Fleet, *, late: bool = False) -> None:
    """Fly for a period."""
    orders = fleet.orders()
    assert orders is not None  # not in lock-step
    fleet.simulation.advance(*orders)
    fleet.answer(late=late)


def main() -> None:
    """Fly and measure."""
    options = asked_for()
    changes = {
        "camera": {"width": options.width, "height": options.height},
        "start": {"velocity": "rest"},
        "mavlink": {
            "vehicles": options.vehicles,
            "picture_rate": options.pictures,
            "video": "127.0.0.1:46000",
        },
    }
    config = updated(AS_FLOWN, changes)
    simulation = build_simulation(config, together(options.vehicles))
    sizes: list[int] = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:

        class Counted(Endpoint):
            def send(self, packets: bytes) -> None:
                sizes.append(len(packets))
                out.sendto(packets, ("127.0.0.1", 46_999))

        endpoint = Counted("udp:127.0.0.1:46999")
        fleet = Fleet(simulation, config.mavlink, [endpoint])
        begin(fleet, options)
        sizes.clear()
        used = cores(fleet, options.seconds)
        fleet.close()
        endpoint.close()
    rate = sum(sizes) * 8e-6 / options.seconds
    print(
        f"{options.vehicles} vehicles, {options.pictures:g} pictures/s each of "
        f"{options.width}x{options.height}: {used:.2f} cores, {rate:.2f} Mbit/s of telemetry"
    )


def asked_for() -> argparse.Namespace:
    """Return what is asked for on the command line."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--vehicles", type=int, default=1)
    asked.add_argument("--pictures", type=float, default=30.0)
    asked.add_argument("--width", type=int, default=640)
    asked.add_argument("--height", type=int, default=360)
    asked.add_argument("--pitch", type=float, default=-45.0, help="of the cameras [degrees]")
    asked.add_argument("--usual", action="store_true", help="telemetry at its usual rates")
    asked.add_argument("--seconds", type=float, default=10.0)
    return asked.parse_args()


def begin(fleet: Fleet, options: argparse.Namespace) -> None:
    """Let all take off, look down, and send as much as is asked for."""
    for system in range(1, options.vehicles + 1):
        for kind in () if options.usual else FAST:
            number = getattr(common, f"MAVLINK_MSG_ID_{kind}")
            command(fleet, system, common.MAV_CMD_SET_MESSAGE_INTERVAL, number, 10_000.0)
        command(fleet, system, common.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)
        command(fleet, system, common.MAV_CMD_NAV_TAKEOFF, *[0.0] * 6, 503.0)
        look = options.pitch, 0.0, math.nan, math.nan
        command(fleet, system, common.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, *look)
    for _ in range(1_000):
        step(fleet, late=True)
    step(fleet)


def cores(fleet: Fleet, seconds: float) -> float:
    """Return the processor's time for a second of the flight."""
    begun, since = fleet.now, time.process_time()
    while fleet.now < begun + seconds:
        step(fleet)
        while fleet.encodes:  # as at the clock's pace
            time.sleep(0.0005)
    return (time.process_time() - since) / (fleet.now - begun)


if __name__ == "__main__":
    main()
