"""A tracker outside Eyas flies the demo: it finds the reddest spot, and sends a box around it.

eyas demo                                          # and choose "tracker outside" on its page
python examples/demo_tracker.py ws://127.0.0.1:8720/socket
"""

import asyncio
import io
import json
import struct
import sys

import numpy as np
from PIL import Image
from websockets.asyncio.client import connect


def find(picture: Image.Image) -> list[float] | None:
    """Return left, top, right, bottom of what is red, in shares of the picture's sides."""
    pixels = np.asarray(picture.convert("RGB"), int)
    rows, columns = np.nonzero(pixels[..., 0] - pixels[..., 1:].max(axis=-1) > 60)
    if len(rows) < 20:
        return None
    low, high = np.percentile(columns, (20, 80)), np.percentile(rows, (20, 80))
    box = np.array([low[0], high[0], low[1], high[1]]) / (*picture.size, *picture.size)
    return box.tolist()


async def main(address: str) -> None:
    """Answer each frame with a box, and acknowledge it, so that the next one comes."""
    separator = "&" if "?" in address else "?"
    async with connect(f"{address}{separator}role=tracker", max_size=None) as socket:
        async for data in socket:
            if isinstance(data, bytes):
                length = struct.unpack("<I", data[:4])[0]
                state = json.loads(data[4 : 4 + length])
                box = find(Image.open(io.BytesIO(data[4 + length :])))
                await socket.send(json.dumps({"message": "box", "box": box}))
                await socket.send(json.dumps({"message": "ack", "frame": state["frame"]}))


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1]))
