"""Count what a card would do for a picture, without one: see `emulated_card`.

    python tools/profile_card.py                        # 64 views, shared as 4,096 are
    python tools/profile_card.py --size 640 480 --views 4 --as 256 --weather snow --blocks 10

For each stage it prints, for a view: instructions of warps, how many of their 32 threads took part,
and pieces of 32 bytes of memory that were touched. With `--blocks` the pieces of its program follow
in which most instructions were spent. It says nothing of how long a card waits for memory, or for
its slower instructions.
"""

import argparse
import re
import shutil
import sys
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np
from emulated_card import EmulatedCard, Loaded, emulated_card
from numpy.typing import NDArray

import eyas.gpu.render.device as drawing
from eyas.cli.bench.device import on_device
from eyas.cli.bench.pictures import PictureBatch
from eyas.gpu.cuda import CudaDevice, cuda_device
from eyas.gpu.render import stages

_TEXT = 16
"""Instructions of a block that are shown at most."""


def main() -> int:
    """Draw once and print."""
    asked = _arguments()
    if shutil.which("cc") is None:
        print("profile_card: it needs a C compiler, cc", file=sys.stderr)
        return 2
    drawing.SEEKING = drawing.SEEKING * asked.views // asked.shared_as
    drawing.SHADING = drawing.SHADING * asked.views // asked.shared_as
    batch = PictureBatch(asked.views, *asked.size, weather=asked.weather, samples=asked.samples)
    with emulated_card() as card:
        device = cuda_device()
        names = _watched(device, card)
        renderer, given = on_device(device, batch)
        renderer.draw_uploaded(given)
        print(f"{'of a view':20} instructions  threads  pieces of memory")
        for loaded in card.programs.values():
            _print(names[loaded.program.entry], loaded, asked.views, asked.blocks)
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--views", type=int, default=64)
    parser.add_argument("--as", type=int, default=4096, dest="shared_as", metavar="VIEWS",
                        help="share the work as if there were so many")  # fmt: skip
    parser.add_argument("--size", type=int, nargs=2, default=(84, 84), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--weather", default="day")
    parser.add_argument("--samples", type=int, default=1)
    parser.add_argument("--blocks", type=int, default=0, help="show so many of each stage")
    return parser.parse_args()


def _watched(device: CudaDevice, card: EmulatedCard) -> dict[str, str]:
    """Return a table that is filled with the names of stages, by program, as they are launched."""
    known = {id(getattr(stages, name)): name for name in stages.__all__}
    names: dict[str, str] = defaultdict(str)
    usual = device.launch

    def launch(call: Any, *rest: Any, **options: Any) -> None:  # noqa: ANN401
        before = {address: one.turns.sum() for address, one in card.programs.items()}
        usual(call, *rest, **options)
        for address, one in card.programs.items():
            if one.turns.sum() != before.get(address, 0):
                names[one.program.entry] = known.get(id(call), call.function.__name__)

    device.launch = launch  # type: ignore[method-assign]
    return names


def _print(name: str, loaded: Loaded, views: int, blocks: int) -> None:
    once = _first_of_several(loaded.program.lines)
    turns, threads, pieces = (
        counts * once for counts in (loaded.turns, loaded.threads, loaded.pieces)
    )
    shares = turns.sum() / views, threads.sum() / max(turns.sum(), 1), pieces.sum() / views
    print(f"{name:20} {shares[0]:12,.0f} {shares[1]:8.1f} {shares[2]:17,.0f}")
    pieces_of_program = list(_blocks(turns, threads, loaded.program.lines))
    pieces_of_program.sort(key=lambda block: int(turns[block[0] : block[1]].sum()), reverse=True)
    for first, last in pieces_of_program[:blocks]:
        spent = turns[first:last].sum() / turns.sum()
        together = threads[first] / max(turns[first], 1)
        print(f"  {spent:.1%}, {turns[first] / views:,.1f} times, {together:.1f} threads:")
        for line in loaded.program.lines[first : min(last, first + _TEXT)]:
            print(f"      {line[:90]}")


def _first_of_several(lines: list[str]) -> NDArray[np.uint64]:
    """Return 1 for each instruction, and 0 for what is emulated as another part of the last one."""
    again = [
        bool(re.search(r"\.v[24]\.|\{", line)) and line == last
        for line, last in zip(lines, ["", *lines[:-1]], strict=True)
    ]
    return 1 - np.array(again, np.uint64)


def _blocks(
    turns: NDArray[np.uint64], threads: NDArray[np.uint64], lines: list[str]
) -> Iterator[tuple[int, int]]:
    """Return the first and the last + 1 of instructions that are done together."""
    first = 0
    for k in range(1, len(lines) + 1):
        ends = k == len(lines) or re.match(r"@|bra|ret|call|brx", lines[k - 1]) is not None
        if ends or turns[k] != turns[k - 1] or threads[k] != threads[k - 1]:
            yield first, k
            first = k


if __name__ == "__main__":
    sys.exit(main())
