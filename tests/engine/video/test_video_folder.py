import json
import os
from pathlib import Path

import pytest

from eyas import __version__
from eyas.engine.core.errors import ConfigError, DataFileError, OutputError
from eyas.engine.core.identity.build import this_build
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.video.folder import _NOT_PICTURED, open_folder

CONFIG = EyasConfig()
OTHER = EyasConfig(video=VideoConfig(fps=50.0))


def recording(path: Path) -> Path:
    """Make a folder that looks like a recording."""
    open_folder(path, CONFIG, overwrite=False, resume=False)
    episode = path / "DRONE0" / "episode0"
    episode.mkdir(parents=True)
    for name in ("000000.jpeg", "mark.json", "labels.jsonl", "episode.mp4", ".000001.jpeg.part"):
        (episode / name).write_bytes(b"x")
    (path / "dir_info.json").write_bytes(b"{}")
    return path


def tree(path: Path) -> list[str]:
    return sorted(inside.relative_to(path).as_posix() for inside in path.rglob("*"))


def test_a_new_folder_holds_the_settings(tmp_path):
    folder = open_folder(tmp_path / "a" / "b", CONFIG, overwrite=False, resume=False)
    assert json.loads((folder.path / "config.json").read_text())["video"]["fps"] == 25.0
    assert folder.episode(3, 2, 0.8).folder == tmp_path / "a" / "b" / "DRONE3" / "episode2"


def test_a_recording_is_not_mixed_with_another(tmp_path):
    with pytest.raises(OutputError, match=r"not empty.*--resume.*--overwrite"):
        open_folder(recording(tmp_path / "a"), CONFIG, overwrite=False, resume=False)


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "a").write_text("mine")
    for path in (tmp_path / "a", tmp_path / "a" / "b"):
        with pytest.raises(OutputError, match="a"):
            open_folder(path, CONFIG, overwrite=True, resume=False)
    assert (tmp_path / "a").read_text() == "mine"


def test_overwrite_deletes_a_recording(tmp_path):
    open_folder(recording(tmp_path / "a"), OTHER, overwrite=True, resume=False)
    assert [name for name in tree(tmp_path / "a") if name.startswith(("DRONE", "dir_info"))] == []
    assert json.loads((tmp_path / "a" / "config.json").read_text())["video"]["fps"] == 50.0


def test_overwrite_deletes_what_a_writer_wrote_that_has_gone(tmp_path):
    path = recording(tmp_path / "a")
    files = {"frame": ["masks/{:04d}.png"], "episode": ["gone.csv"], "run": ["all/gone.csv"]}
    (path / "version.json").write_text(json.dumps({"eyas": __version__, "files": files}))
    episode = path / "DRONE0" / "episode0"
    for folder in (path / "all", episode / "masks"):
        folder.mkdir()
    for file in (path / "all/gone.csv", episode / "gone.csv", episode / "masks/0012.png"):
        file.write_text("x")
    (episode / "masks/12.png").write_text("mine")
    with pytest.raises(OutputError, match=r"masks/12\.png' is not part of a recording"):
        open_folder(path, OTHER, overwrite=True, resume=False)
    (episode / "masks/12.png").unlink()
    open_folder(path, OTHER, overwrite=True, resume=False)
    assert tree(path) == ["config.json", "env_config.json", "version.json"]


@pytest.mark.parametrize("files", ['"x"', '{"frame": 3}', '{"film": []}', '{"run": ["{x}"]}'])
def test_a_damaged_list_of_files_is_no_list(tmp_path, files):
    path = recording(tmp_path / "a")
    (path / "version.json").write_text(f'{{"eyas": "{__version__}", "files": {files}}}')
    open_folder(path, OTHER, overwrite=True, resume=False)


