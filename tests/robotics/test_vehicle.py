"""Packets as ground stations and programs send them, and what a vehicle makes of them."""

import math
import random

import numpy as np
import pytest

from eyas.robotics.mavlink.pilot import FlightMode, Landed

ACCEPTED, REJECTED, DENIED, UNSUPPORTED, FAILED = range(5)
GCS, OTHER = (255, 190), (254, 190)
NAN = math.nan
OFFBOARD = (1, 6, 0)


def place(bench):
    message = bench.last("LOCAL_POSITION_NED")
    return np.array([message.x, message.y, message.z])


def test_what_it_tells_agrees_with_the_simulation(bench):
    bench.fly_up()
    bench.taken()
    bench.fly(2.0)
    messages = bench.taken()
    told = {message.get_type(): message for message in messages}
    state = bench.simulation.snapshot.trackers
    east, north, up = state.position[0] - bench.fleet.vehicles[0]._origin
    local, earth, attitude = (
        told[kind] for kind in ("LOCAL_POSITION_NED", "GLOBAL_POSITION_INT", "ATTITUDE")
    )
    assert (local.x, local.y, local.z) == pytest.approx((north, east, -up), abs=1e-3)
    assert earth.relative_alt == pytest.approx(up * 1e3, abs=2)
    assert attitude.yaw == pytest.approx(math.pi / 2 - state.euler[0, 2], abs=1e-3)
    assert told["HIGHRES_IMU"].zacc == pytest.approx(-9.81, abs=0.1)
    assert told["EXTENDED_SYS_STATE"].landed_state == 2
    assert told["HEARTBEAT"].get_srcSystem() == 1
    wanted = {"SYS_STATUS", "BATTERY_STATUS", "GPS_RAW_INT", "HOME_POSITION", "ALTITUDE"}
    wanted |= {"ATTITUDE_QUATERNION", "GIMBAL_MANAGER_STATUS", "GIMBAL_DEVICE_ATTITUDE_STATUS"}
    assert wanted <= set(told)
    assert {m.get_srcComponent() for m in messages} == {1, 100, 154}


def test_it_takes_off_holds_returns_and_disarms(bench):
    assert bench.command("NAV_TAKEOFF") == REJECTED  # not armed
    bench.fly_up()
    assert place(bench)[2] == pytest.approx(-5.0, abs=0.1)
    assert (bench.pilot.mode, bench.pilot.landed) == (FlightMode.HOLD, Landed.AIR)
    assert bench.command("COMPONENT_ARM_DISARM", 0) == DENIED  # in flight
    assert bench.command("NAV_RETURN_TO_LAUNCH") == ACCEPTED
    bench.fly(12.0)
    assert (bench.pilot.armed, bench.pilot.landed) == (False, Landed.GROUND)
    assert place(bench) == pytest.approx([0.0, 0.0, 0.0], abs=0.1)


def test_a_drone_that_follows_its_commands_exactly_can_be_flown_too(make_bench):
    bench = make_bench(tracker={"supervised": True, "ground_contact": False})
    bench.fly_up()
    assert place(bench)[2] == pytest.approx(-5.0, abs=0.05)
    assert bench.command("NAV_LAND") == ACCEPTED
    bench.fly(10.0)
    assert (bench.pilot.armed, bench.pilot.landed) == (False, Landed.GROUND)


@pytest.mark.parametrize(
    ("frame", "sent", "north_east_down"),
    [(1, (2, 0, 0), (2, 0, 0)), (1, (0, 3, -1), (0, 3, -1)), (8, (2, 0, 0), (0, 2, 0)),
     (12, (0, 2, 0), (-2, 0, 0))],
)  # fmt: skip
def test_set_points_of_velocity_are_flown_in_their_frame(bench, frame, sent, north_east_down):
    bench.fly_up()  # it looks east
    assert bench.command("DO_SET_MODE", *OFFBOARD) == REJECTED  # no set point yet
    for _ in range(25):
        bench.velocity(*sent, frame=frame)
        if bench.pilot.mode is not FlightMode.OFFBOARD:
            assert bench.command("DO_SET_MODE", *OFFBOARD) == ACCEPTED
        bench.fly(0.1)
    message = bench.last("LOCAL_POSITION_NED")
    assert (message.vx, message.vy, message.vz) == pytest.approx(north_east_down, abs=0.15)


