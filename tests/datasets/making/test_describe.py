"""What a data set tells of itself: every number is counted again from labels, in plain Python."""

import collections
import csv
import hashlib
import html.parser
import itertools
import json
import math
import warnings

import pytest
import yaml

import eyas
from eyas.datasets.statistics import EDGES
from eyas.engine.recordings.format import CLASS_NAMES

pytestmark = pytest.mark.slow  # what its tests share takes long to make


@pytest.fixture(scope="module")
def statistics(made):
    return json.loads((made / "statistics.json").read_text())


@pytest.fixture(scope="module")
def frames(made):
    return [(episode, frame.label) for episode in eyas.load(made) for frame in episode]


def seen_in(label):
    others = [(each["visible_box"], each) for each in label["others"]]
    if label["visible_fraction"] > 0:
        target = {
            key: label[f"target_{key}"]
            for key in ("class_id", "velocity", "truncated", "distance", "type")
        }
        target["visible_fraction"] = label["visible_fraction"]
        others.append((label["target_visible_box"], target))
    return others


def counted(name, values):
    edges = EDGES[name]
    told = dict.fromkeys((f"{edge:g}" for edge in edges), 0)
    for value in values:
        told[f"{max(edge for edge in edges if edge <= value):g}"] += 1
    return told


def root_of_area(box):
    return math.sqrt((box[2] - box[0]) * (box[3] - box[1]))


def speed(velocity):
    return math.sqrt(sum(part * part for part in velocity))


def test_histograms_are_those_of_the_labels(statistics, frames):
    for split in ("train", "val", "test"):
        labels = [label for episode, label in frames if episode.split == split]
        seen = [each for label in labels for each in seen_in(label)]
        told = statistics["splits"][split]["histograms"]
        assert told["size"] == counted("size", [root_of_area(box) for box, _ in seen])
        assert told["visible"] == counted("visible", [one["visible_fraction"] for _, one in seen])
        assert told["truncated"] == counted("truncated", [one["truncated"] for _, one in seen])
        assert told["distance"] == counted("distance", [one["distance"] for _, one in seen])
        assert told["speed"] == counted("speed", [speed(one["velocity"]) for _, one in seen])
        assert told["objects"] == counted("objects", [len(seen_in(label)) for label in labels])
        own = statistics["splits"][split]["target_histograms"]
        visible = [label for label in labels if label["visible_fraction"] > 0]
        boxes = [root_of_area(label["target_visible_box"]) for label in visible]
        assert own["size"] == counted("size", boxes)
        assert own["speed"] == counted("speed", [speed(one["target_velocity"]) for one in visible])


def test_counts_are_those_of_the_labels(statistics, frames):
    told = statistics["total"]
    seen = [one for _, label in frames for _, one in seen_in(label)]
    assert told["frames"] == len(frames) == 48
    assert told["episodes"] == len({episode.name for episode, _ in frames}) == 8
    assert told["parts"] == 4
    assert told["objects"] == len(seen)
    classes = collections.Counter(CLASS_NAMES[one["class_id"]] for one in seen)
    assert told["classes"] == classes
    assert told["types"] == collections.Counter(one["type"] for one in seen)
    assert told["map"] == collections.Counter(each.config.world.map for each, _ in frames)
    assert told["weather"] == collections.Counter(each.config.world.weather for each, _ in frames)
    targets = collections.Counter()
    for _, label in frames:
        share = label["visible_fraction"]
        state = "wholly_visible" if share >= 0.999 else "partly_hidden" if share else "hidden"
        targets[state if label["in_view"] else "out_of_view"] += 1
        targets["cut_by_border"] += label["in_view"] and label["target_truncated"] > 0.001
        targets["look_alike_in_view"] += any(
            other["type"] == label["target_type"] for other in label["others"]
        )
    assert told["targets"] == {name: targets.get(name, 0) for name in told["targets"]}
    for name in ("occlusion", "size", "speed", "look-alikes"):
        kinds = [n for key, n in told["episodes_by"].items() if key.startswith(f"{name}: ")]
        assert sum(kinds) == told["episodes"]


def test_the_datasheet_tells_the_statistics(made, statistics):
    text = (made / "README.md").read_text()
    _, front, body = text.split("---\n", 2)
    matter = yaml.safe_load(front)
    assert matter["license"] == "cc-by-4.0"
    assert matter["size_categories"] == ["n<1K"]
    files = matter["configs"][0]["data_files"]
    found = {each["split"]: len(list(made.glob(each["path"]))) for each in files}
    assert found == {"train": 24, "validation": 12, "test": 12}
    assert f"with {statistics['total']['objects']} labelled moving objects" in body
    assert "eyas dataset make recipe.json --out DIR" in body
    assert eyas.build_id in body
    for split, counts in statistics["splits"].items():
        keys = ("frames", "episodes", "parts", "objects")
        numbers = " | ".join(str(counts[key]) for key in keys)
        assert f"| {split} | {numbers} | {', '.join(counts['map'])} |" in body
    rows = [line.split(" | ") for line in body.splitlines() if line.startswith("| ")]
    for name, count in statistics["total"]["classes"].items():
        assert [f"| {name}", f"{count} |"] in rows
    edges, sizes = EDGES["size"], statistics["total"]["histograms"]["size"]
    for low, high in itertools.pairwise(edges):
        assert [f"| {low:g} to {high:g}", f"{sizes[f'{low:g}']} |"] in rows


