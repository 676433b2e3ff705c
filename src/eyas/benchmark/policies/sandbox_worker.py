"""The process of a sandboxed policy, see `sandbox.py`: it loads the policy, and answers messages
until there are no more.
"""

import os
import signal
import sys
from collections.abc import Mapping
from typing import IO, Any

import numpy as np

from eyas.benchmark.policies.isolation import give_up_rights
from eyas.benchmark.policies.own_policy import no_action
from eyas.benchmark.policies.sandbox import Array, receive, send
from eyas.benchmark.policies.table import open_policy
from eyas.engine.core.errors import ActionError, EyasError
from eyas.engine.envs.actions import make_actions
from eyas.engine.policies.policy import Decision, Failure, Instruction, Policy, PolicyInput, Start


def main() -> None:
    """Answer the messages on the standard input; what the policy prints goes to stderr."""
    # The terminal's Ctrl-C is for the evaluation, which ends this process by closing the pipe.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    incoming, outgoing = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    give_up_rights()
    opened, _ = receive(incoming)
    sys.path[:] = opened["paths"]
    try:
        policy = open_policy(opened["said"], opened["changes"], sampled=opened["sampled"])
    except EyasError as error:
        send(outgoing, {"refused": str(error)})
        return
    except Exception as error:  # whatever a user's code raises when it is imported
        send(outgoing, {"refused": f"--policy: '{opened['said']}': {Failure.of(error).line}"})
        return
    settings = policy.env.model_dump(mode="json")
    told = sorted(policy.told)
    send(outgoing, {"env": settings, "sampled": policy.sampled, "told": told})
    try:
        _Answers(policy).give(incoming, outgoing)
    except (EOFError, BrokenPipeError):
        return


class _Answers:
    """Flies N episodes by messages."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self._actions = make_actions(policy.env)
        self._latest: dict[str, Array] = {}  # Latest observations, by the names of their parts

    def give(self, incoming: IO[bytes], outgoing: IO[bytes]) -> None:
        """Answer all messages.

        Raises:
            EOFError: There are no more.
        """
        while True:
            head, arrays = receive(incoming)
            try:
                said, parts = self._answer(head, arrays)
            except Exception as error:  # whatever a user's code raises
                said, parts = {"failure": Failure.of(error)}, []
            send(outgoing, said, parts)

    def _answer(
        self, head: Mapping[str, Any], arrays: list[Array]
    ) -> tuple[Mapping[str, Any], list[Array]]:
        if "begin" in head:
            words = head["words"]
            told = None if words is None else Instruction(tuple(words), arrays[2])
            self._latest = {}
            self._policy.begin(Start(arrays[0], lambda: arrays[1], told))
            return {}, []
        deciding, heard = arrays[0], arrays[-1] if head["heard"] else None
        for name, new in zip(head["act"], arrays[1:], strict=False):
            if name not in self._latest:
                shape = len(deciding), *new.shape[1:]
                self._latest[name] = np.zeros(shape, new.dtype)
            self._latest[name][deciding] = new
        alone, words = head["act"] == [""], head.get("words")
        sight = PolicyInput(
            observation=self._latest[""] if alone else self._latest,
            deciding=deciding,
            snapshot=_unknown,
            visible=_unknown,
            covered=np.zeros(len(deciding), np.bool_),
            heard=heard,
            clock=head["clock"],
            told=Instruction(tuple(words), np.zeros((len(words), 0), np.float32))
            if words
            else None,
        )
        return self._told(self._policy.act(sight), deciding)

    def _told(self, decision: Decision, deciding: Array) -> tuple[Mapping[str, Any], list[Array]]:
        """Return the actions as plain numbers; those that are not allowed are failures."""
        failed = dict(decision.failed)
        discrete = self._policy.env.actions.numbered
        actions = np.array([no_action(self._policy.env)] * len(deciding))
        for row in np.flatnonzero(deciding).tolist():
            if row in failed:
                continue
            try:
                action = decision.actions[row]
                self._actions.commands([action])
                actions[row] = int(action) if discrete else np.asarray(action, np.float64)
            except (ActionError, IndexError, KeyError, TypeError) as error:
                failed[row] = Failure.of(error, traced=False)
        messages = [] if decision.messages is None else [np.asarray(decision.messages, np.float64)]
        return {"failed": failed}, [actions, *messages]


_NO_NUMBERS: Any = np.zeros((0, 0), np.float32)
"""Attributes of instructions in the middle of a flight: observations have them."""


def _unknown() -> Any:  # noqa: ANN401  # never returns
    raise RuntimeError("the true state is not told to a policy in a process of its own")