def test_yaw_rates_turn_clockwise(bench):
    bench.fly_up()
    bench.velocity(0, 0, 0, rate=0.5)
    bench.command("DO_SET_MODE", *OFFBOARD)
    bench.fly(0.8)
    assert bench.last("ATTITUDE").yawspeed == pytest.approx(0.5, abs=0.05)


def test_set_points_of_place_and_heading_are_reached(bench):
    bench.fly_up()
    for _ in range(12):
        bench.send(
            "set_position_target_local_ned",
            **{"time_boot_ms": 0, "target_system": 1, "target_component": 1},
            **{"coordinate_frame": 1, "type_mask": 0b1001_1111_1000, "x": 4, "y": -3, "z": -6},
            **dict.fromkeys(("vx", "vy", "vz", "afx", "afy", "afz", "yaw_rate"), 0), yaw=1.0,
        )  # fmt: skip
        bench.command("DO_SET_MODE", *OFFBOARD)
        bench.fly(0.8)
    assert place(bench) == pytest.approx([4.0, -3.0, -6.0], abs=0.1)
    bench.fly(0.1)
    assert bench.last("ATTITUDE").yaw == pytest.approx(1.0, abs=0.02)


def test_without_set_points_it_holds(bench):
    bench.fly_up()
    bench.velocity(3, 0, 0)
    bench.command("DO_SET_MODE", *OFFBOARD)
    bench.taken()
    bench.fly(1.5)
    assert bench.pilot.mode is FlightMode.HOLD
    texts = [m.text for m in bench.taken() if m.get_type() == "STATUSTEXT"]
    assert texts == ["Offboard set points lost: holding"]
    bench.fly(2.0)
    message = bench.last("LOCAL_POSITION_NED")
    assert (message.vx, message.vy) == pytest.approx((0.0, 0.0), abs=0.05)


def test_without_a_ground_station_it_holds(bench):
    bench.fly_up()
    bench.pilot.parameters.values["COM_DL_LOSS_T"] = 2
    for _ in range(30):
        bench.velocity(1, 0, 0)
        bench.command("DO_SET_MODE", *OFFBOARD)
        bench.fly(0.1, beat=None)
        if bench.pilot.mode is FlightMode.HOLD:
            break
    assert bench.pilot.mode is FlightMode.HOLD
    bench.beat()
    bench.fly(0.1)
    assert "Ground station connected" in {m.text for m in bench.taken() if hasattr(m, "text")}


def test_it_follows_what_leads(bench):
    bench.fly_up(8.0)
    leader = np.array([30.0, 0.0])
    geodesy, origin = bench.fleet._readings.geodesy, bench.fleet.vehicles[0]._origin
    assert bench.command("DO_SET_MODE", 1, 4, 8) == ACCEPTED
    for _ in range(40):
        leader += (0.0, 0.5)
        degrees = geodesy.degrees(origin[0] + leader[0], origin[1] + leader[1])
        latitude, longitude = (round(part * 1e7) for part in degrees)
        bench.send("follow_target", timestamp=0, est_capabilities=3, lat=latitude, lon=longitude,
                   alt=488.0, vel=[2.0, 0.0, 0.0], acc=[0.0] * 3, attitude_q=[1.0, 0, 0, 0],
                   rates=[0.0] * 3, position_cov=[0.0] * 3, custom_state=0)  # fmt: skip
        bench.fly(0.25)
    north, east, down = place(bench)
    assert math.hypot(north - leader[1], east - leader[0]) == pytest.approx(8.0, abs=0.5)
    assert down == pytest.approx(-8.0, abs=0.2)


