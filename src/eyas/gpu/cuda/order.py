"""The order of work on a graphics processor: moments in it, and work that is recorded."""

from collections.abc import Callable
from ctypes import byref, c_float, c_uint64, c_void_p

from eyas.gpu.cuda.context import Context

LEGACY = c_void_p(None)  # The legacy default stream

_NON_BLOCKING = 1  # CU_STREAM_NON_BLOCKING: not ordered with the legacy default stream

_RELAXED = 2  # CU_STREAM_CAPTURE_MODE_RELAXED: memory may be allocated and filled meanwhile


class CudaEvent:
    """The moment when all work so far is done, to measure how long it takes or to wait for."""

    def __init__(self, context: Context) -> None:
        self._context, self._handle = context, c_void_p()
        with context.current() as call:
            call("cuEventCreate", byref(self._handle), 0)
            context.destroyed_with(self, "cuEventDestroy_v2", self._handle)
            call("cuEventRecord", self._handle, LEGACY)

    def since(self, earlier: "CudaEvent") -> float:
        """Return the time from another event to this [s], after waiting for this."""
        passed = c_float()
        with self._context.current() as call:
            call("cuEventSynchronize", self._handle)
            call("cuEventElapsedTime", byref(passed), earlier._handle, self._handle)
        return passed.value / 1000.0

    def holds(
        self,
        stream: int,  # The driver's pointer to it
    ) -> None:
        """Have a stream wait for it."""
        self._context.call("cuStreamWaitEvent", c_void_p(stream), self._handle, 0)


class CudaGraph:
    """Work that was recorded, to be done again by one call."""

    def __init__(
        self,
        context: Context,  # Where
        recording: c_void_p,  # The driver's pointer to the recording
        kept: list[object],  # What the work uses
    ) -> None:
        self._context, self._kept, self._handle = context, kept, c_void_p()
        with context.current() as call:
            call("cuGraphInstantiateWithFlags", byref(self._handle), recording, c_uint64(0))
            context.destroyed_with(self, "cuGraphExecDestroy", self._handle)

    def __call__(self) -> None:
        """Do it, after all work before."""
        self._context.call("cuGraphLaunch", self._handle, LEGACY)


def recorded(
    context: Context,  # Where
    # The function; it gets the stream, and returns what the work uses
    work: Callable[[c_void_p], list[object]],
) -> CudaGraph:
    """Return what a function gives to a stream, without doing it."""
    stream, recording = c_void_p(), c_void_p()
    with context.current() as call:
        call("cuStreamCreate", byref(stream), _NON_BLOCKING)
        try:
            call("cuStreamBeginCapture_v2", stream, _RELAXED)
            try:
                kept = work(stream)
            finally:
                call("cuStreamEndCapture", stream, byref(recording))
            graph = CudaGraph(context, recording, kept)
        finally:
            if recording:
                call("cuGraphDestroy", recording)
            call("cuStreamDestroy_v2", stream)
    return graph
