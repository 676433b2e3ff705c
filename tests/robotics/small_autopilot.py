"""An autopilot of 200 lines, which knows nothing of Eyas: flies by PX4's or ArduPilot's contract.

python small_autopilot.py px4|ardupilot PORT

It encodes and reads packets by `struct` alone, from MAVLink's published definitions (common.xml,
https://mavlink.io/en/guide/serialization.html) and from ArduPilot's SIM_JSON.h. Its controller
holds a place and an attitude, in north-east-down and forward-right-down. It prints what it sees as
JSON.
"""

import json
import math
import socket
import struct
import sys
import time

MASS, GRAVITY, ARM, TORQUE = 3.0069, 9.81, 0.22978, 0.02  # of the drone; N m for each N
MOST = 2.0 * MASS * GRAVITY / 4.0
INERTIA = (0.034, 0.036, 0.063)
GOALS = [((0, 0, -3), 0.0, 5.0), ((4, 0, -3), 0.0, 5.0), ((4, 3, -4), 1.2, 7.0)]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def unit(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def axes_of(q):
    """Return the body's axes in the world: forward, right, down."""
    w, x, y, z = q
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)),
    )


def outputs(place, velocity, q, rates, goal, yaw):
    """Return the outputs of motors 1 to 4: front right, rear left, front left, rear right."""
    push = [3.0 * min(max(g - p, -2.0), 2.0) - 3.0 * v
            for g, p, v in zip(goal, place, velocity, strict=True)]  # fmt: skip
    push[2] -= GRAVITY
    forward, right, down = axes_of(q)
    lift = max(-MASS * dot(push, down), 0.0)
    wanted_down = unit([-part for part in push])
    wanted_right = unit(cross(wanted_down, (math.cos(yaw), math.sin(yaw), 0.0)))
    wanted = (cross(wanted_right, wanted_down), wanted_right, wanted_down)
    turn = [0.0, 0.0, 0.0]  # half the sum of axis x wanted axis, in the world
    for own, other in zip((forward, right, down), wanted, strict=True):
        turn = [t + 0.5 * part for t, part in zip(turn, cross(own, other), strict=True)]
    error = [dot(turn, axis) for axis in (forward, right, down)]
    gains = ((120.0, 18.0), (120.0, 18.0), (12.0, 5.0))
    roll, pitch, twist = (
        inertia * (gain[0] * e - gain[1] * rate)
        for inertia, gain, e, rate in zip(INERTIA, gains, error, rates, strict=True)
    )
    a, b, c, base = roll / ARM, pitch / ARM, twist / TORQUE, lift
    # Right rotors roll to the left, rear ones pitch down; counter-clockwise ones turn clockwise.
    thrusts = (base - a + b + c, base + a - b + c, base + a + b - c, base - a - b - c)
    return [math.sqrt(min(max(0.25 * t / MOST, 0.0), 1.0)) for t in thrusts]


class Pilot:
    """Flies to the goals one after the other, by simulated time."""

    def __init__(self):
        self.began, self.told, self.yaw = None, [], 0.0

    def fly(self, now, place, velocity, q, rates):
        """Return outputs; None at the end."""
        self.began = now if self.began is None else self.began
        end = 0.0
        for goal, yaw, length in GOALS:
            end += length
            if now - self.began < end:
                # Headings do not jump.
                self.yaw += min(max(yaw - self.yaw, -0.004), 0.004)
                self.goal = goal
                break
            if len(self.told) < GOALS.index((goal, yaw, length)) + 1:
                forward = axes_of(q)[0]
                heading = math.atan2(forward[1], forward[0])
                self.told.append({"goal": goal, "place": place, "heading": [yaw, heading]})
                print(json.dumps(self.told[-1]), flush=True)
        else:
            return None
        return outputs(place, velocity, q, rates, self.goal, self.yaw)


EXTRA = {0: 50, 93: 47, 107: 108, 113: 124, 115: 4}  # CRC_EXTRA of the messages


def crc(data):
    found = 0xFFFF
    for byte in data:
        part = (byte ^ found) & 0xFF
        part ^= (part << 4) & 0xFF
        found = (found >> 8) ^ (part << 8) ^ (part << 3) ^ (part >> 4)
    return found & 0xFFFF


def packet(number, payload, sequence):
    payload = payload.rstrip(b"\0") or b"\0"
    head = struct.pack("<BBBBBB", len(payload), 0, 0, sequence & 255, 1, 1)
    head += number.to_bytes(3, "little")
    check = crc(head + payload + bytes([EXTRA[number]]))
    return b"\xfd" + head + payload + struct.pack("<H", check)