def test_a_place_on_the_earth_is_flown_to(bench):
    bench.fly_up()
    geodesy, origin = bench.fleet._readings.geodesy, bench.fleet.vehicles[0]._origin
    latitude, longitude = geodesy.degrees(origin[0] + 6.0, origin[1] + 4.0)
    bench.send(
        "command_int", target_system=1, target_component=1, frame=6, command=192, current=0,
        autocontinue=0, param1=-1, param2=0, param3=0, param4=NAN, x=round(latitude * 1e7),
        y=round(longitude * 1e7), z=7.0,
    )  # fmt: skip
    bench.fly(7.0)
    assert place(bench) == pytest.approx([4.0, 6.0, -7.0], abs=0.15)


def test_others_systems_and_components_are_left_alone(bench):
    assert bench.command("COMPONENT_ARM_DISARM", 1, system=2) is None
    assert bench.command("COMPONENT_ARM_DISARM", 1, component=191) is None
    assert bench.command("COMPONENT_ARM_DISARM", 1, sender=(1, 1)) is None  # its own number
    assert not bench.pilot.armed
    assert bench.command("COMPONENT_ARM_DISARM", 1, system=1, component=0) == ACCEPTED


def test_unknown_commands_are_answered(bench):
    assert bench.command("NAV_VTOL_TAKEOFF") == UNSUPPORTED
    assert bench.command("DO_SET_MODE", 1, 5, 0) == UNSUPPORTED  # acrobatics
    assert bench.command("REQUEST_MESSAGE", 3_000_000) == UNSUPPORTED
    assert bench.command("CAMERA_TRACK_POINT", NAN, 0.5, 0, component=100) == DENIED


def test_messages_are_sent_as_often_as_asked_for(bench):
    assert bench.command("SET_MESSAGE_INTERVAL", 31, 10_000) == ACCEPTED  # ATTITUDE_QUATERNION
    assert bench.command("SET_MESSAGE_INTERVAL", 30, -1) == ACCEPTED  # ATTITUDE
    assert bench.command("GET_MESSAGE_INTERVAL", 31) == ACCEPTED
    assert bench.answers[-1].interval_us == 10_000
    bench.taken()
    bench.fly(1.0)
    kinds = [message.get_type() for message in bench.taken()]
    assert (kinds.count("ATTITUDE_QUATERNION"), kinds.count("ATTITUDE")) == (100, 0)
    assert bench.command("REQUEST_MESSAGE", 148) == ACCEPTED
    assert bench.answers[-1].get_type() == "AUTOPILOT_VERSION"


def test_missions_are_refused(bench):
    bench.taken()
    to = {"target_system": 1, "target_component": 1, "mission_type": 0}
    bench.send("mission_request_list", **to)
    assert bench.last("MISSION_COUNT").count == 0
    bench.send("mission_count", count=3, **to)
    assert bench.last("MISSION_ACK").type == 3


def test_the_gimbal_obeys_who_has_taken_it(bench):
    bench.fly_up()
    assert bench.command("DO_GIMBAL_MANAGER_CONFIGURE", -2, -2) == ACCEPTED
    turn = ("DO_GIMBAL_MANAGER_PITCHYAW", -40, 25, NAN, NAN, 0, 0, 0)
    assert bench.command(*turn, sender=OTHER) == DENIED
    assert bench.command(*turn) == ACCEPTED
    bench.fly(1.0)
    forward = bench.simulation.snapshot.cameras.rotation[0, :, 0]
    assert math.degrees(math.asin(forward[2])) == pytest.approx(-40.0, abs=0.5)
    assert math.degrees(math.atan2(forward[1], forward[0])) == pytest.approx(-25.0, abs=0.5)
    w, x, y, z = bench.last("GIMBAL_DEVICE_ATTITUDE_STATUS").q
    assert math.degrees(math.asin(2 * (w * y - z * x))) == pytest.approx(-40.0, abs=0.5)
    assert bench.command("DO_GIMBAL_MANAGER_CONFIGURE", -3, -3, sender=OTHER) == DENIED
    assert bench.command("DO_GIMBAL_MANAGER_CONFIGURE", -3, -3) == ACCEPTED
    assert bench.command(*turn, sender=OTHER) == ACCEPTED


