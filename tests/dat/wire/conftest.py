"""A server in a process of its own, on a free port, with small pictures."""

import importlib.util
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

CLIENT = Path(__file__).with_name("client.py")

_spec = importlib.util.spec_from_file_location("wire_client", CLIENT)
client = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(client)

SETTINGS = ("camera.width=64", "camera.height=48", "traffic.demand=keep_alive")


PATIENCE = 900.0
"""Time after which something has gone wrong, on a machine of whatever load: a server that waits for
its turn is not told from one that hangs in less [s]. What ends too early is told at once."""


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


class Served:
    """`eyas serve`, and what it says on stderr."""

    def __init__(self, root, *overrides, prefix=(), options=()):
        self.root, self.port = root, free_port()
        chosen = (*SETTINGS, f"wire.port={self.port}", *overrides)
        arguments = [word for override in chosen for word in ("--set", override)]
        command = [*prefix, sys.executable, "-m", "eyas.cli.main", "serve", "--root", str(root)]
        self.process = subprocess.Popen(
            [*command, *options, *arguments], stderr=subprocess.PIPE, text=True, env={**os.environ}
        )
        self.lines, self._players = [], []
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self):
        for line in self.process.stderr:
            self.lines.append(line.rstrip("\n"))

    def until(self, words, timeout=PATIENCE):
        """Wait for a line with these words; return it."""
        end = time.monotonic() + timeout
        while True:
            for line in list(self.lines):
                if words in line:
                    return line
            assert time.monotonic() < end, (words, self.lines)
            assert self.process.poll() is None or self._reader.is_alive(), (words, self.lines)
            time.sleep(0.01)

    def client(self, agent, **options):
        return client.Client(self.root, agent, **{"patience": PATIENCE, **options})

    def announce(self, agents=None, message=None):
        self.until("waiting for clients")
        client.Client.announce(self.port, agents, message)

    def play(self, agent, agents, rounds):
        """Start a client in a process of its own; return it when its first reset is done."""
        words = map(str, (self.root, agent, agents, self.port, rounds, PATIENCE))
        command = [sys.executable, str(CLIENT), *words]
        pipe = subprocess.PIPE
        player = subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True)
        self._players.append(player)
        return player

    def left(self):
        """Return the files of the protocol that exist."""
        return sorted(path.name for path in (self.root / client.FILES).glob("[!.]*"))

    def ended(self):
        """Wait until it has ended by itself; return its exit code."""
        self.process.wait(PATIENCE)
        return self.end()

    def end(self, number=signal.SIGINT):
        if self.process.poll() is None:
            self.process.send_signal(number)
        code = self.process.wait(PATIENCE)
        self._reader.join()
        self.process.stderr.close()
        for player in self._players:
            player.kill()
            player.wait()
            player.stdout.close()
            player.stderr.close()
        return code


@pytest.fixture
def serve(tmp_path):
    """Start servers; they end with the test."""
    servers = []

    def start(*overrides, root=None, **more):
        root = tmp_path / "dat" if root is None else root
        root.mkdir(exist_ok=True)
        servers.append(Served(root, *overrides, **more))
        return servers[-1]

    yield start
    for server in servers:
        if server.process.poll() is None:
            server.process.kill()
        server.end()


@pytest.fixture
def together():
    """Carry out one call of each client at the same time, as lock-step needs."""

    def run(*calls):
        results = [None] * len(calls)

        def one(number, call):
            results[number] = call()

        threads = [threading.Thread(target=one, args=pair) for pair in enumerate(calls)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return results

    return run
