"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=True,
    brings={
        "eyas.settings": {"wire": "eyas.dat.wire.config:WireConfig"},
        "eyas.presets": {
            "dat-eval": "eyas.dat:presets/dat-eval.json",
            "dat-train": "eyas.dat:presets/dat-train.json",
        },
        "eyas.dialects": {"dat": "eyas.dat.settings.dialect:DAT"},
        "eyas.mesh_files": {".proto": "eyas.dat.proto_file:read_proto"},
        "eyas.map_formats": {"webots": "eyas.dat.webots.project:WEBOTS"},
        "eyas.commands": {"webots-shim": "eyas.dat.commands:webots_shim"},
    },
)
