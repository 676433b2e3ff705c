"""Speed of `eyas serve`: rounds a second with four clients, and the CPU time of a round.

    python bench/serve.py [AGENTS [ROUNDS [KEY=VALUE ...]]]

The clients are those of the tests, one process each; they look for files once in a millisecond, as
those of the original do. `camera.width=8 camera.height=8` leaves nearly the protocol alone.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

CLIENT = Path(__file__).parents[1] / "tests" / "dat" / "wire" / "client.py"


def main(agents: int = 4, rounds: int = 1000, *overrides: str) -> None:
    """Measure, and print one line."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with tempfile.TemporaryDirectory() as root:
        served = [*overrides, f"wire.port={port}", "traffic.demand=respawn"]
        options = [word for override in served for word in ("--set", override)]
        command = [sys.executable, "-m", "eyas.cli.main", "serve", "--root", root, *options]
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
            assert server.stderr is not None
            while "waiting for clients" not in server.stderr.readline():
                assert server.poll() is None, "the server has ended"
            measure(server.pid, root, port, agents, rounds)
            server.send_signal(signal.SIGTERM)
            server.stderr.read()


def measure(server: int, root: str, port: int, agents: int, rounds: int) -> None:
    """Run the clients, and print what they and the server took."""
    words = [str(agents), str(port), str(rounds)]
    clients = [
        subprocess.Popen(
            [sys.executable, str(CLIENT), root, str(agent), *words],
            stdout=subprocess.PIPE,
            text=True,
        )
        for agent in range(agents)
    ]
    for client in clients:
        assert client.stdout is not None
        assert client.stdout.readline() == "begun\n"
    before = spent(server)
    told = [json.loads(client.communicate()[0]) for client in clients]
    seconds = max(each["seconds"] for each in told)
    ours = 1e3 * (spent(server) - before) / rounds
    theirs = 1e3 * sum(each["cpu"] for each in told) / rounds
    print(
        f"{agents} agents: {rounds / seconds:.0f} rounds/s (wall time); CPU time of a round: "
        f"server {ours:.2f} ms, clients together {theirs:.2f} ms"
    )


def spent(process: int) -> float:
    """Return the CPU time of a process up to now [s]."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), *sys.argv[3:])
