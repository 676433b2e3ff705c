"""Rerun's own server in the place of its viewer, which needs a screen."""

import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest


@contextmanager
def rerun_server(file):
    """Yield the process of a server that saves what it gets into a file, and its HOST:PORT."""
    program = Path(pytest.importorskip("rerun_cli").__file__).with_name("rerun")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [str(program), "--bind", "127.0.0.1", "--port", str(port), "--save", str(file)]
    out = subprocess.DEVNULL
    with subprocess.Popen(command, stdout=out, stderr=out) as server:
        for _ in range(600):
            try:
                socket.create_connection(("127.0.0.1", port), 1.0).close()
                break
            except OSError:
                assert server.poll() is None
                time.sleep(0.05)
        try:
            yield server, f"127.0.0.1:{port}"
        finally:
            server.kill()


def rows_of(file):
    """Return how many rows a file of Rerun has for each entity."""
    command = [sys.executable, "-m", "rerun", "rrd", "stats", str(file)]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    pairs = (line.split(": ") for line in said.splitlines() if line.startswith("/"))
    return {name: int(count) for name, count in pairs}
