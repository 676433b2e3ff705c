"""Take out of shared libraries the zeros that some linkers leave between the parts that are loaded,
up to two megabytes each; what a process loads stays the same.

python compact_libraries.py FOLDER     # all below it, in place; prints what it has saved
"""

import struct
import sys
from pathlib import Path

PAGE = 4096
PART = struct.Struct("<IIQQQQQQ")
"""Type, flags, offset in the file, address, another address, size there, size in memory, and
alignment."""
LOADED = 1
"""The type of parts that are loaded; all others lie within those."""
WORTH = 1 << 20
"""Files that would lose less are left as they are [bytes]."""


def compacted(data: bytes) -> bytes:
    """Return a library of 64 bits whose parts follow one another, without its table of sections."""
    (first,), (count,) = struct.unpack_from("<Q", data, 32), struct.unpack_from("<H", data, 56)
    parts = [PART.unpack_from(data, first + PART.size * i) for i in range(count)]
    made, moved = bytearray(), []
    loaded = sorted((part for part in parts if part[0] == LOADED), key=lambda part: part[2])
    for _, _, offset, address, _, size, *_ in loaded:
        place = len(made) + (address - len(made)) % PAGE  # as far into its page as in memory
        made += bytes(place - len(made)) + data[offset : offset + size]
        moved.append((offset, size, place))
    for i, (kind, flags, offset, *middle, align) in enumerate(parts):
        within = [(to, at) for at, size, to in moved if at <= offset < at + size]
        new = within[0][0] + offset - within[0][1] if within else offset
        align = PAGE if kind == LOADED else align
        PART.pack_into(made, first + PART.size * i, kind, flags, new, *middle, align)
    struct.pack_into("<Q", made, 40, 0)  # where sections are told of, which only linkers read
    struct.pack_into("<HH", made, 60, 0, 0)
    return bytes(made)


def main() -> None:
    """Compact all libraries below a folder."""
    saved = 0
    for path in Path(sys.argv[1]).rglob("*.so*"):
        data = path.read_bytes()
        if path.is_symlink() or data[:6] != b"\x7fELF\x02\x01":
            continue
        made = compacted(data)
        if len(data) - len(made) > WORTH:
            path.write_bytes(made)
            saved += len(data) - len(made)
    print(f"{saved / 1e6:.0f} MB of zeros taken out")


if __name__ == "__main__":
    main()
