"""One picture of each map in each weather, side by side, out of a whole gallery.

eyas maps gallery --out runs/gallery
python tools/gallery_sheet.py runs/gallery docs/images/gallery.jpg
"""

import argparse
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

WEATHERS = ("day", "night", "foggy", "snow")
FIRST = ("citystreet", "downtown", "lake", "village", "desert", "farmland")
SHOWN = {"downtown": "span-along", "village": "span-along"}
"""The picture of a map, where it is not the overview."""
SIDE, MARGIN, LABEL = (320, 240), 6, 22


def main() -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("gallery", type=Path, help="folder of `eyas maps gallery`")
    parser.add_argument("out", type=Path, help="picture to write")
    asked = parser.parse_args()
    pairs = [folder.name.rsplit("-", 1) for folder in asked.gallery.iterdir() if folder.is_dir()]
    simple = {name for name, _ in pairs if name.startswith("simpleway")}
    rows = [[name] for name in (*FIRST, *sorted(simple - {"simpleway-city", "simpleway-clinker"}))]
    rows.append(["simpleway-clinker", "simpleway-city"])  # in two weathers and in one
    size = (SIDE[0] + MARGIN, SIDE[1] + LABEL)
    sheet = Image.new("RGB", (4 * size[0] + MARGIN, len(rows) * size[1] + MARGIN), (24, 25, 27))
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    for row, names in enumerate(rows):
        places = [(name, kind) for name in names for kind in WEATHERS if [name, kind] in pairs]
        for column, (name, kind) in enumerate(places):
            view = SHOWN.get(name, "overview")
            picture = Image.open(asked.gallery / f"{name}-{kind}" / f"{view}.png").convert("RGB")
            left, top = MARGIN + column * size[0], MARGIN + row * size[1]
            sheet.paste(picture.resize(SIDE, Image.Resampling.LANCZOS), (left, top))
            spot = (left, top + SIDE[1] + 2)
            pen.text(spot, f"{name}, {kind}", (200, 201, 203), font=font)
    sheet.save(asked.out, quality=82)


if __name__ == "__main__":
    main()
