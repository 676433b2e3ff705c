"""A proxy in the way of a demo that lets through only so many bytes in a second."""

import asyncio
import contextlib
import threading

BLOCK = 2048


class SlowLine:
    """Forwards connections to a port; what comes back is slow.

    Attributes:
        port: Where it listens.
    """

    def __init__(self, port, rate):
        self._to, self._rate = port, rate
        self._begun = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run()), daemon=True)
        self._thread.start()
        self._begun.wait()

    async def _run(self):
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        # Small buffers, or they alone would take seconds of frames.
        server = await asyncio.start_server(self._forward, "127.0.0.1", 0, limit=2 * BLOCK)
        self.port = server.sockets[0].getsockname()[1]
        self._begun.set()
        await self._end.wait()
        server.close()

    async def _forward(self, reader, writer):
        back, there = await asyncio.open_connection("127.0.0.1", self._to, limit=2 * BLOCK)
        copies = [self._copy(reader, there), self._copy(back, writer, self._rate)]
        try:
            with contextlib.suppress(OSError, asyncio.CancelledError):
                await asyncio.gather(*copies)
        finally:
            for end in (writer, there):
                end.transport.abort()
            await asyncio.sleep(0)  # the transports close their sockets

    async def _copy(self, reader, writer, rate=None):
        due = self._loop.time()
        while data := await reader.read(BLOCK):
            writer.write(data)
            await writer.drain()
            if rate is not None:
                due = max(due, self._loop.time() - 0.02) + len(data) / rate
                await asyncio.sleep(due - self._loop.time())
        writer.write_eof()

    def close(self):
        """Cut all connections."""
        self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join()
