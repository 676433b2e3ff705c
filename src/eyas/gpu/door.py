"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=True,
    brings={
        "eyas.devices": {
            "cuda": "eyas.gpu.envs.envs:DeviceEnvs",
            "host": "eyas.gpu.envs.envs:DeviceEnvs",
        }
    },
)
