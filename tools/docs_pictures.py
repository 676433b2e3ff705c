"""Draw the pictures and films of the documents, and tell which are older than what draws them.

python tools/docs_pictures.py                   # draw all that are stale; an hour of CPU
python tools/docs_pictures.py citystreet.jpg    # draw these, and what the same command draws
python tools/docs_pictures.py --stale           # name the stale ones; 1 if there are any

`docs/images/drawn.json` has the build and the looks that drew each. The looks are a digest of the
golden pictures (`tests/engine/render/golden`), so a picture is stale once they were drawn anew.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from hashlib import sha256
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
RECORD = DOCS / "images" / "drawn.json"
GOLDEN = ROOT / "tests" / "engine" / "render" / "golden"

SHEETS: dict[str, tuple[str, ...]] = {
    "air_sheet.py": ("air.jpg",),
    "camera_sheet.py docs/images": (
        *("camera-models.jpg", "camera-flood.jpg", "camera-mosaic.jpg", "camera-dirt.jpg"),
        *("camera-link.jpg", "camera-spectra.jpg", "camera-focus.jpg", "camera-further.jpg"),
        "corruptions.jpg",
    ),
    "flight_sheet.py docs/images/flights.jpg": ("flights.jpg",),
    "gallery_sheet.py SCRATCH docs/images/gallery.jpg": ("gallery.jpg",),
    "lamps_sheet.py docs/images": ("lamps.jpg",),
    "people_sheet.py docs/images/people.jpg": ("people.jpg",),
    "scene_sheet.py docs/images": (
        *("camera-lens.jpg", "camera-shutter.jpg", "camera-events.jpg", "lidar.jpg"),
        *("simpleway.jpg", "imported.jpg", "town-crossings.jpg"),
    ),
    "vehicle_sheet.py docs/images/vehicles.jpg": ("vehicles.jpg",),
    "weather_sheet.py --rows SCRATCH": ("weathers.jpg",),
    **{
        f"map_pictures.py {name}": (f"{name}.jpg",)
        for name in ("citystreet", "downtown", "lake", "village", "desert", "farmland")
    },
    **{
        f"site_films.py {name}": (f"{name}.mp4",)
        for name in ("orbit", "search", "night", "snow", "people", "box", "flown", "words")
    },
    "site_films.py follow": ("follow.mp4", "follow.webp"),
}
"""Tools with their arguments, SCRATCH a new folder, and the files that each writes."""

COMMANDS: dict[str, tuple[str, ...]] = {
    "targets_page.py docs/images/targets.jpg": ("targets.jpg",),
    "demo_page.py docs/images/demo.jpg": ("demo.jpg",),
}
UNDRAWN = {"flown-steps.png", "frames.svg", "ride.mp4"}
"""A plot and a drawing, which no look changes, and a film of files of others (docs/bring.md)."""


def looks() -> str:
    """Return the digest of the golden pictures."""
    digest = sha256()
    for path in sorted(GOLDEN.glob("*.png")):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def pictures() -> dict[str, str]:
    """Return the command that draws each picture and film, by the name of the file."""
    drawn = SHEETS | COMMANDS
    return {name: command for command, names in drawn.items() for name in names}


def stale() -> list[str]:
    """Return the pictures that were drawn before the looks of today, in order of their names."""
    drawn = json.loads(RECORD.read_text()) if RECORD.is_file() else {}
    now = looks()
    return sorted(name for name in pictures() if drawn.get(name, {}).get("looks") != now)


def draw(command: str) -> None:
    """Run a command of the tables."""
    with tempfile.TemporaryDirectory() as scratch:
        program, *arguments = command.replace("SCRATCH", scratch).split()
        if program == "gallery_sheet.py":
            run = [sys.executable, "-m", "eyas", "maps", "gallery", "--out", scratch]
            subprocess.run(run, check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
        called = ["-m", "eyas"] if program == "eyas" else [str(ROOT / "tools" / program)]
        subprocess.run([sys.executable, *called, *arguments], check=True, cwd=ROOT)


def record(names: tuple[str, ...]) -> None:
    """Note what drew some files."""
    from eyas.engine.core.identity.build import this_build

    drawn = json.loads(RECORD.read_text()) if RECORD.is_file() else {}
    day = time.strftime("%Y-%m-%d")
    for name in names:
        drawn[name] = {"build": this_build().world, "looks": looks(), "day": day}
    RECORD.write_text(json.dumps(dict(sorted(drawn.items())), indent=1) + "\n")


def main() -> None:
    """Draw what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="files; none: all stale ones")
    parser.add_argument("--stale", action="store_true", help="name the stale ones")
    asked = parser.parse_args()
    if unknown := set(asked.names) - pictures().keys():
        parser.error(f"{min(unknown)}: not allowed; allowed: {', '.join(sorted(pictures()))}")
    old = stale()
    if asked.stale:
        print("\n".join(old))
        raise SystemExit(bool(old))
    for command, names in (SHEETS | COMMANDS).items():
        if set(names) & set(asked.names or old):
            print(command, flush=True)
            draw(command)
            record(names)


if __name__ == "__main__":
    main()
