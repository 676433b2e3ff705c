"""Comparing, ranking, plotting and filming evaluations."""

import json
import shutil
from html.parser import HTMLParser

import numpy as np
import pytest
from typer.testing import CliRunner

from eyas.benchmark.evaluation import run
from eyas.benchmark.plan.plan import _NOT_FLOWN, EvaluationPlan, batches
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.benchmark.records.record import read_records
from eyas.benchmark.records.result import FEW_SEEDS, NO_INTERVALS, load_run, table
from eyas.benchmark.report import films as evaluation_films
from eyas.benchmark.report.films import chosen_flights
from eyas.benchmark.report.leaderboard import page as leaderboard
from eyas.benchmark.statistics.comparison import differences, verdict
from eyas.benchmark.statistics.table_rows import rows_of, thirds
from eyas.cli.app import app
from eyas.engine.core.errors import EyasError
from eyas.engine.core.identity.build import this_build

NAMES = ("hover", "follow")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Evaluations of hover and follow."""
    folder = tmp_path_factory.mktemp("results")
    for name in ("hover", "follow"):
        run(EvaluationPlan(policy=name, episodes=2), folder / name, quiet=True)
    return folder


PAPER = PROTOCOLS.get("paper")


def records(folder, name):
    return read_records(folder / name / "episodes.jsonl")


def test_all_protocols_differ():
    names = PROTOCOLS.built_in
    assert len({PROTOCOLS.get(name).hash for name in names}) == len(names)


def with_shares(folder, *shares):
    record = records(folder, "follow")[0]
    return [record.model_copy(update={"clear": share}) for share in shares]


def test_thirds_are_ordered_by_what_can_be_seen(folder):
    names = thirds(with_shares(folder, 0.9, 0.1, 0.5, 0.6, 0.95, 0.2))
    assert [name[0] for name in names] == ["3", "1", "2", "2", "3", "1"]
    assert names[1] == names[5] == "1 hidden 0.100-0.200"


def test_targets_that_are_equally_visible_are_in_the_same_third(folder):
    names = thirds(with_shares(folder, 1.0, 1.0, 0.4, 1.0, 1.0, 1.0, 1.0))
    assert [name[0] for name in names] == ["3", "3", "1", "3", "3", "3", "3"]


def test_the_third_is_the_episodes_and_not_the_policys(folder):
    assert thirds(records(folder, "hover")) == thirds(records(folder, "follow"))


def test_a_row_holds_the_mean_of_its_records(folder):
    flown = records(folder, "hover")
    rows = rows_of(flown, PAPER)
    assert rows[0].figures["cr"].mean == pytest.approx(np.mean([each.cr for each in flown]))
    assert sum(len(row.records) for row in rows if row.group == "visibility") == len(flown)


def test_as_published_drops_episodes_without_reward(folder):
    flown = records(folder, "hover")
    nothing = flown[0].published.model_copy(update={"cr": 0.0})
    dropped = [flown[0].model_copy(update={"published": nothing}), *flown[1:]]
    assert rows_of(dropped, PAPER, as_published=True)[0].figures["cr"].n == len(flown) - 1
    assert rows_of(dropped, PAPER)[0].figures["cr"].n == len(flown)


def test_differences_are_paired(folder):
    hover, follow = records(folder, "hover"), records(folder, "follow")
    first = differences(hover, follow[::-1][:5], PAPER)[0]
    assert (first.group, first.figure, first.n) == ("all", "cr", 5)
    names = {record.name for record in follow[::-1][:5]}
    chosen = [record.cr for record in hover if record.name in names]
    assert first.first == pytest.approx(np.mean(chosen))
    assert first.improved == 1.0
    assert first.interval.low <= first.mean <= first.interval.high
    same = differences(hover, hover, PAPER)[0]
    assert (same.mean, same.improved, same.needed) == (0.0, 0.5, None)
    assert same.interval == pytest.approx((-375 * 3 / 8, 375 * 3 / 8))


def test_what_has_nothing_in_common_is_not_compared(folder, tmp_path):
    with pytest.raises(EyasError, match="no episode in common"):
        differences(records(folder, "hover")[:2], records(folder, "hover")[2:], PAPER)
    other = json.loads((folder / "hover" / "run.json").read_text())
    (tmp_path / "run.json").write_text(json.dumps({**other, "protocol": "0123456789ab"}))
    answer = CliRunner().invoke(app, ["compare", str(folder / "hover"), str(tmp_path)])
    assert isinstance(answer.exception, EyasError)
    assert "not comparable" in str(answer.exception)


def other_build(folder, out, room):
    """Copy an evaluation, as if a build with another room had flown it."""
    shutil.copytree(folder, out)
    said = json.loads((out / "run.json").read_text())
    said["build"]["rooms"][room] = "0"
    (out / "run.json").write_text(json.dumps(said))
    return out


def test_what_another_build_has_flown_is_compared_and_continued_only_if_asked(folder, tmp_path):
    changed = other_build(folder / "follow", tmp_path / "a", "engine/targets")
    words = ["compare", str(folder / "hover"), str(changed)]
    answer = CliRunner().invoke(app, words)
    assert isinstance(answer.exception, EyasError)
    assert "of Eyas; the world differs in engine/targets; fly one again, or" in str(
        answer.exception
    )
    assert "B - A" in CliRunner().invoke(app, [*words, "--across-builds"]).output
    figures = other_build(folder / "follow", tmp_path / "b", "benchmark")
    answer = CliRunner().invoke(app, ["compare", str(folder / "hover"), str(figures)])
    assert "they differ in benchmark;" in str(answer.exception)
    heard = other_build(folder / "follow", tmp_path / "c", "robotics")
    assert "B - A" in CliRunner().invoke(app, ["compare", words[1], str(heard)]).output
    plan, _ = load_run(changed)
    with pytest.raises(EyasError, match=r"cannot be continued: .* differs from this one in engin"):
        run(plan.plan, changed, resume=True, quiet=True)
    run(plan.plan, heard, resume=True, quiet=True)


def test_the_command_prints_both_ways(folder):
    names = [str(folder / "hover"), str(folder / "follow")]
    said = CliRunner().invoke(app, ["compare", *names]).output.splitlines()
    assert said[0].startswith("cr: follow is better (")
    assert any("B - A" in line for line in said)
    found = json.loads(CliRunner().invoke(app, ["compare", *names, "--json"]).output)
    assert found[0]["mean"] > 200.0


class Texts(HTMLParser):
    """Collects the texts of a page, and checks that its tags are closed in order."""

    def __init__(self, page):
        super().__init__()
        self.open, self.found = [], []
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.found.append(data.strip())


class Tags(HTMLParser):
    """All tags of a page, and where its texts try to be tags."""

    def __init__(self):
        super().__init__()
        self.found = set()

    def handle_starttag(self, tag, attrs):
        self.found.add(tag)


def test_nothing_that_an_evaluation_of_others_says_becomes_markup_or_is_loaded(
    folder, tmp_path, monkeypatch
):
    (tmp_path / "someones.py").write_text("raise BaseException('it was imported')")
    monkeypatch.syspath_prepend(tmp_path)
    evil = "</code><script>alert(1)</script>"
    shutil.copytree(folder / "hover", tmp_path / "theirs")
    path = tmp_path / "theirs" / "run.json"
    said = json.loads(path.read_text())
    said |= {"policy": evil, "version": evil, "protocol": PROTOCOLS.get("paper").hash}
    plan = {"policy": evil, "latency": evil, "weathers": [evil], "targets": [evil]}
    said["plan"] |= {**plan, "maps": ["someones:IT"], "protocol": "paper", "env": {evil: evil}}
    path.write_text(json.dumps(said))
    leaderboard.run(tmp_path / "theirs", tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text()
    tags = Tags()
    tags.feed(page)
    assert "alert(1)" in page
    assert "script" not in tags.found


def test_the_leaderboard_ranks_and_tells_how_to_repeat(folder, tmp_path):
    page = tmp_path / "index.html"
    leaderboard.run(folder, page)
    texts = Texts(page.read_text()).found
    assert texts.index("hover") < texts.index("Oracles") < texts.index("follow")
    assert "eyas evaluate --policy follow --episodes 2" in texts
    body = texts[len(texts) - texts[::-1].index("Eyas leaderboard") :]
    assert next(filter(None, body)).startswith("Results repeat to the bit")


def test_unfinished_evaluations_are_left_out_with_a_word(folder, tmp_path, caplog):
    part = tmp_path / "part"
    part.mkdir()
    (part / "run.json").write_bytes((folder / "hover" / "run.json").read_bytes())
    line = (folder / "hover" / "episodes.jsonl").read_bytes().splitlines(keepends=True)[0]
    (part / "episodes.jsonl").write_bytes(line)
    with pytest.raises(EyasError, match="no finished evaluation"):
        leaderboard.run(tmp_path, tmp_path / "index.html")
    assert "7 episodes are missing" in caplog.text


def test_worst_median_and_best_are_chosen(folder):
    chosen = chosen_flights(records(folder, "hover"))
    assert chosen["worst"].cr <= chosen["median"].cr <= chosen["best"].cr


@pytest.mark.slow
def test_plots_and_films_are_written(folder, tmp_path):
    pytest.importorskip("matplotlib")
    import av

    run(EvaluationPlan(policy="hover", episodes=1), tmp_path, plots=True, videos=True, quiet=True)
    for name in ("reward", "lost", "flights-citystreet"):
        assert (tmp_path / "plots" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    for name in ("worst", "median", "best"):
        with av.open(str(tmp_path / "videos" / f"{name}.mp4")) as film:
            assert film.streams.video[0].frames == 93  # one every 32 ms of 3 s


def test_an_interrupted_film_leaves_nothing_behind(folder, tmp_path, monkeypatch):
    plan = EvaluationPlan(policy="hover", episodes=1)
    names = {episode.name for part in batches(plan) for episode in part}
    assert len(names) == plan.count
    shoot, pictures = evaluation_films._Camera.shoot, iter(range(20))

    def interrupted(camera, *seen):
        if next(pictures, None) is None:
            raise KeyboardInterrupt
        shoot(camera, *seen)

    monkeypatch.setattr(evaluation_films._Camera, "shoot", interrupted)
    flown = [record for record in records(folder, "hover") if record.name in names]
    with pytest.raises(KeyboardInterrupt):
        evaluation_films.film(tmp_path, plan, flown)
    assert not list((tmp_path / "videos").iterdir())


def test_a_latency_curve_has_a_point_and_a_folder_for_each_latency(tmp_path):
    arguments = ["--policy", "follow", "--episodes", "1", "--latency-curve", "--out", str(tmp_path)]
    answer = CliRunner().invoke(app, ["evaluate", *arguments])
    assert "160 ms" in answer.output
    points = json.loads((tmp_path / "latency.json").read_text())["points"]
    assert [point["latency_ms"] for point in points] == [0, 20, 40, 80, 160]
    means = [point["figures"]["cr"][0] for point in points]
    assert means == sorted(means, reverse=True)
    assert (tmp_path / "latency-40" / "result.json").exists()
    with pytest.raises(EyasError, match="cannot be used together"):
        raise CliRunner().invoke(app, ["evaluate", *arguments, "--latency", "5"]).exception


def test_the_same_seeds_in_several_weathers_are_one_observation_each(folder):
    day = records(folder, "hover")
    night = [each.model_copy(update={"weather": "night"}) for each in day]
    rows = {row.name: row for row in rows_of([*day, *night], PAPER)}
    for name, figure in rows["all"].figures.items():
        alone = rows["night"].figures[name]
        assert (figure.seeds, figure.interval) == (8, alone.interval), name
        assert figure.mean == pytest.approx(alone.mean)
    assert " 16 (8 seeds) " in table(list(rows.values()), "paper")
    others = [each.model_copy(update={"name": f"{each.name}+"}) for each in night]
    follow = {each.seed: each for each in records(folder, "follow")}
    second = [follow[each.seed].model_copy(update={"name": each.name}) for each in [*day, *others]]
    found = differences([*day, *others], second, PAPER)
    intervals = {each.name: each.interval for each in found if each.figure == "cr"}
    assert intervals["all"] == pytest.approx(intervals["night"])


def test_too_few_seeds_have_no_interval_and_one_line_says_so(folder):
    rows = rows_of(records(folder, "hover")[:4], PAPER)
    text = table(rows, "paper").splitlines()
    assert all(figure.interval is None for figure in rows[0].figures.values())
    assert "[-]" in text[1]
    assert text.count(NO_INTERVALS) == 1
    assert FEW_SEEDS not in text
    assert FEW_SEEDS in table(rows_of(records(folder, "hover"), PAPER), "paper")
    found = differences(records(folder, "hover")[:4], records(folder, "follow")[:4], PAPER)
    assert found[0].interval is None
    assert all("too few independent seeds" in line for line in verdict(found, NAMES, PAPER.rank))


def test_sets_of_seeds_are_pooled_and_each_has_a_row(folder):
    first = records(folder, "hover")
    second = [each.model_copy(update={"seed": each.seed + 10_000_000}) for each in first]
    rows = rows_of([*first, *second], PAPER)
    sets = [row for row in rows if row.group == "seeds"]
    assert [row.name for row in sets] == ["from 1000000", "from 11000000"]
    assert [len(row.records) for row in sets] == [8, 8]
    assert rows[0].figures["cr"].seeds == 16
    assert not [row for row in rows_of(first, PAPER) if row.group == "seeds"]


def test_what_can_be_solved_has_a_row_of_its_own(folder):
    flown = records(folder, "hover")
    told = [each.model_copy(update={"solvable": place > 1}) for place, each in enumerate(flown)]
    row = next(row for row in rows_of(told, PAPER) if row.group == "solvable")
    assert row.records == told[2:]
    assert row.label == "solvable"
    assert not [row for row in rows_of(flown, PAPER) if row.group == "solvable"]


def test_a_protocols_own_figures_are_in_the_rows_and_those_not_known_are_left_out(folder):
    flown = records(folder, "hover")
    own = [{"share": 1.0, "gap": -0.5 + place, "wait": None} for place in range(8)]
    own[0] |= {"share": None, "wait": 7.0}
    told = [
        each.model_copy(update={"figures": values}) for each, values in zip(flown, own, strict=True)
    ]
    figures = rows_of(told, PAPER)[0].figures
    assert (figures["share"].n, figures["share"].mean) == (7, 1.0)
    assert figures["share"].interval.high == 1.0
    assert np.mean(figures["gap"].interval) == pytest.approx(figures["gap"].mean)
    assert (figures["wait"].n, figures["wait"].mean, figures["wait"].interval) == (1, 7.0, None)


def test_a_gap_is_a_difference_even_where_it_never_falls_below_0(folder):
    flown = records(folder, "hover")
    told = [each.model_copy(update={"figures": {"language_gap": 0.0}}) for each in flown]
    assert rows_of(told, PAPER)[0].figures["language_gap"].interval.low == 0.0
    gap = rows_of(told, PROTOCOLS.get("referring"))[0].figures["language_gap"]
    assert gap.interval == pytest.approx((-3 / 8, 3 / 8))


def test_a_protocols_own_figures_are_compared_where_both_have_them(folder):
    flown = records(folder, "hover")
    values = (None, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    first = [
        each.model_copy(update={"figures": {"recovered": value}})
        for each, value in zip(flown, values, strict=True)
    ]
    second = [each.model_copy(update={"figures": {"recovered": 1.0}}) for each in flown]
    found = differences(first, second, PROTOCOLS.get("recover"))
    whole = next(each for each in found if (each.group, each.figure) == ("all", "recovered"))
    assert (whole.n, whole.first, whole.second) == (7, pytest.approx(1 / 7), 1.0)
    first, _ = verdict(found, ("hover", "mine"), PROTOCOLS.get("recover").rank)
    assert first == "recovered: mine is better (1.000 of mine, 0.143 of hover, in 7 episodes)"


def test_a_flight_without_a_loss_has_found_its_target(folder):
    flown = records(folder, "follow")
    assert rows_of(flown, PAPER)[0].figures["flawless"].mean == 1.0
    never = {"found_after": None, "losses": 0}
    changes = ({"losses": 1}, never, {}, {}, {}, {}, {}, {})
    told = [each.model_copy(update=one) for each, one in zip(flown, changes, strict=True)]
    assert rows_of(told, PAPER)[0].figures["flawless"].mean == 0.75


def test_the_comparison_says_how_many_episodes_would_tell(folder):
    hover, follow = records(folder, "hover"), records(folder, "follow")
    first, _ = verdict(differences(hover, follow, PAPER), NAMES, PAPER.rank)
    assert first.startswith("cr: follow is better (")
    first, _ = verdict(differences(follow, hover, PAPER), NAMES[::-1], PAPER.rank)
    assert first.startswith("cr: follow is better (")
    changed = [
        each.model_copy(update={"tsr": each.tsr + (0.1, -0.09)[place % 2]})
        for place, each in enumerate(hover)
    ]
    rank, tsr = verdict(differences(hover, changed, PAPER), NAMES, PAPER.rank)
    assert tsr.startswith("tsr: it is open which is better (")
    assert "; about 3,200 would tell" in tsr
    assert rank == "cr: no difference between hover and follow in 8 episodes"


def test_what_has_no_part_in_an_evaluation_are_rooms_of_the_build():
    assert this_build().rooms.keys() >= {*_NOT_FLOWN}
