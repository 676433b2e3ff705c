"""Print the keys of what Eyas makes, after each of some edits of its sources.

python keys_after_edits.py EDITS    # where PYTHONPATH names a copy of the package

EDITS: JSON, a list of edits; each is a list of (file, text, new text). One after the other is made,
and undone. The keys before any edit come first.
"""

import json
import sys
from pathlib import Path

import eyas
from eyas.engine.core.cache.cached import key_of
from eyas.engine.core.identity import build, program
from eyas.engine.render.bake import ambient, shadows
from eyas.engine.render.pack import light
from eyas.engine.sensors.obstacles import solids_of
from eyas.engine.sim import crowd_motion, scenes
from eyas.engine.targets.catalogue import KINDS
from eyas.engine.targets.rig import part_library
from eyas.engine.traffic import library, recorded
from eyas.engine.world.maps import MAPS
from eyas.lanes import identity, syntax
from eyas.maps.textures.shipped import build_textures

PACKAGE = Path(eyas.__file__).parent


def keys() -> dict[str, str]:
    """Return what identifies the code of each thing that is kept, and the rooms of the build."""
    for module in (build, program, identity, syntax):
        for what in vars(module).values():
            if hasattr(what, "cache_clear"):
                what.cache_clear()
    kinds = {kind.name: key_of(part_library, (kind,)) for kind in KINDS}
    makers = {
        "citystreet": MAPS.get("citystreet").plan,
        "downtown": MAPS.get("downtown").plan,
        "solids": solids_of,
        "textures": build_textures,
        "parts": part_library,
        "geometry": scenes._packed,
        "sky": light._sky,
        "shadows": shadows._bake,
        "ambient": ambient._bake,
        "recording": library._recorded,
        "vehicles": recorded._first,
        "people": crowd_motion._samples_of,
    }
    return {
        **{name: program.code_of(make) for name, make in makers.items()},
        **{f"kind {name}": code for name, code in kinds.items()},
        **{f"room {room}": digest for room, digest in build.this_build().rooms.items()},
    }


def main() -> None:
    """Print a JSON list of keys."""
    found = [keys()]
    for edits in json.loads(sys.argv[1]):
        before = {}
        for file, text, new in edits:
            path = PACKAGE / file
            said = path.read_text() if path.exists() else ""
            before.setdefault(path, said)
            assert text in said, f"{file}: has no {text!r}"
            path.write_text(said.replace(text, new, 1))
        found.append(keys())
        for path, said in before.items():
            path.write_text(said)
            if not said:
                path.unlink()
    print(json.dumps(found))


if __name__ == "__main__":
    main()