def test_frames_csv_has_every_frame(made, frames):
    with (made / "frames.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(frames)
    for row, (episode, label) in zip(rows, frames, strict=True):
        assert (made / row["picture"]) == episode.picture_file(label["frame"])
        assert (made / row["picture"]).exists()
        assert (row["split"], row["episode"]) == (episode.split, episode.name)
        box = [int(row[side]) for side in ("left", "top", "right", "bottom")]
        assert box == label["target_visible_box"]
        assert float(row["visible_fraction"]) == label["visible_fraction"]
        assert (row["target_words"], int(row["frame"])) == (label["target_words"], label["frame"])


@pytest.fixture
def offline(monkeypatch):
    def refused(*_, **__):
        raise AssertionError("no network")

    monkeypatch.setattr("socket.socket.connect", refused)


@pytest.mark.usefixtures("offline")
def test_croissant_is_valid_and_its_records_are_read(made, frames):
    mlcroissant = pytest.importorskip("mlcroissant")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of mlcroissant's own
        data = mlcroissant.Dataset(made / "croissant.json")
        records = list(data.records("frames"))
    assert not data.metadata.issues.errors
    assert not data.metadata.issues.warnings
    assert len(records) == len(frames)
    for record, (episode, label) in zip(records, frames, strict=True):
        assert record["frames/episode"].decode() == episode.name
        assert record["frames/frame"] == label["frame"]
        assert record["frames/left"] == label["target_visible_box"][0]
        assert record["frames/visible_fraction"] == label["visible_fraction"]
    described = json.loads((made / "croissant.json").read_text())
    for each in described["distribution"]:
        if each["@type"] == "cr:FileSet":
            count = {"labels": 8, "pictures-jpeg": 48}[each["@id"]]
            assert len(list(made.glob(each["includes"]))) == count
        else:
            content = (made / each["contentUrl"]).read_bytes()
            assert each["sha256"] == hashlib.sha256(content).hexdigest()


class Outside(html.parser.HTMLParser):
    """Gathers what a page would fetch, and its pictures."""

    def __init__(self):
        super().__init__()
        self.fetched, self.pictures, self.text = [], 0, ""

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name in ("src", "href") and not value.startswith("data:"):
                self.fetched.append(value)
        self.pictures += tag == "img"

    def handle_data(self, data):
        self.text += f" {data}"


def test_the_overview_needs_no_other_file(made, statistics):
    page = Outside()
    page.feed((made / "overview.html").read_text())
    assert page.fetched == []
    assert page.pictures == 3
    for split, counts in statistics["splits"].items():
        told = f"{counts['frames']} frames, {counts['episodes']} episodes"
        assert f"{split}: {told}, {counts['objects']} objects" in page.text


def test_dataset_json_tells_every_part(made, plan):
    told = json.loads((made / "dataset.json").read_text())
    assert told["command"] == "eyas dataset make recipe.json --out DIR"
    assert told["recipe"] == json.loads((made / "recipe.json").read_text())
    assert told["recipe"] == plan.recipe.model_dump(mode="json")
    assert (told["eyas"], told["build_id"]) == (eyas.__version__, eyas.build_id)
    for part in told["parts"]:
        sums = made / "parts" / part["split"] / part["name"] / "checksums.sha256"
        assert part["checksums"] == hashlib.sha256(sums.read_bytes()).hexdigest()
        assert part["frames"] == len(list(sums.parent.rglob("*.jpeg")))


def test_splits_share_no_seed_and_no_place(made):
    episodes = list(eyas.load(made))
    for key in (lambda each: each.config.seed, lambda each: each.config.world.map):
        found = collections.defaultdict(set)
        for each in episodes:
            found[each.split].add(key(each))
        assert len(set.union(*found.values())) == sum(map(len, found.values()))


def test_exports_hold_all_episodes(made):
    for split, frames in {"train": 24, "val": 12, "test": 12}.items():
        told = json.loads((made / "exports" / "coco" / "annotations" / f"{split}.json").read_text())
        assert len(told["images"]) == frames
        for image in told["images"]:
            assert (made / "exports" / "coco" / image["file_name"]).exists()
        names = (made / "exports" / "got10k" / split / "list.txt").read_text().split()
        assert len(names) == frames // 6
