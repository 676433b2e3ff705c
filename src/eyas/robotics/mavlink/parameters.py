"""The parameters of a vehicle: names, units and defaults of PX4, those that mean something here."""

import struct
from typing import Any

from eyas.robotics.mavlink.component import Component

DEFAULTS: dict[str, float | int] = {
    "COM_DISARM_LAND": 2.0,  # on the ground, after landing, it disarms [s]
    "COM_DISARM_PRFLT": 10.0,  # armed, without taking off, it disarms [s]
    "COM_DL_LOSS_T": 10,  # without a ground station's heartbeat, it holds [s]
    "COM_OF_LOSS_T": 1.0,  # without a set point in offboard mode, it holds [s]
    "FLW_TGT_ALT_M": 0,  # it, _FA, _MAX_VEL and _RS have no effect; MAVSDK sets them
    "FLW_TGT_DST": 8.0,  # distance kept from what it follows [m]
    "FLW_TGT_HT": 8.0,  # height over the place of take-off while it follows [m]
    "FLW_TGT_FA": 180.0,
    "FLW_TGT_MAX_VEL": 5.0,
    "FLW_TGT_RS": 0.1,
    "MIS_TAKEOFF_ALT": 2.5,  # height of take-off [m]
    "MPC_ACC_HOR": 5.0,  # [m/s^2]
    "MPC_LAND_SPEED": 0.7,  # [m/s]
    "MPC_TKO_SPEED": 1.5,  # [m/s]
    "MPC_XY_CRUISE": 5.0,  # on the way to a place [m/s]
    "MPC_XY_VEL_MAX": 12.0,  # [m/s]
    "MPC_Z_VEL_MAX_DN": 1.5,  # [m/s]
    "MPC_Z_VEL_MAX_UP": 3.0,  # [m/s]
    "RTL_RETURN_ALT": 30.0,  # least height on the way home [m]
    "SYS_AUTOSTART": 4001,  # a quadrotor
}
"""Whole numbers are of the type INT32, others of REAL32."""

_REAL, _WHOLE = 9, 6


class Parameters:
    """Answers MAVLink's parameter protocol.

    Attributes:
        values: The values by name; they change in place.
    """

    def __init__(self) -> None:
        self.values = dict(DEFAULTS)

    def __getitem__(self, name: str) -> float:
        return float(self.values[name])

    def answer(self, component: Component, message: Any) -> None:  # noqa: ANN401  # pymavlink's
        """Answer a request for one or all, or a change."""
        names = list(self.values)
        match message.get_type():
            case "PARAM_REQUEST_LIST":
                for name in names:
                    self._tell(component, name)
            case "PARAM_REQUEST_READ":
                at = message.param_index
                name = names[at] if 0 <= at < len(names) else message.param_id
                if name in self.values:
                    self._tell(component, name)
            case "PARAM_SET" if message.param_id in self.values:
                self._set(message.param_id, message.param_value, message.param_type)
                self._tell(component, message.param_id)

    def _set(self, name: str, value: float, kind: int) -> None:
        """Change a parameter; one of the wrong type, or below 0, stays, and is told as it is."""
        whole = isinstance(self.values[name], int)
        if kind != (_WHOLE if whole else _REAL):
            return
        new: float | int = value
        if whole:
            (new,) = struct.unpack("<i", struct.pack("<f", value))
        if 0.0 <= new <= 1e6:  # no for what is not a number
            self.values[name] = new

    def _tell(self, component: Component, name: str) -> None:
        value = self.values[name]
        whole = isinstance(value, int)
        if whole:  # its bits in the place of those of a float, as the capabilities say
            (value,) = struct.unpack("<f", struct.pack("<i", value))
        component.send(
            "param_value",
            param_id=name.encode(),
            param_value=value,
            param_type=_WHOLE if whole else _REAL,
            param_count=len(self.values),
            param_index=list(self.values).index(name),
        )
