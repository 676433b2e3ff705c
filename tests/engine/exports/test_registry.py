import re
from dataclasses import replace

import pytest

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.exports.frame import OUTPUTS
from eyas.engine.exports.registry import WRITERS, chosen_writers
from eyas.engine.exports.writer import EndedEpisode, Files, Summary, Writer, pattern_of


class Whole:
    """A writer that inherits from nothing."""

    wants = frozenset({"depth", "class_id"})
    files = Files(episode=("mine.json",))

    def __init__(self, run): ...

    def begin(self, episode): ...

    def read(self, folder): ...

    def finish(self, episodes): ...


class Greedy(Whole):
    wants = frozenset({"RGB"})


class Twice(Whole):
    files = Files(run=("dir_info.json",))


class Listed(Whole):
    files = ("mine.json",)


class WithoutRead(Writer):
    files = Files()

    def begin(self, episode): ...


@pytest.mark.parametrize("name", WRITERS.built_in)
def test_every_writer_names_its_files_and_counts_its_frames(name, run, episode, frame):
    (made,) = chosen_writers([name])
    folder = run.folder / "DRONE0" / "episode0"
    folder.mkdir(parents=True)
    episode = replace(episode, folder=folder)
    writer = made(run)
    part = writer.begin(episode)
    given, whole = dict.fromkeys({*OUTPUTS} - {"words"}), frame(0)
    given |= {output: getattr(whole, output) for output in made.wants - {"words"}}
    if "words" not in made.wants:
        given["target"] = replace(whole.target, words=None)
    for number in range(2):
        part.add(frame(number, **given))
    part.finish()
    assert writer.read(folder).frames == 2
    writer.finish([EndedEpisode(episode, Summary(2))])
    files = made.files
    for inside, patterns in ((folder, files.frame + files.episode), (run.folder, files.run)):
        found_in = inside.rglob("*") if inside is folder else inside.iterdir()
        names = [path.relative_to(inside).as_posix() for path in found_in if path.is_file()]
        assert bool(names) == bool(patterns)
        for found in names:
            assert any(re.fullmatch(pattern_of(pattern), found) for pattern in patterns), found


def test_writers_come_in_the_order_of_their_names():
    names = [writer.__name__ for writer in chosen_writers(["mp4", f"{__name__}:Whole", "jpeg"])]
    assert names == ["Mp4Writer", "Whole", "JpegWriter"]


def test_an_unknown_name_is_one_line_with_the_nearest():
    with pytest.raises(UnknownNameError) as caught:
        chosen_writers(["jpeg", "lables"])
    line = "video.writers: 'lables' is not allowed; did you mean 'labels'?; known: arrays, "
    assert str(caught.value).startswith(line)


@pytest.mark.parametrize(
    ("names", "line"),
    [
        (["jpeg", "jpeg"], "'jpeg' and 'jpeg' both write '{:06d}.jpeg'"),
        (["mark", "HERE:Twice"], "'mark' and 'HERE:Twice' both write 'dir_info.json'"),
        (
            ["HERE:Greedy"],
            "'HERE:Greedy' wants 'RGB'; there is only: rgb, depth, object_id, class_id, normal,"
            " others, words, parts, clean, cameras, events, traffic",
        ),
        (["HERE:Listed"], "the files of 'HERE:Listed' are a tuple, not a Files"),
        (["HERE:WithoutRead"], "'HERE:WithoutRead' is not a writer: it has no 'read'"),
        (["pathlib:Path"], "'pathlib:Path' is not a writer: it has no 'wants'"),
        (["HERE:pytest"], "'HERE:pytest' is a module, not a type"),
        (["nowhere_at_all:Csv"], "'nowhere_at_all:Csv': there is no module 'nowhere_at_all'"),
    ],
)
def test_what_is_no_set_of_writers_is_one_line(names, line):
    names = [name.replace("HERE", __name__) for name in names]
    line = re.escape("video.writers: " + line.replace("HERE", __name__))
    with pytest.raises(ConfigError, match=f"^{line}$"):
        chosen_writers(names)
