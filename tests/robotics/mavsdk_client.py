"""A program that flies by MAVSDK, which knows nothing of Eyas: prints what it sees, as JSON.

python mavsdk_client.py PORT flight|lost|follow
"""

import json
import sys
import time
from contextlib import suppress

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.action import Action
from mavsdk.plugins.camera.camera import Camera, CameraError
from mavsdk.plugins.follow_me import FollowMe
from mavsdk.plugins.follow_me.follow_me import Config, FollowMeError, TargetLocation
from mavsdk.plugins.gimbal.gimbal import ControlMode, Gimbal, GimbalMode, SendMode
from mavsdk.plugins.mission_raw.mission_raw import MissionRaw
from mavsdk.plugins.offboard import Offboard
from mavsdk.plugins.offboard.offboard import PositionNedYaw, VelocityBodyYawspeed
from mavsdk.plugins.param.param import Param
from mavsdk.plugins.telemetry import Telemetry


def until(true, seconds=20.0):
    """Wait until something is so; return whether it is."""
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.02)
    return bool(true())


def said(**what):
    print(json.dumps(what), flush=True)


class Client:
    def __init__(self, port):
        kind = ComponentType.GROUND_STATION
        self.mavsdk = Mavsdk(Configuration.create_with_component_type(kind))
        self.mavsdk.add_any_connection(f"udpin://127.0.0.1:{port}")
        self.system = self.mavsdk.first_autopilot(60.0)
        self.telemetry, self.action = Telemetry(self.system), Action(self.system)
        self.offboard = Offboard(self.system)

    def place(self):
        at = self.telemetry.position_velocity_ned().position
        return [at.north_m, at.east_m, at.down_m]

    def take_off(self):
        said(healthy=until(self.telemetry.health_all_ok))
        self.action.set_takeoff_altitude(2.0)
        self.action.arm()
        self.action.takeoff()
        said(flies=until(lambda: self.telemetry.in_air() and self.place()[2] < -1.8))

    def fly_square(self):
        self.offboard.set_velocity_body(VelocityBodyYawspeed(0.0, 0.0, 0.0, 0.0))
        self.offboard.start()
        for corner in ((2, 0), (2, 2), (0, 2), (0, 0)):
            self.offboard.set_position_ned(PositionNedYaw(*map(float, corner), -2.0, 0.0))
            until(lambda to=corner: max(abs(a - b) for a, b in zip(self.place(), to)) < 0.15)  # noqa: B905
            said(corner=corner, place=self.place())
        self.offboard.stop()

    def turn_gimbal(self):
        gimbal = Gimbal(self.system)
        until(lambda: gimbal.gimbal_list().gimbals)
        (found,) = gimbal.gimbal_list().gimbals
        gimbal.take_control(found.gimbal_id, ControlMode.PRIMARY)
        gimbal.set_angles(found.gimbal_id, 0.0, -35.0, 20.0, GimbalMode.YAW_FOLLOW, SendMode.ONCE)

        def angles():
            at = gimbal.get_attitude(found.gimbal_id).euler_angle_forward
            return [at.pitch_deg, at.yaw_deg]

        until(lambda: abs(angles()[0] + 35.0) < 0.5 and abs(angles()[1] - 20.0) < 0.5)
        said(gimbal=angles())

    def use_camera(self):
        camera = Camera(self.system)
        until(lambda: camera.camera_list().cameras)
        (found,) = camera.camera_list().cameras
        said(camera=found.component_id, size=[found.horizontal_resolution_px,
                                              found.vertical_resolution_px])  # fmt: skip
        try:
            camera.track_rectangle(found.component_id, 0.0, 0.0, 1.0, 1.0)
            said(tracks="something")
        except CameraError:
            said(tracks="nothing")
        camera.track_stop(found.component_id)

    def ask(self):
        parameters = Param(self.system)
        found = parameters.get_all_params()
        said(parameters=len(found.float_params) + len(found.int_params),
             height=parameters.get_param_float("MIS_TAKEOFF_ALT"))  # fmt: skip
        said(mission=list(MissionRaw(self.system).download_mission()))

    def follow(self):
        """Let it follow someone who walks north; the plugin sends where only while it is active."""
        me = FollowMe(self.system)
        me.set_config(Config(8.0, 8.0, 0.5, Config.FollowAltitudeMode.CONSTANT, 5.0, 180.0))
        home = self.telemetry.home()
        north = 10.0

        def walk():
            nonlocal north
            north += 0.05
            there = home.latitude_deg + north / 111_195.0
            place = there, home.longitude_deg, home.absolute_altitude_m
            with suppress(FollowMeError):  # until it is active
                me.set_target_location(TargetLocation(*place, 1.0, 0.0, 0.0))
            time.sleep(0.05)
            return abs(self.place()[0] - (north - 8.0)) < 1.0 and north > 15.0

        walk()
        me.start()
        followed = until(walk, 30.0)
        said(active=me.is_active(), followed=followed, place=self.place(), north=north)
        me.stop()
        said(stopped=until(lambda: not me.is_active(), 5.0))

    def land(self):
        self.action.land()
        said(landed=until(lambda: not self.telemetry.armed(), 30.0))


def main():
    port, what = int(sys.argv[1]), sys.argv[2]
    client = Client(port)
    said(system=client.system.get_system_id())
    client.take_off()
    if what == "lost":
        client.offboard.set_velocity_body(VelocityBodyYawspeed(1.0, 0.0, 0.0, 0.0))
        client.offboard.start()
        said(offboard=True)
        time.sleep(600.0)  # it is killed
    if what == "follow":
        client.follow()
        client.land()
        return
    client.fly_square()
    client.turn_gimbal()
    client.use_camera()
    client.ask()
    client.land()


if __name__ == "__main__":
    main()
