"""A device whose memory is apart, as a card's is: only through it is it read and written."""

from array import array

import numpy as np

from eyas.lanes import PackedBundle


class ApartArray:
    """An array there; PyTorch shares it."""

    def __init__(self, memory):
        self.memory = memory
        self.shape, self.dtype, self.nbytes = memory.shape, memory.dtype, memory.nbytes

    def __getitem__(self, rows):
        assert isinstance(rows, slice)
        return ApartArray(self.memory[rows])

    def __len__(self):
        return len(self.memory)

    def reshape(self, *shape):
        return ApartArray(self.memory.reshape(*shape))

    def __array__(self, *_, **__):
        raise TypeError("read here what is there")

    def __dlpack__(self, **options):
        return self.memory.__dlpack__()

    def __dlpack_device__(self):
        return self.memory.__dlpack_device__()


class ApartDevice:
    """One that does as `eyas.gpu.cuda.device.CudaDevice`: arrays of numpy are copied once."""

    name = "apart"

    def __init__(self, workers=1):
        self._workers, self._copies = workers, {}

    def empty(self, shape, dtype):
        made = np.empty(shape, dtype)
        made.reshape(-1).view(np.uint8)[:] = 0xA5
        return ApartArray(made)

    def zeros(self, shape, dtype):
        return ApartArray(np.zeros(shape, dtype))

    def upload(self, array):
        return ApartArray(np.array(array, order="C"))

    def write(self, array, values, first=0):
        rows = array.memory[first : first + len(values)]
        assert rows.shape == values.shape
        rows[:] = values

    def read(self, array):
        return array.memory.copy()

    def clear(self, array):
        array.memory.reshape(-1).view(np.uint8)[:] = 0

    def held(self, bundle):
        return PackedBundle(self._there(bundle))

    def _there(self, part):
        if isinstance(part, np.ndarray):
            _, copy = self._copies.setdefault(id(part), (part, np.array(part, order="C")))
            return copy
        if isinstance(part, ApartArray):
            return part.memory
        if not isinstance(part, tuple):
            return part
        parts = [self._there(one) for one in part]
        return type(part)(*parts) if hasattr(part, "_fields") else tuple(parts)

    def launch(self, call, workers, *bundles, threads=1, block=128):
        # One after the other, so that what is atomic on a card is so here.
        for worker in range(min(workers, self._workers)):
            self._share(call, worker, min(workers, self._workers), bundles)

    def _share(self, call, worker, workers, bundles):
        table = array("q", [bundle.address for bundle in bundles])
        status = call._function(bundles)(table.buffer_info()[0], worker, workers)
        assert status == 0

    def synchronise(self):
        pass
