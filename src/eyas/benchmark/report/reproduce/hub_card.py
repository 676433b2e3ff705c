"""A policy on the Hugging Face hub: its network, its curve, and a card in the hub's format."""

import json
import re
from pathlib import Path
from typing import Any

from eyas.benchmark.policies.onnx import load_onnx
from eyas.benchmark.policies.shipped import file_of, shipped_names
from eyas.benchmark.report.reproduce.model_card import model_card
from eyas.benchmark.report.reproduce.tables import TABLES, flown_of
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.exports.hub import CARD

_RUN = ("config.json", "curve.csv", "version.json")
"""Files of a training that lie beside its network."""
_ELSEWHERE = re.compile(r"\[about it\]\([^)]*\), ")
"""Links to the documents, which the hub does not have."""


def hub_files(policy: str, repository: str) -> dict[str, Path | bytes]:
    """Return the files of a policy, or their contents, by the path on the hub.

    Args:
        policy: Name of a policy that ships, or path of an ONNX file.
        repository: Its name on the hub, `ACCOUNT/NAME`.

    Raises:
        UnknownNameError: It is neither.
        DataFileError: The file is not a policy.
    """
    network = network_of(policy)
    if policy in shipped_names():
        files: dict[str, Path | bytes] = {f"{policy}.csv": network.with_suffix(".csv")}
        text = _shipped_card(policy)
    else:
        beside = [network.with_name(name) for name in _RUN]
        files = {path.name: path for path in beside if path.is_file()}
        text = _own_card(network, tuple(files))
    text += _usage(repository, network.name)
    return files | {network.name: network, CARD: text.encode()}


def network_of(policy: str) -> Path:
    """Return the file of a policy's network.

    Raises:
        UnknownNameError: It is neither the name of a policy that ships nor a file.
        DataFileError: The file is not a policy.
    """
    names = shipped_names()
    if policy in names:
        return file_of(policy)
    if not Path(policy).is_file():
        raise UnknownNameError("POLICY", policy, (*names, "FILE.onnx"))
    load_onnx(Path(policy), {}, sampled=False)  # refuses what does not fly
    return Path(policy)


def _front_matter(**own: Any) -> str:  # noqa: ANN401  # JSON, which is YAML, too
    values = {
        "library_name": "eyas",
        "pipeline_tag": "robotics",
        "tags": ["drone", "visual-tracking", "reinforcement-learning", "simulation", "onnx"],
        **own,
    }
    lines = (f"{name}: {json.dumps(value, ensure_ascii=False)}" for name, value in values.items())
    return "\n".join(["---", *lines, "---", ""])


def _usage(repository: str, file: str) -> str:
    return (
        "\n\n## Fly it\n\n```sh\npip install 'eyas[policies,hub]'\n"
        f"hf download {repository} {file} --local-dir .\n"
        f"eyas evaluate --policy {file}\n```\n"
    )


def _shipped_card(name: str) -> str:
    results = [
        {
            "task": {"type": "robotics", "name": "Visual active tracking"},
            "dataset": {
                "type": f"eyas-{table}",
                "name": f"Eyas, {TABLES[table].title}{': ' if row.label else ''}{row.label}",
            },
            "metrics": [
                {"type": figure, "value": float(text.partition(" ")[0]), "name": text}
                for figure, text in one.cells.items()
                if _number(text)
            ],
        }
        for table, rows in flown_of(name).items()
        for row, one, _ in rows
    ]
    index = [{"name": name, "results": results}]
    front = _front_matter(license="mit", **{"model-index": index})
    body = _ELSEWHERE.sub("", model_card(name))
    return f"{front}\n{body}"


def _number(text: str) -> bool:
    return re.match(r"-?\d+(\.\d+)?( |$)", text) is not None


def _own_card(network: Path, beside: tuple[str, ...]) -> str:
    said = {
        "config.json": "the settings of its training",
        "curve.csv": "how it learned",
        "version.json": "the build of Eyas that trained it",
    }
    files = [f"- `{network.name}`: the network, with what it sees and does in its metadata"]
    files += [f"- `{name}`: {said[name]}" for name in beside]
    listed = "\n".join(files)
    return (
        f"{_front_matter()}\n# `{network.stem}`\n\n"
        "A network that follows a target with a drone, trained with Eyas, a simulator and "
        "benchmark for drone visual active tracking. It has seen drawn pictures only, and must "
        f"not steer a real drone untried.\n\n{listed}"
    )
