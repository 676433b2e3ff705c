"""Train a small detector from scratch on a data set of Eyas, and tell how well it does.

    pip install torch pycocotools
    eyas dataset make detect --out runs/detect         # 10,000 pictures with COCO annotations
    python examples/detector.py runs/detect            # an hour on two cores
    python examples/detector.py runs/detect --film vtest.avi   # a film of real people, by eye

A network without anchors, after Zhou et al., "Objects as points" (2019): one map of scores for each
class, in which peaks are the middles of objects, and their sizes. It sees pictures of 320 x 240.
"""

import argparse
import json
import time
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
from PIL import Image, ImageDraw
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval
from torch import nn
from torch.nn import functional

WIDTH, HEIGHT, STRIDE = 320, 240, 4
"""What the network sees, and how much smaller its maps are."""

LEAST = 3
"""Smallest side of an object that is learnt [pixels]."""


class Data:
    """The pictures of a split, in memory, with their boxes.

    Args:
        folder: The data set.
        split: `train`, `val` or `test`.
    """

    def __init__(self, folder: Path, split: str) -> None:
        self.root = folder / "exports" / "coco"
        self.coco = COCO(self.root / "annotations" / f"{split}.json")
        self.ids = sorted(self.coco.imgs)
        self.pictures = np.empty((len(self.ids), HEIGHT, WIDTH, 3), np.uint8)
        self.boxes = []
        for row, number in enumerate(self.ids):
            about = self.coco.imgs[number]
            self.pictures[row] = seen(self.root / about["file_name"])
            scale = WIDTH / about["width"]
            own = [
                (each["category_id"] - 1, *np.multiply(each["bbox"], scale))
                for each in self.coco.imgToAnns[number]
            ]
            # What is smaller cannot be learnt; it counts in the test all the same.
            self.boxes.append([box for box in own if min(box[3:]) >= LEAST])


def seen(path):
    """Return a picture as the network sees it."""
    with Image.open(path) as picture:
        picture.draft("RGB", (WIDTH, HEIGHT))
        return np.asarray(picture.convert("RGB").resize((WIDTH, HEIGHT), Image.Resampling.BOX))


def block(inputs, outputs, stride=1):
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )


class Detector(nn.Module):
    """Scores (N, classes, H / 4, W / 4) and, in pixels, shifts and sizes (N, 4, H / 4, W / 4)."""

    def __init__(self, classes: int) -> None:
        super().__init__()
        self.second = block(3, 16, 2)
        self.quarter = nn.Sequential(block(16, 32, 2), block(32, 32))
        self.eighth = nn.Sequential(block(32, 64, 2), block(64, 64))
        self.sixteenth = nn.Sequential(block(64, 128, 2), block(128, 128))
        self.last = nn.Sequential(block(128, 160, 2), block(160, 160))
        self.sides = nn.ModuleList(nn.Conv2d(width, 48, 1) for width in (160, 128, 64, 32))
        self.joins = nn.ModuleList(block(48, 48) for _ in range(3))
        self.head = block(48, 64)
        self.scores, self.places = nn.Conv2d(64, classes, 1), nn.Conv2d(64, 4, 1)
        self.scores.bias.data.fill_(-4.0)  # objects are rare

    def forward(self, pictures):
        quarter = self.quarter(self.second(pictures))
        eighth = self.eighth(quarter)
        sixteenth = self.sixteenth(eighth)
        joined = self.sides[0](self.last(sixteenth))
        finer = (sixteenth, eighth, quarter)
        for side, join, level in zip(self.sides[1:], self.joins, finer, strict=True):
            wide = functional.interpolate(joined, size=level.shape[-2:])
            joined = join(wide + side(level))
        shared = self.head(joined)
        return self.scores(shared), self.places(shared)


def goals(boxes, classes):
    """Return the maps that the network should give for one picture, and where sizes count."""
    height, width = HEIGHT // STRIDE, WIDTH // STRIDE
    heat = np.zeros((classes, height, width), np.float32)
    places, counts = np.zeros((4, height, width), np.float32), np.zeros((height, width), bool)
    rows, columns = np.mgrid[:height, :width]
    for kind, left, top, wide, high in sorted(boxes, key=lambda box: -box[3] * box[4]):
        x, y = (left + wide / 2) / STRIDE, (top + high / 2) / STRIDE
        column, row = min(int(x), width - 1), min(int(y), height - 1)
        spread = np.array([max(wide, 4.0), max(high, 4.0)]) / STRIDE / 6
        near = ((columns - column) / spread[0]) ** 2 + ((rows - row) / spread[1]) ** 2
        heat[kind] = np.maximum(heat[kind], np.exp(-near / 2))
        places[:, row, column] = x - column, y - row, np.log(max(wide, 1)), np.log(max(high, 1))
        counts[row, column] = True
    return heat, places, counts