def packets(stream):
    """Yield number and payload of each packet of MAVLink 2; the check must be right."""
    while True:
        assert stream.read(1) == b"\xfd"
        head = stream.read(9)
        payload, check = stream.read(head[0]), stream.read(2)
        number = int.from_bytes(head[6:9], "little")
        assert struct.unpack("<H", check)[0] == crc(head + payload + bytes([EXTRA[number]]))
        yield number, payload + bytes(255 - len(payload))


def fly_px4(port):
    with socket.create_connection(("127.0.0.1", port), 60.0) as link:
        link.sendall(packet(0, struct.pack("<IBBBBB", 0, 2, 12, 0, 0, 3), 0))
        pilot, state, first = Pilot(), None, None
        kinds, level, still, last = {}, [], 0, 0
        for sequence, (number, payload) in enumerate(packets(link.makefile("rb"))):
            kinds[number] = kinds.get(number, 0) + 1
            if number == 115:
                (_, *q) = struct.unpack_from("<Q4f", payload)
                rates = struct.unpack_from("<3f", payload, 24)
                lat, lon, alt, vx, vy, vz = struct.unpack_from("<3i3h", payload, 36)
                at = lat * 1e-7, lon * 1e-7, alt * 1e-3
                first = first or at
                scale = math.radians(6_371_000.0)
                place = ((at[0] - first[0]) * scale,
                         (at[1] - first[1]) * scale * math.cos(math.radians(at[0])),
                         first[2] - at[2])  # fmt: skip
                state = place, (vx / 100.0, vy / 100.0, vz / 100.0), q, rates
            if number != 107:
                continue
            now, *rest = struct.unpack_from("<Q13fI", payload)
            assert now - last == 4000 or not last, (now, last)
            last = now
            flags = rest[-1]
            level.append((rest[:3], rest[3:6], rest[6:9], rest[9], flags, state[0]))
            if kinds[107] <= 50:  # as PX4, which takes some time to start
                continue
            told = pilot.fly(now * 1e-6, *state)
            if told is None:
                break
            if kinds[107] == 600:  # time must wait for the answer
                link.settimeout(0.3)
                before = kinds[107]
                time.sleep(0.3)
                link.setblocking(False)
                try:
                    still = len(link.recv(4096, socket.MSG_PEEK))
                except BlockingIOError:
                    still = 0
                link.setblocking(True)
                assert before == kinds[107]
            controls = struct.pack("<QQ16fB", now, 1, *told, *[0.0] * 12, 129)
            link.sendall(packet(93, controls, sequence))
        rest = level[0]
        moved = level[-1][3] - rest[3], level[-1][5][2] - rest[5][2]
        print(json.dumps({
            "kinds": kinds, "unasked": still, "rest": rest[:3],
            "flags": [one[4] for one in level[:6]],
            "hectopascals": moved[0], "down": moved[1], "same": rest[0] == level[1][0],
        }))  # fmt: skip


def fly_ardupilot(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.settimeout(60.0)
        link.connect(("127.0.0.1", port))
        pilot, frame, again, lines = Pilot(), 0, [], []
        widths = [1000] * 16
        while True:
            packed = struct.pack("<HHI16H", 18458, 500, frame, *widths)
            link.send(packed)
            line = link.recv(65535)
            if frame == 700:  # a packet that comes again lets no time pass
                link.send(packed)
                again = [json.loads(line)["timestamp"], json.loads(link.recv(65535))["timestamp"]]
            assert line[:1] == line[-1:] == b"\n"
            lines.append(line.decode())
            seen = json.loads(line)
            told = pilot.fly(seen["timestamp"], seen["position"], seen["velocity"],
                             seen["quaternion"], seen["imu"]["gyro"])  # fmt: skip
            if told is None:
                break
            widths = [round(1000 + 1000 * part) for part in told] + [1500] * 12
            frame += 1
        link.send(struct.pack("<HHI32H", 29569, 400, 0, *[1000] * 32))  # started anew
        print(json.dumps({"first": lines[0], "again": again, "range": seen["rng_1"],
                          "anew": json.loads(link.recv(65535))}))  # fmt: skip


if __name__ == "__main__":
    {"px4": fly_px4, "ardupilot": fly_ardupilot}[sys.argv[1]](int(sys.argv[2]))
