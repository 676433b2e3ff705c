"""One thread for PyTorch: on a busy machine, more wait for each other."""

import pytest

torch = pytest.importorskip("torch")
torch.set_num_threads(1)
