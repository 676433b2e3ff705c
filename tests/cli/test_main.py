import json
import os
import signal
import subprocess
import sys
import time

import pytest
import typer

import eyas
from eyas import __version__, build_id
from eyas.cli.app import app
from eyas.cli.main import main
from eyas.dat.settings.adapter import save_original, to_original
from eyas.dat.wire.exchange import SETTINGS_FILE
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.preset import PRESETS
from eyas.engine.world.maps import MAPS
from eyas.lanes import thread_count

COMMAND = [sys.executable, "-m", "eyas.cli.main"]


def run(monkeypatch, capsys, *arguments):
    """Run in this process, which is quick; return exit code, stdout and the lines of stderr."""
    monkeypatch.setattr(sys, "argv", ["eyas", *map(str, arguments)])
    with pytest.raises(SystemExit) as caught:
        main()
    said = capsys.readouterr()
    return caught.value.code or 0, said.out, said.err.splitlines()


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["config", "show", "--config", "nowhere.json"], "nowhere.json: cannot read: "),
        (["config", "show", "--set", "video.fsp=3"], "video.fsp: unknown key; did you mean 'fps'?"),
        (
            ["config", "show", "--set", "Control_Frequence=0"],
            "Control_Frequence: 0 is not allowed: ",
        ),
        (["video", "--preset", "dat"], "preset: 'dat' is not allowed; "),
        (["config", "show", "--preset", "easy", "--config", "a.json"], "--preset and --config "),
        (["config", "show", "--set", "seed"], "--set 'seed': not of the form key=value"),
        (
            ["config", "show", "--set", "world.map=simpleway-city", "--set", "world.weather=night"],
            "world.weather: 'night' is not allowed on the map 'simpleway-city'",
        ),
        (
            ["config", "show", "--set", "World_Path=worlds/simpleway-clinker_snow.wbt"],
            "world.weather: 'snow' is not allowed on the map 'simpleway-clinker'",
        ),
        (["serve", "--root", "nowhere"], "nowhere: no such folder; give the one that holds "),
        (["serve"], "one of --root, --mavlink, --px4, --ardupilot and --ros must be given"),
        (["serve", "--px4", "4560"], "--px4: '4560' is not of the form HOST:PORT"),
        (
            ["serve", "--ardupilot", "a:99999"],
            "--ardupilot: 'a:99999' is not of the form HOST:PORT",
        ),
        (
            [
                *("serve", "--px4", "127.0.0.1:4560", "--set", "tracker.supervised=true"),
                *("--set", "tracker.ground_contact=false"),
            ],
            "tracker: a supervised drone, a car or a tracker of one's own has no rotors",
        ),
        (["video", "--seed", "-1"], "seed: -1 is not allowed: "),
        (["video", "--seed", "x"], "Invalid value for '--seed'"),
        (["video", "--foo"], "No such option: --foo"),
        (["cache", "clear", "--kind", "maps"], "--kind: 'maps' is not allowed; known: ambient, "),
        (["vidoe"], "No such command 'vidoe'"),
        (
            ["traffic", "record", "--type", "buss"],
            "traffic.vehicle_type: 'buss' is not allowed; did you",
        ),
        (["traffic", "record", "--duration", "0"], "--duration: 0 is not allowed"),
        (
            ["traffic", "record", "--map", "citystret"],
            "world.map: 'citystret' is not allowed; did you",
        ),
    ],
)
def test_what_a_user_gets_wrong_is_one_line_and_exit_code_2(
    monkeypatch, capsys, tmp_path, arguments, line
):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(monkeypatch, capsys, *arguments)
    assert (code, out, len(err)) == (2, "", 1)
    assert err[0].startswith(f"eyas: error: {line}")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "value",
    [
        "x" * 3000,
        "a b " * 900,
        "9" * 3000,
        "\ud800" * 3000,
        "[" * 3000,
        "{'a': " * 900,
        "1e" * 1500,
    ],
)
@pytest.mark.parametrize("key", ["world.map", "seed", "camera", "video.writers", "{}"])
def test_long_values_are_shortened(monkeypatch, capsys, key, value):
    said = f"{key}={value}" if key != "{}" else f"{value}=1"
    _, _, (line, *_) = run(monkeypatch, capsys, "config", "show", "--set", said)
    assert len(line) < 1300


@pytest.mark.parametrize("count", ["0", "-1", "x", " ", "1e9", "9" * 3000, "\uff13"])
def test_a_number_of_threads_that_is_none_is_one_line(monkeypatch, capsys, count):
    monkeypatch.setenv("NUMBA_NUM_THREADS", count)
    monkeypatch.setattr("eyas.engine.settings.file.load_settings", lambda *_, **__: thread_count())
    code, _, lines = run(monkeypatch, capsys, "train")
    assert (code, len(lines)) == (2, 1)
    assert lines[0].startswith("eyas: error: NUMBA_NUM_THREADS: ")