def test_a_recording_says_which_files_its_writers_write(tmp_path):
    config = EyasConfig(video=VideoConfig(writers=("labels", "mark")))
    open_folder(tmp_path, config, overwrite=False, resume=False)
    origin = json.loads((tmp_path / "version.json").read_text())
    episode = ["labels.jsonl", "mark.json"]
    files = {"frame": [], "episode": episode, "run": ["dir_info.json"]}
    build = this_build()
    told = {"eyas": __version__, "build_id": build.id, "build": build.model_dump()}
    assert origin == {**told, "files": files, "seed": 0}


@pytest.mark.parametrize("name", ["thesis.txt", "DRONE0/notes.txt", "DRONE0/episode0/best.jpeg"])
def test_overwrite_deletes_nothing_where_something_else_lies(tmp_path, name):
    path = recording(tmp_path / "a")
    (path / name).write_text("mine")
    (path / "DRONE0/episode0/.000001.jpeg.part").unlink()
    before = tree(path)
    with pytest.raises(OutputError, match=name):
        open_folder(path, CONFIG, overwrite=True, resume=False)
    assert tree(path) == before


def test_overwrite_deletes_no_folder_that_is_not_a_recording(tmp_path):
    (tmp_path / "DRONE0").mkdir()
    with pytest.raises(OutputError, match=r"not deleted.*config\.json"):
        open_folder(tmp_path, CONFIG, overwrite=True, resume=False)
    assert tree(tmp_path) == ["DRONE0"]


def test_overwrite_does_not_follow_links(tmp_path):
    path = recording(tmp_path / "a")
    outside = tmp_path / "outside"
    (outside / "episode0").mkdir(parents=True)
    (outside / "episode0" / "000000.jpeg").write_text("mine")
    (path / "DRONE1").symlink_to(outside)
    before = tree(path)
    with pytest.raises(OutputError, match="DRONE1"):
        open_folder(path, CONFIG, overwrite=True, resume=False)
    assert tree(path) == before
    assert (outside / "episode0" / "000000.jpeg").read_text() == "mine"


def test_resume_names_the_first_setting_that_differs(tmp_path):
    with pytest.raises(ConfigError, match=r"video\.fps was 25\.0, is 50\.0"):
        open_folder(recording(tmp_path / "a"), OTHER, overwrite=False, resume=True)


def test_resume_takes_settings_that_a_file_does_not_have_for_their_defaults(tmp_path):
    path = recording(tmp_path / "a")
    values = json.loads((path / "config.json").read_text())
    del values["env"]
    (path / "config.json").write_text(json.dumps(values))
    open_folder(path, CONFIG, overwrite=False, resume=True)


@pytest.mark.parametrize("text", ["{", "[]", '{"video": {"fsp": 1}}'])
def test_resume_refuses_settings_that_cannot_be_read(tmp_path, text):
    path = recording(tmp_path / "a")
    (path / "config.json").write_text(text)
    with pytest.raises(DataFileError, match=r"config\.json: cannot be read"):
        open_folder(path, CONFIG, overwrite=False, resume=True)


BUILD = this_build()
REPAINTED = BUILD.model_copy(update={"rooms": BUILD.rooms | {"render": "0", "wire": "0"}})
LISTENING = BUILD.model_copy(update={"rooms": BUILD.rooms | {"wire": "0"}})


@pytest.mark.parametrize("recorded", [REPAINTED, '{"eyas": "0.0.1"}', "{", "[]", None])
def test_resume_refuses_a_recording_of_another_build(tmp_path, recorded):
    path = recording(tmp_path / "a")
    if recorded is None:
        (path / "version.json").unlink()
    else:
        told = {"eyas": __version__, "build": REPAINTED.model_dump()}
        (path / "version.json").write_text(json.dumps(told) if recorded is REPAINTED else recorded)
    said = "differs from this one in render;" if recorded is REPAINTED else "of an unknown version"
    with pytest.raises(OutputError, match=rf"recorded by Eyas .*{said}") as caught:
        open_folder(path, OTHER, overwrite=False, resume=True)
    assert "\n" not in str(caught.value)
    open_folder(path, OTHER, overwrite=True, resume=False)
    open_folder(path, OTHER, overwrite=False, resume=True)


