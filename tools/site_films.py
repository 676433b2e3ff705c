"""Record the films of the gallery of the site: `python tools/site_films.py [NAME ...]`.

Each is one episode of one drone, of `eyas video` with the settings below, or the median flight of a
few of `eyas evaluate --videos`; `docs/films` gets them.
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import av
from PIL import Image, ImageDraw, ImageFont

import eyas
from eyas.engine.exports.label import read_labels

FILMS = Path(__file__).parents[1] / "docs" / "films" / "films"
COMMON = {
    "camera": {"width": 480, "height": 360, "samples": 4},
    "video": {"channels": 1, "episode_frames": 150, "writers": ["mp4", "labels"]},
}
CHOSEN: dict[str, dict[str, object]] = {
    "follow": {"seed": 4, "camera.width": 960, "camera.height": 540},
    "orbit": {"video.flight": "orbit", "world.map": "village", "seed": 2},
    "search": {"video.flight": "search", "world.map": "downtown", "seed": 3},
    "night": {"world.weather": "night", "world.map": "downtown", "seed": 5},
    "snow": {"world.weather": "snow", "seed": 6},
    "people": {"target": "Pedestrian", "start.height": 9.0, "seed": 3},
}
"""Settings of each film, by the names that `--set` takes."""

FLOWN = {
    "box": ("eyas", "distractor"),
    "flown": ("eyas-flown", "flown"),
    "words": ("eyas-words", "referring"),
}
"""Policy and protocol of each film of a flight."""
LENGTH = 375
"""Pictures of such a film, 12 s."""


def nested(settings: dict[str, object]) -> dict[str, object]:
    """Return settings as nested dictionaries."""
    tree: dict[str, object] = {}
    for key, value in settings.items():
        *groups, name = key.split(".")
        place = tree
        for group in groups:
            place = place.setdefault(group, {})  # type: ignore[assignment]
        place[name] = value
    return tree


def frames(film: Path) -> list[Image.Image]:
    """Return the pictures of a film."""
    with av.open(str(film)) as container:
        return [frame.to_image() for frame in container.decode(video=0)]


def flown(policy: str, protocol: str, folder: Path) -> list[Image.Image]:
    """Return every second picture of the median of some flights, smaller."""
    command = [sys.executable, "-m", "eyas", "evaluate", "--policy", policy, "--protocol", protocol]
    command += ["--episodes", "3", "--seeds", "60000000", "--videos", "--out", str(folder)]
    subprocess.run(command, check=True)
    pictures = frames(folder / "videos" / "median.mp4")[:LENGTH:2]
    return [picture.resize((480, 360), Image.Resampling.LANCZOS) for picture in pictures]


def write_film(path: Path, pictures: list[Image.Image], rate: int) -> None:
    """Write pictures as a film that is small enough to be kept in the repository."""
    with av.open(str(path), "w", options={"movflags": "+faststart"}) as container:
        stream = container.add_stream("libx264", rate=rate, options={"crf": "32", "preset": "slow"})
        stream.width, stream.height, stream.pix_fmt = *pictures[0].size, "yuv420p"
        for picture in pictures:
            container.mux(stream.encode(av.VideoFrame.from_image(picture)))
        container.mux(stream.encode())


def marked(picture: Image.Image, label: dict[str, Any]) -> Image.Image:
    """Return a picture with the target's box, its words and the reward."""
    left, top, right, bottom = label["target_box"]
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(22)
    words = f"{label['target_words']}   reward {label['reward']:.2f}"
    if right > left:
        pen.rectangle((left - 3, top - 3, right + 2, bottom + 2), outline="#ff3b7f", width=3)
    pen.text((16, 12), words, "white", font, stroke_width=2, stroke_fill="black")
    return picture


def write_animation(path: Path, pictures: list[Image.Image]) -> None:
    """Write every third picture as an animated WebP."""
    shown = pictures[::3]
    shown[0].save(path, save_all=True, append_images=shown[1:], duration=120, loop=0, quality=40)


def main() -> None:
    """Record those that are asked for, or all."""
    FILMS.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[1:] or (*CHOSEN, *FLOWN):
        with tempfile.TemporaryDirectory() as folder:
            if name in FLOWN:
                pictures, rate = flown(*FLOWN[name], Path(folder) / "run"), 16
            else:
                settings = eyas.updated(eyas.make_config(COMMON), nested(CHOSEN[name]))
                run = eyas.record(settings, Path(folder) / "run")
                episode = run / "DRONE0" / "episode0"
                pictures, rate = frames(episode / "episode.mp4"), 25
                if name == "follow":
                    labels = read_labels(episode / "labels.jsonl")
                    pictures = [marked(*pair) for pair in zip(pictures, labels, strict=True)]
        write_film(FILMS / f"{name}.mp4", pictures, rate)
        if name == "follow":  # README's, which plays on GitHub
            write_animation(FILMS.parents[1] / "images" / "follow.webp", pictures)
        print(FILMS / f"{name}.mp4")


if __name__ == "__main__":
    main()
