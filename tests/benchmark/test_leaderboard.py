"""The leaderboard: cards, ranks, classes, and entries that are flown again."""

import json
import shutil
import zipfile
from hashlib import sha256
from pathlib import Path

import pytest
from typer.testing import CliRunner

from eyas.benchmark.evaluation import run
from eyas.benchmark.plan.plan import EvaluationPlan
from eyas.benchmark.report.leaderboard import fresh, page
from eyas.benchmark.report.leaderboard.mark import KEY_VARIABLE, content_hash
from eyas.benchmark.report.leaderboard.pack import pack, unpacked
from eyas.benchmark.report.leaderboard.submission import read_card, submissions_in
from eyas.benchmark.report.leaderboard.verify import EntryVerdict, verify
from eyas.cli.app import app
from eyas.engine.core.errors import EyasError

pytestmark = pytest.mark.slow  # what its tests share takes long to make

FRESH = 16
"""Episodes of secret seeds; at least 40 are asked of others, which take seconds to fly."""


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Evaluations of hover and follow: four batches of two episodes each."""
    folder = tmp_path_factory.mktemp("board")
    for name in ("hover", "follow"):
        plan = EvaluationPlan(policy=name, maps=("simpleway-grass",), episodes=2, batch=2)
        run(plan, folder / name, quiet=True)
    return folder


@pytest.fixture(autouse=True)
def key(tmp_path, monkeypatch):
    monkeypatch.setenv(KEY_VARIABLE, str(tmp_path / "key"))


@pytest.fixture
def few_fresh(monkeypatch):
    """Let fewer episodes be enough, of seeds that are the same in all runs: whether figures fit is
    what is tried, not how sure one is, and SUMO drives the traffic of a new seed for ten seconds.
    """
    monkeypatch.setattr("eyas.benchmark.report.leaderboard.verify.LEAST", FRESH)
    monkeypatch.setattr(fresh.secrets, "randbelow", lambda below: below // 3)


def test_seeds_of_fresh_episodes_are_others_each_time():
    assert len({fresh._test_seed() for _ in range(5)}) == 5


@pytest.fixture
def board(flown, tmp_path):
    return shutil.copytree(flown, tmp_path / "board")


def shown(board, **changes):
    page.run(board, board / "index.html")
    return (board / "index.html").read_text()


def edit_plan(folder, **changes):
    said = json.loads((folder / "run.json").read_text())
    said["plan"] |= changes
    (folder / "run.json").write_text(json.dumps(said))


def only(board, **options):
    (found,) = verify(board, **options)
    return found


def lines_of(folder):
    return (folder / "episodes.jsonl").read_bytes().splitlines(keepends=True)


def test_equal_flights_are_marked_and_the_page_says_so(board):
    found = list(verify(board, share=0.3, seed=1))
    assert [each.verdict for each in found] == [EntryVerdict.VERIFIED] * 2
    assert "4 of 8 episodes (--seed 1) are equal" in found[0].line
    assert shown(board).count("verified: 4 of 8") == 2
    mark = json.loads((board / "hover" / "verified.json").read_text())
    assert len(mark["flown"]) == 4
    assert only(board / "hover", share=0.01, seed=1).why.startswith("2 of 8")  # a whole batch


@pytest.mark.usefixtures("few_fresh")
def test_what_was_learned_by_heart_is_equal_but_fresh_episodes_do_not_confirm_it(
    board, tmp_path, monkeypatch
):
    ways = [json.loads(line)["trace"]["drone"] for line in lines_of(board / "follow")]
    known = tmp_path / "ways.json"
    known.write_text(json.dumps(ways))
    monkeypatch.setenv("KNOWN_WAYS", str(known))
    monkeypatch.syspath_prepend(Path(__file__).parent)
    shutil.rmtree(board)
    plan = EvaluationPlan(policy="cheats:ByHeart", maps=("simpleway-grass",), episodes=2, batch=2)
    records = run(plan, board / "cheat", quiet=True)
    assert sum(record.tsr for record in records) / len(records) > 0.7
    assert only(board, trust=True).verdict is EntryVerdict.VERIFIED
    assert "none: may be learned by heart" in shown(board)
    found = only(board, fresh=FRESH, trust=True)
    assert found.verdict is EntryVerdict.UNCONFIRMED
    assert "episodes of secret seeds" in found.line
    assert "the claim is outside" in shown(board)


@pytest.mark.usefixtures("few_fresh")
def test_honest_figures_are_confirmed_by_fresh_episodes(board):
    for found in verify(board, fresh=FRESH):
        assert found.verdict is EntryVerdict.VERIFIED, found.line
    assert "none: may be" not in shown(board)
    for wrong in (3, 10**12):
        with pytest.raises(EyasError, match=f"--fresh: {wrong} is not allowed"):
            list(verify(board, fresh=wrong))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"tsr": 1.0, "losses": 0, "lost_after": None}, "tsr is 1, by its trace at most"),
        ({"cr": 374.0}, "its trace adds up to"),
        ({"losses": 3, "lost_after": None}, "losses 3"),
        ({"found_after": None}, "found_after is None"),
        ({"seen": 0.0, "visible": 0.3}, "seen is 0"),
        ({"duration": 1.0}, "its trace has"),
    ],
)
def test_figures_that_contradict_each_other_leave_an_entry_out(board, caplog, changes, said):
    path = board / "hover" / "episodes.jsonl"
    records = [json.loads(line) for line in lines_of(board / "hover")]
    records[0] |= changes
    path.write_text("".join(json.dumps(record) + "\n" for record in records))
    left = [entry.folder.name for entry in submissions_in(board)]
    assert left == ["follow"]
    assert said in caplog.text


def test_an_entry_is_packed_and_can_be_verified_from_its_file(board, tmp_path):
    file, made = pack(board / "hover", tmp_path / "sent.zip")
    assert file == tmp_path / "sent.zip"
    assert "card.json made: add authors" in made
    assert read_card(board / "hover").name == "hover"
    assert "card.json made" not in pack(board / "hover", file).about
    with zipfile.ZipFile(tmp_path / "sent.zip") as sent:
        assert {"run.json", "episodes.jsonl", "result.json", "card.json"} <= set(sent.namelist())
        assert "videos/median.mp4" in sent.namelist()
        sent.extractall(tmp_path / "got")
    assert only(tmp_path / "got").verdict is EntryVerdict.VERIFIED


def test_which_episodes_are_flown_again_cannot_be_known_before(board):
    seeds = {only(board / "hover").why.partition("--seed ")[2] for _ in range(3)}
    assert len(seeds) == 3
    assert only(board / "hover", seed=5).why == only(board / "hover", seed=5).why


def test_a_mark_holds_for_what_was_verified_only(board):
    list(verify(board))
    path = board / "hover" / "episodes.jsonl"
    path.write_bytes(path.read_bytes().replace(b'"crashed":false', b'"crashed":true', 1))
    assert shown(board).count("verified: ") == 1
    edit_plan(board / "follow", latency="40")
    assert "verified: " not in shown(board)


def test_a_mark_of_somebody_else_is_none(board, tmp_path, monkeypatch):
    list(verify(board))
    monkeypatch.setenv(KEY_VARIABLE, str(tmp_path / "another key"))
    assert "verified: " not in shown(board)
    list(verify(board / "hover"))
    assert shown(board).count("verified: ") == 1
    path = board / "hover" / "verified.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"flown": []}))
    assert "verified: " not in shown(board)
    for wrong in ("", "[]", "{}", "[" * 100_000, '{"signature": 3}'):
        path.write_text(wrong)
        assert "verified: " not in shown(board)


def test_the_key_is_for_the_verifiers_eyes_only(board, tmp_path):
    list(verify(board / "hover"))
    assert (tmp_path / "key").stat().st_mode & 0o077 == 0


def test_an_edited_figure_is_caught_and_named(board):
    list(verify(board / "hover"))
    lines = lines_of(board / "hover")
    record = json.loads(lines[5])
    lines[5] = json.dumps(record | {"path": 374.0}).replace(" ", "").encode() + b"\n"
    (board / "hover" / "episodes.jsonl").write_bytes(b"".join(lines))
    found = only(board / "hover", share=1.0)
    assert found.verdict is EntryVerdict.DIFFERENT
    assert f"{record['name']}: 'path' is 374.0, flown again {record['path']}" in found.line
    assert not (board / "hover" / "verified.json").exists()
    answer = CliRunner().invoke(app, ["leaderboard", "verify", str(board), "--share", "1"])
    assert answer.exit_code == 1
    assert "not as flown" in answer.output


def test_results_under_another_name_are_caught(board):
    """Flights of the oracle, said to be those of a policy that hovers."""
    edit_plan(board / "follow", policy="hover")
    hover = json.loads((board / "hover" / "run.json").read_text())
    said = json.loads((board / "follow" / "run.json").read_text()) | {"entry": hover["entry"]}
    (board / "follow" / "run.json").write_text(json.dumps(said))
    assert "flown again" in only(board / "follow").line


def test_swapped_lines_are_caught(board):
    lines = lines_of(board / "hover")
    lines[0], lines[7] = lines[7], lines[0]
    (board / "hover" / "episodes.jsonl").write_bytes(b"".join(lines))
    found = only(board / "hover", share=0.01)
    assert found.verdict is EntryVerdict.DIFFERENT
    assert "stands in batch 1, where it was not flown" in found.why


def test_a_flight_that_passes_for_another_is_caught(board):
    lines = lines_of(board / "hover")
    good, bad = json.loads(lines[0]), json.loads(lines[1])
    lines[1] = json.dumps(good | {"name": bad["name"]}).encode() + b"\n"
    (board / "hover" / "episodes.jsonl").write_bytes(b"".join(lines))
    assert "are those of another episode" in only(board / "hover", share=0.01).why


def test_dropped_failures_are_caught(board, caplog):
    lines = lines_of(board / "hover")
    path = board / "hover" / "episodes.jsonl"
    path.write_bytes(b"".join(lines[:-2]))
    assert "2 episodes are missing" in only(board / "hover").line
    path.write_bytes(b"".join([*lines[:-2], *lines[:2]]))
    assert "an episode is there twice" in only(board / "hover").line
    edit_plan(board / "hover", episodes=1)
    path.write_bytes(b"".join(lines[4:]))
    assert "is not an episode of the plan" in only(board / "hover").line
    assert "twice" not in shown(board)  # a page is written of what is there


def test_what_another_build_has_flown_is_not_verifiable(board):
    edit_build(board / "hover", "engine/sim")
    found = only(board / "hover")
    assert found.verdict is EntryVerdict.UNKNOWN
    assert "differs from this one in engine/sim" in found.why
    edit_plan(board / "follow", latency="measured")
    assert "does not repeat" in only(board / "follow").line


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"policy": "someones:Policy"}, "'someones:Policy' is code"),
        ({"policy": "theirs.zip"}, "'theirs.zip' is code, or a file that holds some"),
        ({"policy": "theirs.pt"}, "or a file that holds some"),
        ({"policy": "theirs.pt2"}, "or a file that holds some"),
        ({"policy": "theirs.onnx"}, "is not there"),
        ({"maps": ["someones:MAP"]}, "names code, 'someones:MAP' (world.map)"),
        ({"targets": ["someones:TARGET"]}, "target: 'someones:TARGET' is not allowed"),
        ({"latency": "/etc/passwd"}, "is a file"),
    ],
)
def test_no_code_of_others_runs_unasked(board, tmp_path, monkeypatch, changes, said):
    (tmp_path / "someones.py").write_text(
        f"from pathlib import Path\nPath({str(tmp_path / 'ran')!r}).touch()\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("theirs.zip", "theirs.pt", "theirs.pt2"):
        (board / "hover" / name).write_bytes(b"pickle")
    edit_plan(board / "hover", **changes)
    found = only(board / "hover")
    assert found.verdict is EntryVerdict.UNKNOWN
    assert said in found.why
    shown(board)
    assert not (tmp_path / "ran").exists()


def test_code_in_settings_does_not_run_either(board, tmp_path, monkeypatch):
    (tmp_path / "someones.py").write_text(
        f"from pathlib import Path\nPath({str(tmp_path / 'ran')!r}).touch()\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    settings = {"tracker": {"kind": "someones:Tracker"}}
    edit_plan(board / "hover", settings=settings)
    said = json.loads((board / "hover" / "run.json").read_text())
    said["protocol"] = EvaluationPlan(policy="hover", settings=settings).rules.hash
    (board / "hover" / "run.json").write_text(json.dumps(said))
    assert "names code, 'someones:Tracker' (tracker.kind)" in only(board / "hover").why
    shown(board)
    assert not (tmp_path / "ran").exists()


def test_code_is_run_for_those_who_trust_it(board, tmp_path, monkeypatch):
    (tmp_path / "trusted_hover.py").write_text("def act(picture):\n    return 6\n")
    monkeypatch.syspath_prepend(tmp_path)
    plan = EvaluationPlan(policy="trusted_hover:act", maps=("simpleway-grass",), episodes=1)
    plan = plan.model_copy(update={"env": {"observation": {"width": 16, "height": 12}}})
    run(plan, tmp_path / "own" / "entry", quiet=True)
    assert "--trust runs it" in only(tmp_path / "own").why
    assert only(tmp_path / "own", trust=True).verdict is EntryVerdict.VERIFIED


def test_a_network_is_found_in_the_folder_and_must_be_the_same(board, tmp_path):
    pytest.importorskip("onnxruntime")
    from eyas.benchmark.policies.shipped import file_of

    own = tmp_path / "elsewhere" / "mine.onnx"
    own.parent.mkdir()
    shutil.copy(file_of("fast"), own)
    entry = tmp_path / "one" / "entry"
    run(EvaluationPlan(policy=str(own), episodes=1), entry, quiet=True)
    own.unlink()
    assert "is not there" in only(entry).why
    shutil.copy(file_of("fast"), entry / "mine.onnx")
    assert only(entry).verdict is EntryVerdict.VERIFIED
    shutil.copy(file_of("eyas"), entry / "mine.onnx")
    assert "the policy's file is another" in only(entry).why


def edit_class(folder, entry_class):
    said = json.loads((folder / "run.json").read_text())
    said["entry"]["entry_class"] = entry_class
    (folder / "run.json").write_text(json.dumps(said))


def test_oracles_are_not_ranked_with_the_others(board):
    text = shown(board)
    assert text.index("<td>hover</td>") < text.index("<h3>Oracles</h3>") < text.index(">follow<")
    edit_class(board / "follow", "pixels")
    text = shown(board)
    assert "Oracles" not in text
    assert text.index("<td>follow</td>") < text.index("<td>hover</td>")
    assert "<td>pixels</td>" in text


def test_an_oracle_that_passes_for_one_that_sees_is_caught(board):
    edit_class(board / "follow", "pixels")
    found = only(board / "follow")
    assert found.verdict is EntryVerdict.DIFFERENT
    assert found.why == "its entry_class is told as pixels, but is privileged"


def test_what_tells_no_class_is_left_out(board, caplog):
    said = json.loads((board / "follow" / "run.json").read_text()) | {"entry": None}
    (board / "follow" / "run.json").write_text(json.dumps(said))
    assert "follow" not in shown(board)
    assert "does not tell what the policy sees" in caplog.text


def edit_build(folder, room):
    said = json.loads((folder / "run.json").read_text())
    said["build"]["rooms"][room] = "0"
    (folder / "run.json").write_text(json.dumps(said))


def test_what_other_programs_have_flown_stands_in_tables_of_its_own(board):
    edit_build(board / "hover", "engine/exports")  # writes films, flies nothing
    assert shown(board).count("<h2>") == 1
    edit_build(board / "hover", "engine/sim")
    assert shown(board).count("<h2>") == 2


def test_the_page_tells_seeds_hardware_and_latency(board):
    timing = json.loads((board / "hover" / "timing.json").read_text())
    text = shown(board)
    assert "seeds from 1000000" in text
    assert timing["machine"].split(",")[0] in text
    for wrong in ("[]", "{", '{"machine": 3}'):
        (board / "hover" / "timing.json").write_text(wrong)
        shown(board)


CARD = {
    "name": "Kestrel 2",
    "authors": ["A. Author", "B. Author"],
    "link": "https://example.org/kestrel",
    "trained_on": "citystreet, 2 M decisions",
    "license": "MIT",
}


def write_card(board, card):
    text = card if isinstance(card, str) else json.dumps(card)
    (board / "hover" / "card.json").write_text(text)


def test_a_card_is_shown(board):
    write_card(board, CARD)
    text = shown(board)
    assert '<a href="https://example.org/kestrel" rel="nofollow noopener">Kestrel 2</a>' in text
    for words in ("A. Author, B. Author", "trained on citystreet, 2 M decisions", "license MIT"):
        assert words in text
    write_card(board, {"name": "Short"})
    assert "Short" in shown(board)


@pytest.mark.parametrize(
    ("card", "said"),
    [
        (CARD | {"licence": "MIT"}, "did you mean 'license'"),
        ({"authors": ["A"]}, "name"),
        (CARD | {"link": "javascript:alert(1)"}, "must be an address"),
        (CARD | {"link": 'https://x" onmouseover="alert(1)'}, "must be an address"),
        (CARD | {"name": "x" * 301}, "name"),
        ("[]", "not a JSON object"),
        ("[" * 100_000, "not a card"),
        ("{" + " " * 2_000_000 + "}", "card.json"),
    ],
)
def test_a_card_that_is_none_leaves_its_entry_out_with_a_word(board, caplog, card, said):
    write_card(board, card)
    with pytest.raises(EyasError, match=r".") as caught:
        read_card(board / "hover")
    assert said in str(caught.value)
    assert [each.folder.name for each in submissions_in(board)] == ["follow"]
    assert said in caplog.text
    assert "hover" not in shown(board)


def test_what_a_card_says_is_text(board):
    evil = "</td><script>alert(1)</script>"
    write_card(board, dict.fromkeys(("name", "trained_on", "license", "remarks"), evil))
    (board / "hover" / "timing.json").write_text(json.dumps({"machine": evil}))
    text = shown(board)
    assert "<script" not in text
    assert text.count("&lt;script&gt;") == 5


def test_a_damaged_entry_does_not_take_the_page_with_it(board, caplog):
    (board / "hover" / "run.json").write_text("{")
    assert "follow" in shown(board)
    assert "hover: left out" in caplog.text


def test_a_share_is_a_share(board):
    for share in (0.0, 1.5, -1.0):
        with pytest.raises(EyasError, match="--share"):
            list(verify(board, share=share))


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("timing.json", '"machine": "', '"machine": "\\ud800'),
        ("run.json", '"policy": "', '"policy": "\\ud800'),
        ("episodes.jsonl", '"losses":', f'"losses":1{"0" * 400}'),
        ("episodes.jsonl", '"found_again":', f'"found_again":{2**62}'),
        ("episodes.jsonl", '"path":', '"path":1e300'),
        ("episodes.jsonl", '"cr":', '"cr":9999999999'),
        ("episodes.jsonl", '"tsr":', '"tsr":-9'),
    ],
)
def test_one_bad_entry_is_left_out_and_the_page_of_the_others_made(board, caplog, file, old, new):
    path = board / "hover" / file
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    page_text = shown(board)
    assert "follow" in page_text
    if file == "timing.json":
        assert "hover" in page_text  # the machine is not known, but the figures are
    else:
        assert "hover: left out: " in caplog.text


def test_the_file_of_an_entry_is_judged_and_the_verdict_names_it(board, tmp_path, eyas_command):
    write_card(board, CARD)
    file, verdict = tmp_path / "entry.zip", tmp_path / "verdict.json"
    film = board / "hover" / "videos" / "median.mp4"  # another test has it made, for 15 s
    film.parent.mkdir()
    film.write_bytes(b"a film")
    pack(board / "hover", file)
    done = eyas_command("leaderboard", "verify", file, "--verdict", verdict, "--seed", 1)
    assert done.returncode == 0, done.stderr
    said = json.loads(verdict.read_text())
    assert said["file"] == sha256(file.read_bytes()).hexdigest()
    (judged,) = said["runs"]
    assert judged["verdict"] == "verified"
    assert judged["content"] == judged["mark"]["content"] == content_hash(board / "hover")
    assert len(judged["mark"]["flown"]) == 2
    lines = lines_of(board / "hover")
    record = json.loads(lines[0])
    lines[0] = json.dumps(record | {"path": record["path"] + 0.5}).encode() + b"\n"
    (board / "hover" / "episodes.jsonl").write_bytes(b"".join(lines))
    pack(board / "hover", file)
    done = eyas_command(
        "leaderboard", "verify", file, "--verdict", verdict, "--seed", 1, "--share", 1
    )
    assert done.returncode == 1
    (judged,) = json.loads(verdict.read_text())["runs"]
    assert (judged["verdict"], judged["mark"]) == ("not as flown", None)


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["../run.json"], "'../run.json' is no file of an entry"),
        (["videos/best.mp4"], "is no file of an entry"),
        (["sub/mine.onnx"], "is no file of an entry"),
        (["run.json", "run.json"], "a file is there twice"),
        ([f"{number}.onnx" for number in range(17)], "17 files"),
        (["setup.py"], "'setup.py' is no file of an entry"),
    ],
)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_a_file_with_anything_else_is_refused(tmp_path, names, said):
    file = tmp_path / "entry.zip"
    with zipfile.ZipFile(file, "w") as archive:
        for name in names:
            archive.writestr(name, "{}")
    with pytest.raises(EyasError, match="not the file of an entry") as caught, unpacked(file):
        pass
    assert said in str(caught.value)