def test_a_change_that_no_picture_shows_does_not_refuse_a_recording(tmp_path):
    path = recording(tmp_path / "a")
    told = {"eyas": "0.0.9", "build": LISTENING.model_dump()}
    (path / "version.json").write_text(json.dumps(told))
    open_folder(path, CONFIG, overwrite=False, resume=True)


def test_resume_keeps_what_is_whole_and_drops_what_is_not(tmp_path):
    path = recording(tmp_path / "a")
    open_folder(path, CONFIG, overwrite=False, resume=True)
    names = tree(path / "DRONE0" / "episode0")
    assert names == ["000000.jpeg", "episode.mp4", "labels.jsonl", "mark.json"]


def test_resume_refuses_a_folder_without_settings(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match="not a recording: it has no"):
        open_folder(tmp_path, CONFIG, overwrite=False, resume=True)


def test_resume_of_nothing_begins(tmp_path):
    open_folder(tmp_path / "a", CONFIG, overwrite=False, resume=True)
    assert (tmp_path / "a" / "config.json").is_file()


def test_overwrite_and_resume_exclude_each_other(tmp_path):
    with pytest.raises(ConfigError, match="cannot be used together"):
        open_folder(tmp_path / "a", CONFIG, overwrite=True, resume=True)
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize("link", ["DRONE0/episode1", "DRONE1", "DRONE0/episode0/mark.json"])
def test_resume_follows_no_links_of_a_recording_of_someone_else(tmp_path, link):
    path = recording(tmp_path / "a")
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "000000.jpeg").write_text("mine")
    (path / link).unlink(missing_ok=True)
    (path / link).symlink_to(outside)
    with pytest.raises(OutputError, match=rf"not continued: '{link}' is a link") as caught:
        open_folder(path, CONFIG, overwrite=False, resume=True)
    assert "\n" not in str(caught.value)
    assert (outside / "000000.jpeg").read_text() == "mine"


@pytest.mark.parametrize("options", [{"resume": True}, {"overwrite": True}])
def test_a_pipe_or_a_device_instead_of_a_file_is_not_read(tmp_path, options):
    path = recording(tmp_path / "a")
    (path / "version.json").unlink()
    os.mkfifo(path / "version.json")
    if options.get("resume"):
        with pytest.raises(OutputError, match=r"'version\.json' is a link or a device"):
            open_folder(path, CONFIG, **{"overwrite": False, "resume": False} | options)
    else:
        open_folder(path, CONFIG, **{"overwrite": False, "resume": False} | options)
        assert (path / "version.json").is_file()


@pytest.mark.parametrize(
    "files",
    [
        {"run": ["../outside/{:06d}.jpeg"]},
        {"run": ["/etc/passwd"], "episode": [".."]},
        {"run": ["{:99999999999d}"]},
        {"run": [["a"]]},
    ],
)
def test_a_list_of_files_that_names_others_deletes_none_of_them(tmp_path, files):
    path = recording(tmp_path / "a")
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "000000.jpeg").write_text("mine")
    (path / "version.json").write_text(json.dumps({"eyas": __version__, "files": files}))
    open_folder(path, CONFIG, overwrite=True, resume=False)
    assert (outside / "000000.jpeg").read_text() == "mine"


@pytest.mark.parametrize("content", ["[" * 100_000, '{"eyas": ["\\n"]}', "x" * (2 << 20)])
def test_a_version_of_any_content_is_one_line(tmp_path, content):
    path = recording(tmp_path / "a")
    (path / "version.json").write_text(content)
    with pytest.raises(OutputError, match="recorded by Eyas") as caught:
        open_folder(path, CONFIG, overwrite=False, resume=True)
    assert len(str(caught.value)) < 400


def test_what_has_no_part_in_a_recording_are_rooms_of_the_build():
    assert this_build().rooms.keys() >= {*_NOT_PICTURED}
