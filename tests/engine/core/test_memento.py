"""What objects remember."""

import numpy as np
import pytest

from eyas.engine.core.memento import recall, remember


class Counter:
    """Remembers numbers of several kinds."""

    def __init__(self) -> None:
        self.count, self.name = 0, "counter"
        self.free, self.by_name = [1, 2], {"a": np.zeros(2), "b": 1}
        self.table = np.zeros(3)
        self.table.setflags(write=False)
        self.alias = self.by_name["a"]


def test_all_that_changes_is_put_into_another_object():
    one, other = Counter(), Counter()
    one.count, one.by_name["b"] = 5, 2
    one.by_name["a"][:] = 7.0
    one.free.append(3)
    memento = remember(one, ())
    one.by_name["a"][:] = 8.0
    recall(other, memento)
    assert (other.count, other.by_name["b"], other.free) == (5, 2, [1, 2, 3])
    assert other.alias is other.by_name["a"]
    assert other.alias.tolist() == [7.0, 7.0]
    assert not any("table" in path for path in memento)


def test_nothing_unknown_is_left_out_silently():
    counter = Counter()
    counter.by_name["c"] = memoryview(b"")
    with pytest.raises(TypeError, match=r"^by_name\.c: a memoryview cannot be copied$"):
        remember(counter, ())
    assert remember(counter, (memoryview,))