def as_input(pictures):
    tensor = torch.from_numpy(np.array(pictures)).permute(0, 3, 1, 2)
    return tensor.float().sub_(110.0).div_(60.0)


def loss_of(scores, places, heat, true_places, counts):
    """Return the focal loss of the scores, and the error of places and sizes."""
    chance = torch.sigmoid(scores).clamp(1e-4, 1 - 1e-4)
    peaks = heat == 1
    found = (1 - chance) ** 2 * torch.log(chance)
    missed = (1 - heat) ** 4 * chance**2 * torch.log(1 - chance)
    objects = peaks.sum().clamp(min=1)
    sizes = functional.l1_loss(places, true_places, reduction="none").sum(1)
    return -torch.where(peaks, found, missed).sum() / objects + (sizes * counts).sum() / objects


def varied(pictures, boxes, rng):
    """Return pictures mirrored and in other light, with their boxes."""
    pictures, boxes = pictures.copy(), [list(own) for own in boxes]
    for row in range(len(pictures)):
        if rng.random() < 0.5:
            pictures[row] = pictures[row, :, ::-1]
            boxes[row] = [(k, WIDTH - left - w, t, w, h) for k, left, t, w, h in boxes[row]]
        gain, shift = rng.uniform(0.7, 1.3), rng.uniform(-20, 20)
        pictures[row] = np.clip(pictures[row] * gain + shift, 0, 255).astype(np.uint8)
    return pictures, boxes


