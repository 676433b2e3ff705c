"""Where threads that part at a branch meet again: at its immediate post-dominator, the first place
that all of them come to. The compilers of cards have them meet there, too.
"""

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from emulated_card.instructions import CONTROL

__all__ = ["meetings"]

_BRANCH, _TABLE, _RETURN, _EXIT = (CONTROL.index(n) for n in ("bra", "brx.idx", "ret", "exit"))

_END = -1
"""What follows the last block of a function."""


def meetings(
    instructions: NDArray[np.void], targets: NDArray[np.int32], starts: Iterable[int]
) -> NDArray[np.int32]:
    """Return for each branch where those meet that part there; -1: nowhere.

    Args:
        instructions: The program.
        targets: See `Program`.
        starts: The first instruction of each function.
    """
    found = np.full(len(instructions), _END, np.int32)
    bounds = [*sorted(starts), len(instructions)]
    for first, end in pairwise(bounds):
        blocks = _blocks(instructions, first, end)
        after = {block: _after(instructions, targets, last) for block, last in blocks.items()}
        meet = _post_dominators(after)
        for block, last in blocks.items():
            found[last] = meet.get(block, _END)
    return found


def _blocks(instructions: NDArray[np.void], first: int, end: int) -> dict[int, int]:
    """Return the first and the last instruction of each block of a function."""
    parts = np.isin(instructions["code"][first:end], (_BRANCH, _TABLE, _RETURN, _EXIT))
    begins = instructions["leads"][first:end] > 0
    begins[1:] |= parts[:-1]
    blocks = (first + np.flatnonzero(begins)).tolist()
    return dict(zip(blocks, [*(block - 1 for block in blocks[1:]), end - 1], strict=True))


def _after(instructions: NDArray[np.void], targets: NDArray[np.int32], last: int) -> list[int]:
    """Return the blocks that follow one, by its last instruction."""
    row = instructions[last]
    code, to = int(row["code"]), int(row["offset"])
    if code == _BRANCH:
        return [to] if row["guard"] < 0 else [last + 1, to]
    if code == _TABLE:
        ways: list[int] = targets[to + 1 : to + 1 + targets[to]].tolist()
        return ways
    if code == _EXIT:
        return []  # the others do not wait for a thread that has ended
    return [_END] if code == _RETURN else [last + 1]


def _post_dominators(after: dict[int, list[int]]) -> dict[int, int]:
    """Return each block's immediate post-dominator.

    Source: Cooper, Harvey and Kennedy, "A Simple, Fast Dominance Algorithm", on the reversed graph.
    """
    order = _from_the_end(after)
    number = {block: k for k, block in enumerate(order)}
    meet, before = {_END: _END}, {}
    while before != meet:
        before = dict(meet)
        for block in order[1:]:
            known = [other for other in after[block] if other in meet]
            new = known[0]
            for other in known[1:]:
                while new != other:
                    if number[new] > number[other]:
                        new = meet[new]
                    else:
                        other = meet[other]
            meet[block] = new
    return meet


def _from_the_end(after: dict[int, list[int]]) -> list[int]:
    """Return the blocks that lead to the end, each behind one of those that follow it: the order in
    which a search in depth from the end leaves them, reversed.
    """
    leads: dict[int, list[int]] = {}
    for block, others in after.items():
        for other in others:
            leads.setdefault(other, []).append(block)
    order, seen, stack = [], {_END}, [(_END, iter(leads.get(_END, [])))]
    while stack:
        block, rest = stack[-1]
        new = next((other for other in rest if other not in seen), None)
        if new is None:
            order.append(block)
            stack.pop()
        else:
            seen.add(new)
            stack.append((new, iter(leads.get(new, []))))
    return order[::-1]