def test_the_gimbal_keeps_looking_at_a_place(bench):
    bench.fly_up(10.0)
    geodesy, origin = bench.fleet._readings.geodesy, bench.fleet.vehicles[0]._origin
    latitude, longitude = geodesy.degrees(origin[0] + 10.0, origin[1] + 5.0)
    assert bench.command("DO_SET_ROI_LOCATION", NAN, NAN, NAN, NAN, latitude, longitude, 488) == 0
    for _ in range(20):
        bench.velocity(-2, 0, 0)
        bench.command("DO_SET_MODE", *OFFBOARD)
        bench.fly(0.1)
    bench.velocity(0, 0, 0)
    bench.fly(0.9)
    cameras = bench.simulation.snapshot.cameras
    way = np.array([origin[0] + 10.0, origin[1] + 5.0, 0.0]) - cameras.position[0]
    assert cameras.rotation[0, :, 0] @ way / np.linalg.norm(way) > 0.999


def test_it_tracks_what_is_shown_and_tells_where_it_is(bench):
    bench.fly_up()
    bench.stay_over_target()
    targets = bench.simulation.snapshot.targets
    actor = int(targets.actor[0])
    bench.simulation.follow(0, actor + 1)  # the camera must find it
    assert bench.command("CAMERA_TRACK_RECTANGLE", 0.3, 0.2, 0.7, 0.8, component=100) == ACCEPTED
    assert int(targets.actor[0]) == actor
    bench.taken()
    bench.fly(0.5)
    told = {message.get_type(): message for message in bench.taken()}
    status, earth = (told[f"CAMERA_TRACKING_{what}_STATUS"] for what in ("IMAGE", "GEO"))
    assert (status.tracking_status, status.tracking_mode) == (1, 2)
    seen = bench.fleet._sights.seen(0)
    assert (status.rec_top_x, status.rec_bottom_y) == pytest.approx(
        (seen.left, seen.bottom), abs=0.15
    )
    assert earth.dist == pytest.approx(25.0, abs=4.0)
    assert bench.command("CAMERA_STOP_TRACKING", component=100) == ACCEPTED
    bench.fly(0.5)
    assert not any(m.get_type() == "CAMERA_TRACKING_GEO_STATUS" for m in bench.taken())
    assert bench.command("CAMERA_TRACK_POINT", 0.0, 0.0, 0.0, component=100) in (ACCEPTED, FAILED)


def test_a_target_out_of_sight_is_told_as_an_error(bench):
    bench.fly_up()
    bench.stay_over_target()
    assert bench.command("CAMERA_TRACK_RECTANGLE", 0.2, 0.2, 0.8, 0.8, component=100) == ACCEPTED
    bench.command("DO_GIMBAL_MANAGER_PITCHYAW", 20, 0, NAN, NAN, 0, 0, 0)
    bench.fly(2.0)
    assert bench.last("CAMERA_TRACKING_IMAGE_STATUS").tracking_status == 2


def refusal(bench, x, y):
    """Return the answer to a point to track, and the text beside it."""
    answer = bench.command("CAMERA_TRACK_POINT", x, y, 0.0, component=100)
    return answer, *(m.text for m in bench.answers if m.get_type() == "STATUSTEXT")