def train(data, minutes, epochs, classes):
    """Train until the time or the epochs are over, by a cosine of the rate of learning."""
    torch.manual_seed(0)
    rng, model, batch = np.random.default_rng(0), Detector(classes), 16
    print(f"{sum(p.numel() for p in model.parameters()):,} parameters, {len(data.ids)} pictures")
    optimiser = torch.optim.AdamW(model.parameters(), lr=2e-3, weight_decay=1e-4)
    begun, total = time.monotonic(), epochs * (len(data.ids) // batch)
    step, shown = 0, 0.0
    while True:
        order = rng.permutation(len(data.ids))
        for first in range(0, len(order) - batch + 1, batch):
            done = max(step / total, (time.monotonic() - begun) / (60 * minutes))
            if done >= 1:
                return model
            for group in optimiser.param_groups:
                group["lr"] = 2e-3 * min(1, (step + 1) / 200) * (0.5 + 0.5 * np.cos(np.pi * done))
            rows = order[first : first + batch]
            pictures, boxes = varied(data.pictures[rows], [data.boxes[row] for row in rows], rng)
            made = [
                np.stack(each) for each in zip(*(goals(b, classes) for b in boxes), strict=True)
            ]
            loss = loss_of(*model(as_input(pictures)), *map(torch.from_numpy, made))
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(model.parameters(), 10.0)
            optimiser.step()
            step, shown = step + 1, 0.98 * shown + 0.02 * loss.item()
            if step % 50 == 0:
                print(f"\r{done:5.1%} step {step} loss {shown:.3f}", end="", flush=True)


@torch.no_grad()
def found(model, pictures, most=60):
    """Yield the boxes of each picture: class, score, left, top, width, height."""
    model.eval()
    for first in range(0, len(pictures), 32):
        scores, places = model(as_input(pictures[first : first + 32]))
        chance = torch.sigmoid(scores)
        peaks = chance * (functional.max_pool2d(chance, 3, 1, 1) == chance)
        best, where = peaks.flatten(1).topk(most)
        height, width = chance.shape[-2:]
        for row in range(len(chance)):
            kind, cell = where[row] // (height * width), where[row] % (height * width)
            x, y, wide, high = places[row].flatten(1)[:, cell]
            wide, high = wide.clamp(max=6).exp(), high.clamp(max=6).exp()
            left = (cell % width + x) * STRIDE - wide / 2
            top = (cell // width + y) * STRIDE - high / 2
            yield torch.stack([kind, best[row], left, top, wide, high], 1).numpy()


def average_precision(data, results, images=None, area=None):
    """Return AP at overlaps 0.50 to 0.95 and at 0.50, by COCO's own tools."""
    judge = COCOeval(data.coco, results, "bbox")
    if images is not None:
        judge.params.imgIds = images
    if area is not None:
        judge.params.areaRng, judge.params.areaRngLbl = [area], ["all"]
    judge.params.areaRng = judge.params.areaRng[:1]
    judge.params.areaRngLbl = judge.params.areaRngLbl[:1]
    judge.evaluate()
    judge.accumulate()
    precision = judge.eval["precision"][:, :, :, 0, -1]  # overlap, recall, class
    counted = precision[:, :, (precision > -1).all(axis=(0, 1))]
    by_class = [
        float(precision[0, :, kind].mean()) if (precision[0, :, kind] > -1).all() else None
        for kind in range(precision.shape[2])
    ]
    if not counted.size:
        return None, None, by_class
    return float(counted.mean()), float(counted[0].mean()), by_class


def report(model, data, folder):
    """Print AP over all, and by class, weather, size and map; return it."""
    rows = []
    scale = data.coco.imgs[data.ids[0]]["width"] / WIDTH
    for number, boxes in zip(data.ids, found(model, data.pictures), strict=True):
        for kind, score, *box in boxes.tolist():
            box = [round(side * scale, 2) for side in box]
            rows.append({"image_id": number, "category_id": int(kind) + 1,
                         "bbox": box, "score": score})  # fmt: skip
    results = data.coco.loadRes(rows)
    told = {"all": average_precision(data, results)}
    names = [each["name"] for each in data.coco.dataset["categories"]]
    for name, value in zip(names, told["all"][2], strict=True):
        told[f"class {name}"] = (None, value)
    groups = defaultdict(list)
    worlds = conditions(folder)
    for number in data.ids:
        place, weather = worlds[data.coco.imgs[number]["file_name"].split("/")[1]]
        groups[f"map {place}"].append(number)
        groups[f"weather {weather}"].append(number)
    for name, images in sorted(groups.items()):
        told[name] = average_precision(data, results, images)[:2]
    sides = (0, 12, 24, 48, 96, 1e5)
    for low, high in pairwise(sides):
        area = average_precision(data, results, area=[low**2, high**2])
        told[f"size {low} to {high:g} px"] = area[:2]
    for name, values in told.items():
        print(f"{name:24}", *("   -  " if v is None else f"{v:6.3f}" for v in values[:2]))
    return {name: values[:2] for name, values in told.items()}


def conditions(folder):
    """Return map and weather of each episode."""
    import eyas

    return {
        episode.name: (episode.config.world.map, episode.config.world.weather)
        for episode in eyas.load(folder)
    }


def draw(picture, boxes, least=0.3):
    """Return a picture with the boxes whose score is high enough."""
    image = Image.fromarray(picture)
    pen = ImageDraw.Draw(image)
    for _, score, left, top, wide, high in boxes.tolist():
        if score >= least:
            pen.rectangle((left, top, left + wide, top + high), outline="orange")
    return image


def show_film(model, path, out):
    """Save some pictures of a film with what is found in them."""
    import av

    with av.open(str(path)) as film:
        for number, frame in enumerate(film.decode(video=0)):
            if number % 100 == 0:
                picture = np.asarray(frame.to_image().resize((WIDTH, HEIGHT)))
                (boxes,) = found(model, picture[None])
                draw(picture, boxes).resize((2 * WIDTH, 2 * HEIGHT)).save(
                    out / f"film-{number:04d}.png"
                )


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="data set with exports/coco")
    parser.add_argument("--out", type=Path, default=Path("runs/detector"))
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--epochs", type=int, default=12)
    parser.add_argument("--film", type=Path, help="show what a trained one finds in a film")
    said = parser.parse_args()
    said.out.mkdir(parents=True, exist_ok=True)
    weights = said.out / "detector.pt"
    classes = 6
    if said.film is None:
        model = train(Data(said.folder, "train"), said.minutes, said.epochs, classes)
        torch.save(model.state_dict(), weights)
        print()
        told = report(model, Data(said.folder, "test"), said.folder)
        (said.out / "ap.json").write_text(json.dumps(told, indent=1) + "\n")
        return
    model = Detector(classes)
    model.load_state_dict(torch.load(weights, weights_only=True))
    show_film(model, said.film, said.out)


if __name__ == "__main__":
    main()
