"""Logs of flight controllers, made for the tests: a few messages each, byte by byte."""

import struct


def ulog(messages: dict[str, tuple[str, str, list[tuple]]]) -> bytes:
    """Return a log of PX4: by name of a message its format, its `struct` codes, and its rows."""

    def block(kind: str, content: bytes) -> bytes:
        return struct.pack("<HB", len(content), ord(kind)) + content

    log = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    log += block("B", bytes(40))
    for name, (form, _, _) in messages.items():
        log += block("F", f"{name}:{form}".encode())
    for number, name in enumerate(messages):
        log += block("A", struct.pack("<BH", 0, number) + name.encode())
    for number, (_, codes, rows) in enumerate(messages.values()):
        for row in rows:
            log += block("D", struct.pack("<H", number) + struct.pack(f"<{codes}", *row))
    return log


def dataflash(messages: dict[str, tuple[str, str, list[tuple]]]) -> bytes:
    """Return a log of ArduPilot: by name of a message its codes, its columns, and its rows."""
    codes = {"Q": "Q", "L": "i", "f": "f", "B": "B", "c": "h", "d": "d"}
    log = b""

    def described(kind: int, length: int, name: str, form: str, columns: str) -> bytes:
        head = struct.pack("<BBBBB", 0xA3, 0x95, 128, kind, length)
        return head + struct.pack("<4s16s64s", name.encode(), form.encode(), columns.encode())

    log += described(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
    for number, (name, (form, columns, _)) in enumerate(messages.items()):
        length = 3 + struct.calcsize("<" + "".join(codes[code] for code in form))
        log += described(10 + number, length, name, form, columns)
    for number, (form, _, rows) in enumerate(messages.values()):
        packed = "<" + "".join(codes[code] for code in form)
        for row in rows:
            log += bytes([0xA3, 0x95, 10 + number]) + struct.pack(packed, *row)
    return log


def px4_flight(count: int = 20) -> bytes:
    """Return a flight of PX4 to the north from 51.5 N, 0.1 W, at 10 m/s."""
    rows = [(1_000_000 + 100_000 * k, 51.5 + 9e-6 * k, -0.1, 20.0 + k) for k in range(count)]
    turn = [(1_000_000 + 100_000 * k, 1.0, 0.0, 0.0, 0.0) for k in range(count)]
    return ulog(
        {
            "vehicle_global_position": (
                "uint64_t timestamp;double lat;double lon;float alt;",
                "Qddf",
                rows,
            ),
            "vehicle_attitude": ("uint64_t timestamp;float[4] q;", "Q4f", turn),
        }
    )


def ardupilot_flight(count: int = 20) -> bytes:
    """Return a flight of ArduPilot to the north from 51.5 N, 0.1 W, at 10 m/s, nose east."""
    rows = [
        (1_000_000 + 100_000 * k, round(1e7 * (51.5 + 9e-6 * k)), -1_000_000, 20.0 + k)
        for k in range(count)
    ]
    turn = [(1_000_000 + 100_000 * k, 9000) for k in range(count)]
    gps = [(1_000_000, 3, 0, 0), (2_000_000, 3, 0, 0)]
    return dataflash(
        {
            "GPS": ("QBBB", "TimeUS,Status,GMS,GWk", gps[:0]),
            "POS": ("QLLf", "TimeUS,Lat,Lng,Alt", rows),
            "ATT": ("Qc", "TimeUS,Yaw", turn),
        }
    )


def telemetry(count: int = 20, version: int = 2) -> bytes:
    """Return what a ground station keeps of the same flight, in packets of MAVLink 1 or 2, between
    heartbeats.
    """

    def packet(kind: int, payload: bytes) -> bytes:
        if version == 1:
            head = bytes([0xFE, len(payload), 0, 7, 1, kind])
        else:
            payload = payload.rstrip(b"\0") or b"\0"
            head = bytes([0xFD, len(payload), 0, 0, 0, 7, 1, kind, 0, 0])
        return head + payload + b"\x12\x34"

    log = b""
    for k in range(count):
        when = struct.pack(">Q", 1_777_000_000_000_000 + 100_000 * k)
        place = (100 * k, round(1e7 * (51.5 + 9e-6 * k)), -1_000_000, 20_000 + 1000 * k)
        log += when + packet(0, struct.pack("<IBBBBB", 0, 2, 3, 81, 4, version))
        log += when + packet(33, struct.pack("<IiiiihhhH", *place, 0, 0, 1000, 0, 9000))
    return log