def test_why_a_point_is_not_tracked_is_said(bench):
    bench.fly_up()
    bench.stay_over_target()
    outside = "Not tracked: outside the picture: 0 to 1 in x, y"
    assert refusal(bench, 1.5, 0.5) == (DENIED, outside)
    assert refusal(bench, 0.0, 0.0) == (FAILED, "Not tracked: no vehicle or person there")
    bench.command("DO_GIMBAL_MANAGER_PITCHYAW", -2, 0, NAN, NAN, 0, 0, 0)
    bench.fly(2.0)
    x, y, z = bench.simulation.snapshot.targets.position[0]
    pose = np.array([[x - 70.0, y, z + 3.0, 0.0]])  # others stand between
    bench.simulation.start_at(np.arange(1), pose, np.full(1, math.radians(2.0)))
    bench.fly(0.02)
    assert bench.command("CAMERA_TRACK_RECTANGLE", 0.3, 0.3, 0.7, 0.7, component=100) == FAILED
    assert "Not tracked: what is there is hidden" in [getattr(m, "text", "") for m in bench.answers]


def test_the_camera_zooms(bench):
    before = float(bench.simulation.snapshot.cameras.field_of_view[0])
    assert bench.command("SET_CAMERA_ZOOM", 2, 100, component=100) == ACCEPTED
    bench.fly(0.1)
    now = float(bench.simulation.snapshot.cameras.field_of_view[0])
    assert math.tan(before / 2) / math.tan(now / 2) == pytest.approx(4.0)


def test_garbage_changes_nothing(bench):
    from pymavlink.dialects.v20 import common

    from eyas.robotics.mavlink.endpoint import Parser

    rng, parser = random.Random(3), Parser()
    whole = common.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(common.MAVLink(None, 255, 190))
    for _ in range(300):
        damaged = bytearray(whole)
        damaged[rng.randrange(len(damaged))] ^= 1 << rng.randrange(8)
        noise = rng.randbytes(rng.randrange(300))
        for datagram in (
            noise,
            bytes(damaged),
            b"\xfd" + noise,
            whole[: rng.randrange(len(whole))],
        ):
            bench.hear(parser.messages(datagram))
    assert parser.messages(b"\xfd\xff" + noise + whole) is not None
    assert [m.get_type() for m in parser.messages(whole)] == ["HEARTBEAT"]
    bench.fly(0.5)
    assert not bench.pilot.armed


def test_numbers_that_are_none_change_nothing(bench):
    bench.fly_up()
    bench.velocity(NAN, NAN, NAN)
    bench.command("DO_SET_MODE", *OFFBOARD)
    bench.velocity(math.inf, 0, 0)
    bench.fly(0.8)
    assert np.isfinite(bench.simulation.snapshot.trackers.position).all()
    for params in ((NAN,) * 7, (math.inf,) * 7, (1e30,) * 7):
        for command in ("DO_SET_MODE", "NAV_TAKEOFF", "DO_REPOSITION", "DO_SET_HOME",
                        "DO_GIMBAL_MANAGER_PITCHYAW", "DO_GIMBAL_MANAGER_CONFIGURE",
                        "DO_SET_ROI_LOCATION", "SET_MESSAGE_INTERVAL", "REQUEST_MESSAGE",
                        "DO_CHANGE_SPEED", "COMPONENT_ARM_DISARM"):  # fmt: skip
            assert bench.command(command, *params) is not None
    bench.fly(0.5)
    assert np.isfinite(bench.simulation.snapshot.trackers.position).all()


def test_a_message_that_cannot_be_handled_is_a_line(bench, caplog):
    def fail(message):
        raise LookupError("at the worst\nmoment")

    bench.fleet.vehicles[0]._components[1].handlers["HEARTBEAT"] = fail
    bench.beat()
    bench.beat()
    (record,) = caplog.records
    assert record.getMessage() == (
        "HEARTBEAT from 255/190 ignored: LookupError: at the worst\\nmoment"
    )
    assert bench.command("COMPONENT_ARM_DISARM", 1) == ACCEPTED


def test_what_is_faster_than_a_message_can_hold_is_told_as_its_largest_number(make_bench):
    bench = make_bench(tracker={"supervised": True, "ground_contact": False})
    fast = {"MPC_XY_VEL_MAX": 1e6, "MPC_ACC_HOR": 1e6, "MPC_Z_VEL_MAX_UP": 1e6}
    bench.fly_up()
    bench.pilot.parameters.values |= fast
    bench.velocity(-9e4, 9e4, -9e4)
    assert bench.command("DO_SET_MODE", *OFFBOARD) == ACCEPTED
    bench.fly(0.5)
    told = bench.last("GLOBAL_POSITION_INT")
    assert (told.vx, told.vy) == (-32768, 32767)