@pytest.mark.parametrize("limit", [60, 110, 250])  # at 130, pydantic's Rust aborts the process
@pytest.mark.slow
def test_too_little_memory_is_one_line(limit):
    resource = pytest.importorskip("resource")
    most = limit << 20
    told = subprocess.run(
        [*COMMAND, "video", "--map", "desert-bare"],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (most, most)),
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.returncode == 2
    assert told.stderr.splitlines()[-1].startswith("eyas: error: out of memory: ")
    assert "Traceback" not in told.stderr


def test_a_line_break_in_a_name_stays_on_one_line(monkeypatch, capsys):
    code, _, err = run(monkeypatch, capsys, "config", "show", "--set", "vi\ndeo.fps=3")
    assert (code, len(err)) == (2, 1)


def test_show_prints_the_settings_in_either_notation(monkeypatch, capsys):
    config = EyasConfig(video={"fps": 9})
    code, out, _ = run(monkeypatch, capsys, "config", "show", "--set", "video.fps=9")
    assert (code, EyasConfig(**json.loads(out))) == (0, config)
    _, out, _ = run(monkeypatch, capsys, "config", "show", "--legacy", "--set", "video.fps=9")
    assert json.loads(out) == to_original(config)


@pytest.mark.parametrize("name", PRESETS)
def test_presets_are_chosen_by_name_and_changed_by_set(monkeypatch, capsys, name):
    command = ("config", "show", "--preset", name, "--set", "start.height=17")
    code, out, _ = run(monkeypatch, capsys, *command)
    assert (code, json.loads(out)["start"]["height"]) == (0, 17.0)
    help_text = run(monkeypatch, capsys, "config", "show", "--help")[1]
    assert name in help_text


def test_convert_writes_the_other_notation_and_rewrites_nothing(monkeypatch, capsys, tmp_path):
    legacy, native, again = (
        tmp_path / name for name in ("legacy.json", "native.json", "again.json")
    )
    legacy.write_text(json.dumps(to_original(EyasConfig(video={"fps": 9}))))
    code, out, _ = run(monkeypatch, capsys, "config", "convert", legacy, native)
    assert code == 0
    assert "native.json: the settings of" in "".join(out)
    video = {"fps": 9, "jpeg_quality": 100, "flight": "exact"}
    traffic = {"signals": "amber", "lamps": "dark"}
    tracker = {"flight": "original", "off_centre": True}
    changed = {"video": video, "tracker": tracker, "traffic": traffic}
    meant = EyasConfig(**changed, start={"velocity": "rest"}, extras=[], original={})
    assert EyasConfig(**json.loads(native.read_text())) == meant
    assert run(monkeypatch, capsys, "config", "convert", native, again)[0] == 0
    assert json.loads(again.read_text()) == json.loads(legacy.read_text())
    code, _, err = run(monkeypatch, capsys, "config", "convert", legacy, native)
    assert (code, len(err)) == (2, 1)
    assert "never overwritten" in err[0]


def test_a_recording_of_traffic_is_not_replaced_unasked(monkeypatch, capsys, tmp_path):
    path = tmp_path / "bus.npz"
    path.write_bytes(b"precious")
    code, _, err = run(monkeypatch, capsys, "traffic", "record", "--out", path)
    assert (code, len(err)) == (2, 1)
    assert path.read_bytes() == b"precious"


def test_help_keeps_its_units(monkeypatch, capsys):
    code, out, _ = run(monkeypatch, capsys, "traffic", "record", "--help")
    assert code == 0
    assert "Seconds to record" in out


def test_version_and_maps(monkeypatch, capsys):
    assert run(monkeypatch, capsys, "--version")[:2] == (
        0,
        f"eyas {__version__} (build {build_id})\n",
    )
    listed = run(monkeypatch, capsys, "maps", "list")[1].splitlines()
    assert listed[0].startswith("citystreet: ")
    assert listed[0].endswith("(day, foggy, night, snow, rain, dusk, overcast, dust, autumn)")
    assert any(line.startswith("simpleway-clinker: ") for line in listed)


def test_listings_are_json_too(monkeypatch, capsys):
    def told(group):
        code, out, err = run(monkeypatch, capsys, group, "list", "--json")
        assert (code, err) == (0, [])
        return {entry.pop("name"): entry for entry in json.loads(out)}

    maps, targets, policies = map(told, ("maps", "targets", "policies"))
    assert set(maps) == set(eyas.list_maps())
    assert maps["citystreet"]["weathers"] == list(eyas.list_weathers("citystreet"))
    assert set(policies) == set(eyas.list_policies())
    assert targets["BmwX5Simple"]["size"] == [4.85, 1.9, 1.8]


