"""Time that stands still until a set point has come."""

import math
import socket
import threading
import time

import numpy as np
import pytest
from pymavlink.dialects.v20 import common

from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.sim.serving import serve
from eyas.robotics.mavlink.endpoint import Endpoint
from eyas.robotics.mavlink.pilot import FlightMode

GCS = (255, 190)


class StopError(Exception):
    pass


def packet(kind, **fields):
    message = getattr(common, f"MAVLink_{kind}_message")(**fields)
    return message.pack(common.MAVLink(None, 255, 190))


def velocity(north):
    return packet(
        "set_position_target_local_ned", time_boot_ms=0, target_system=1, target_component=1,
        coordinate_frame=1, type_mask=0b0101_1100_0111, x=0, y=0, z=0, vx=north, vy=0, vz=0,
        afx=0, afy=0, afz=0, yaw=0, yaw_rate=0,
    )  # fmt: skip


def counted(fleet, steps, end):
    """Note the time of each step of a fleet, and stop after some."""
    answer = fleet.answer

    def noted(**words):
        steps.append(fleet.now)
        answer(**words)
        if len(steps) == end:
            raise StopError

    fleet.answer = noted


def test_each_set_point_is_one_step(make_bench):
    bench = make_bench(mavlink={"lockstep": True})
    bench.fly_up()
    bench.velocity(1, 0, 0)
    bench.command("DO_SET_MODE", 1, 6, 0)
    bench.loop.step()
    endpoint = Endpoint("udpin:127.0.0.1:0".replace(":0", f":{free_port()}"))
    steps, begun = [], bench.fleet.now
    counted(bench.fleet, steps, 20)
    bench.fleet._endpoints = [endpoint]

    def client():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            out.connect(endpoint.socket.getsockname())
            out.settimeout(30.0)
            time.sleep(0.3)
            assert not steps  # time stands still
            for _ in range(20):
                before = len(steps)
                out.send(velocity(2.0))
                while len(steps) == before:
                    out.recv(65_535)

    flies = threading.Thread(target=client)
    flies.start()
    with pytest.raises(StopError):
        serve(bench.fleet)
    flies.join()
    endpoint.close()
    assert bench.fleet.now - begun == pytest.approx(0.2)
    assert bench.pilot.mode is FlightMode.OFFBOARD


def test_a_ground_station_does_not_keep_time_still_for_a_program_that_has_died(
    make_bench, monkeypatch
):
    bench = make_bench(vehicles=2, mavlink={"vehicles": 2, "lockstep": True})
    bench.fly_up()
    assert bench.command("COMPONENT_ARM_DISARM", 1, system=2) == 0
    for system in (1, 2):
        bench.velocity(1, 0, 0, system=system)
        bench.command("DO_SET_MODE", 1, 6, 0, system=system)
    assert bench.loop.step()
    monkeypatch.setattr("eyas.robotics.mavlink.fleet._PATIENCE", 0.3)
    before, received = bench.fleet.now, bench.line.received

    def others_go_on():
        time.sleep(0.01)
        bench.beat()  # a ground station
        bench.velocity(1, 0, 0, system=2)  # its program lives
        return received()

    def send(kind, sender=GCS, **fields):
        message = getattr(common, f"MAVLink_{kind}_message")(**fields)
        packet = message.pack(common.MAVLink(None, *sender))
        bench.line.coming += common.MAVLink(None).parse_buffer(packet)

    bench.send, bench.line.received = send, others_go_on
    counted(bench.fleet, [], 1)
    with pytest.raises(StopError):
        serve(bench.fleet)
    assert bench.fleet.now > before
    assert [vehicle.pilot.mode for vehicle in bench.fleet.vehicles] == [
        FlightMode.HOLD,
        FlightMode.OFFBOARD,
    ]


def test_the_same_set_points_give_the_same_flight(make_bench):
    ends = []
    for _ in range(2):
        bench = make_bench()
        bench.fly_up()
        for at in range(60):
            bench.velocity(2.0, 0.1 * at, 0)
            bench.command("DO_SET_MODE", 1, 6, 0)
            bench.loop.step()
        state = bench.simulation.snapshot.trackers
        ends.append(np.concatenate([state.position[0], state.orientation[0]]))
    assert (ends[0] == ends[1]).all()


def test_several_vehicles_are_flown_by_their_system_ids(make_bench):
    bench = make_bench(vehicles=3, mavlink={"vehicles": 3, "first_system": 7})
    assert [bench.command("COMPONENT_ARM_DISARM", 1, system=at) for at in (7, 8, 9, 10)] == [
        *(0, 0, 0),
        None,
    ]
    assert bench.command("NAV_TAKEOFF", system=8) == 0
    bench.fly(4.0)
    height = bench.simulation.snapshot.trackers.position[:, 2]
    assert height[1] > 2.0 > 0.5 > max(height[0], height[2])
    assert {m.get_srcSystem() for m in bench.taken()} == {7, 8, 9}


def test_when_the_traffic_ends_vehicles_stay_where_they_are(bench):
    bench.fly_up()
    before = bench.simulation.snapshot.trackers.position.copy()
    ticks = bench.simulation.snapshot.episodes.tick
    bench.command("DO_GIMBAL_MANAGER_PITCHYAW", -60, 20, math.nan, math.nan, 0, 0, 0)
    bench.fly(0.5)
    looks = bench.simulation.snapshot.trackers.commanded_gimbal.copy()
    ticks += bench.simulation.steps_left - 2
    bench.loop.step()
    assert ticks[0] < 5000
    assert (bench.simulation.snapshot.trackers.commanded_gimbal == looks).all()
    bench.fly(0.5)
    after = bench.simulation.snapshot.trackers.position
    np.testing.assert_allclose(after, before, atol=0.05)
    assert ticks[0] < 5000


@pytest.mark.parametrize("text", ["tcp:127.0.0.1:1", "udp:127.0.0.1", "14540", "udp:no.host.:1"])
def test_addresses_that_are_none_are_told(text):
    with pytest.raises(ConfigError, match="--mavlink"):
        Endpoint(text)


def test_a_port_that_is_taken_is_told():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        with pytest.raises(OutputError, match="cannot listen"):
            Endpoint(f"udpin:127.0.0.1:{other.getsockname()[1]}")


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as some:
        some.bind(("127.0.0.1", 0))
        return some.getsockname()[1]


def test_what_is_sent_to_this_machine_hears_only_this_machine():
    endpoint = Endpoint(f"udp:127.0.0.1:{free_port()}")
    assert endpoint.socket.getsockname()[0] == "127.0.0.1"
    endpoint.close()