def test_a_companion_computer_has_its_vehicles_system_id(bench):
    companion = (1, 191)
    assert bench.command("COMPONENT_ARM_DISARM", 1, sender=companion) == ACCEPTED
    assert bench.command("NAV_TAKEOFF", sender=companion) == ACCEPTED
    assert bench.command("NAV_LAND", sender=(1, 1)) is None  # an echo of its own


def test_messages_of_all_kinds_with_any_content_change_nothing(bench):
    from pymavlink.dialects.v20 import common

    rng = random.Random(5)
    for kind in sorted(common.mavlink_map) * 3:
        body = rng.randbytes(common.mavlink_map[kind].unpacker.size)
        head = bytes((0xFD, len(body), 0, 0, 0, 255, 190)) + kind.to_bytes(3, "little")
        crc = common.x25crc(head[1:] + body)
        crc.accumulate(bytes((common.mavlink_map[kind].crc_extra,)))
        for message in common.MAVLink(None).parse_buffer(
            head + body + crc.crc.to_bytes(2, "little")
        ):
            if hasattr(message, "target_system"):
                message.target_system, message.target_component = 1, rng.choice((0, 1, 100, 154))
            if hasattr(message, "command"):
                message.command = rng.choice(sorted(common.enums["MAV_CMD"]))
            bench.hear([message])
    bench.fly(0.5)
    assert np.isfinite(bench.simulation.snapshot.trackers.position).all()
    assert bench.taken()


def test_all_components_tell_that_it_follows_as_mavsdks_follow_me_wants(bench):
    def modes():
        bench.taken()
        bench.fly(1.1)
        beats = [m for m in bench.taken() if m.get_type() == "HEARTBEAT"]
        return {m.get_srcComponent(): (m.base_mode & 1, m.custom_mode) for m in beats}

    bench.fly_up()
    assert {at: mode for at, mode in modes().items() if at != 1} == {100: (0, 0), 154: (0, 0)}
    assert bench.command("DO_SET_MODE", 1, 4, 8) == 0
    assert modes() == dict.fromkeys((1, 100, 154), (1, 4 << 16 | 8 << 24))


def test_compass_and_barometer_are_sensors_of_the_table(make_bench):
    field = {"sensor": "compass", "settings": {"east": 0.0, "north": 0.4, "up": 0.1}}
    bench = make_bench(sensors={"further": [field, {"sensor": "barometer", "bias": 5.0}]})
    bench.taken()
    bench.fly(0.1)
    told = [m for m in bench.taken() if m.get_type() == "HIGHRES_IMU"][-1]
    yaw = float(bench.simulation.snapshot.trackers.euler[0, 2])
    ahead, left = math.cos(yaw), math.sin(yaw)
    assert (told.xmag, told.ymag) == pytest.approx((0.4 * left, -0.4 * ahead), abs=0.005)
    assert told.zmag == pytest.approx(-0.1, abs=0.005)
    (read,) = bench.simulation.readings()["pressure"][0].tolist()
    assert told.abs_pressure == pytest.approx(read)
    usual = make_bench()
    usual.taken()
    usual.fly(0.1)
    exact = [m for m in usual.taken() if m.get_type() == "HIGHRES_IMU"][-1]
    assert exact.abs_pressure == pytest.approx(1013.25 * (1 - 2.25577e-5 * 488) ** 5.25588, abs=0.2)
    assert abs(told.abs_pressure - exact.abs_pressure) > 0.2
    usual.fly_up(20.0)
    high = [m for m in usual.taken() if m.get_type() == "HIGHRES_IMU"][-1]
    assert exact.abs_pressure - high.abs_pressure == pytest.approx(20.0 * 0.114, abs=0.1)