@pytest.mark.slow
def test_what_a_map_and_a_recording_are_is_json_too(monkeypatch, capsys):
    def told(*words):
        code, out, err = run(monkeypatch, capsys, *words)
        assert (code, err) == (0, [])
        return out

    town = json.loads(told("maps", "info", "simpleway-clinker", "--json"))
    assert town["name"] == "simpleway-clinker"
    assert town["weathers"] == list(eyas.list_weathers("simpleway-clinker"))
    assert "traffic.npz" in town["recorded_traffic"]
    assert f"lanes: {town['figures']['lanes']:.2f} km" in told("maps", "info", "simpleway-clinker")
    file = str(MAPS.get("simpleway-clinker").shipped("traffic.npz"))
    drive = json.loads(told("traffic", "info", file, "--json"))
    assert (drive["map"], drive["map_seed"], drive["rate"]) == ("simpleway", 0, 10.0)
    assert drive["vehicles"]["passenger"]["most"] == 40
    assert "passenger: 40 at most, 40.0 on average; " in told("traffic", "info", file)
    assert "traffic: demand=keep_alive" in told("traffic", "info", file)


def test_warnings_are_one_line_on_stderr_and_stdout_stays_json():
    command = [*COMMAND, "config", "show", "--set", "control.frequency=150"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["control"]["frequency"] == 150
    assert done.stderr.startswith("eyas: warning: control.frequency: 150 does not divide 500")
    assert done.stderr.count("\n") == 1


def test_help_does_not_load_what_it_does_not_need():
    code = (
        "import sys; from eyas.cli.main import main; sys.argv = ['eyas', '--help']\n"
        "try: main()\n"
        "except SystemExit as end: assert not end.code\n"
        "heavy = {'numba', 'pydantic', 'libsumo'}\n"
        "print('loaded:', sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("loaded: []\n")


def test_an_interrupt_is_one_line_and_exit_code_130(tmp_path):
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)  # reading it waits for ever
    command = [*COMMAND, "config", "show", "--config", str(fifo)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    writer = os.open(fifo, os.O_WRONLY)  # waits until the command reads
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    os.close(writer)
    assert (process.returncode, err) == (130, "eyas: interrupted\n")


def test_a_reader_that_goes_away_is_no_error():
    process = subprocess.Popen(
        [*COMMAND, "config", "show"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    process.stdout.close()
    assert process.stderr.read() == ""
    process.stderr.close()
    process.wait(timeout=30)


def test_the_second_start_of_a_server_serves_what_the_first_one_did(monkeypatch, capsys, tmp_path):
    served = []

    def run_server(config, root, load, until_idle):
        served.append(config.model_copy(update={"mode": "train", "original": None, "seed": 0}))
        file = root / SETTINGS_FILE
        file.parent.mkdir(parents=True, exist_ok=True)
        save_original(config, file)

    monkeypatch.setattr("eyas.dat.serve.run.run", run_server)
    for _ in range(2):  # the second reads the file of the first
        run(monkeypatch, capsys, "serve", "--root", tmp_path)
    assert served[0] == served[1]
    assert served[0].extras == ()


@pytest.mark.parametrize("group", [[], ["maps"]])
def test_a_group_without_a_command_prints_its_help_and_no_empty_error(monkeypatch, capsys, group):
    code, out, lines = run(monkeypatch, capsys, *group)
    assert code == 2
    assert "Usage: " in out + "".join(lines)
    assert not any(line.startswith("eyas: error") for line in lines)


def test_the_package_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "eyas", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"eyas {__version__} (build {build_id})\n"


def commands(group, *names):
    """Yield the words of each command, and the command."""
    for name, command in getattr(group, "commands", {}).items():
        yield from commands(command, *names, name)
    yield names, group


def test_no_help_is_taken_for_markup_and_each_option_means_one_thing():
    seen = {}
    for words, command in commands(typer.main.get_command(app)):
        texts = [command.help or ""]
        for option in command.params:
            texts.append(getattr(option, "help", "") or "")
            if "--json" in option.opts:
                seen[" ".join(words)] = option.is_flag
        assert not any("[" in text for text in texts), words
    assert len(seen) == 11
    assert all(seen.values())


@pytest.mark.slow
def test_everything_that_is_listed_can_be_a_target(monkeypatch, capsys):
    code, out, _ = run(monkeypatch, capsys, "targets", "list")
    assert code == 0
    kinds = {line.split()[1] for line in out.splitlines()[1:] if len(line.split()) > 6}
    assert {"Pedestrian", "GhostDog"} < kinds
    assert "Quadrotor" not in out
