"""The processes of a vector environment, seen from the one that has started them."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from eyas.core.errors import EyasError
from eyas.envs.block import Answer, Block, Calls, serve

__all__ = ["Workers"]

_PATIENCE = 5.0
"""Time that the end of a process may take after that of its pipe [s]."""


class Workers:
    """Processes, one for each block. If one is lost, all are ended.

    Args:
        blocks: What they hold.

    Raises:
        EyasError: A block cannot be made, or its process not be started.
    """

    def __init__(self, blocks: Sequence[Block]) -> None:
        self._rows = [block.rows for block in blocks]
        self._pipes: list[Connection] = []
        self._processes: list[BaseProcess] = []
        self._ended = ""
        """Why there are no processes any more."""
        # Forked ones would inherit locks of threads that they have not.
        context = get_context("spawn")
        try:
            for block in blocks:
                mine, others = context.Pipe()
                process = context.Process(target=serve, args=(block, others), daemon=True)
                self._pipes.append(mine)
                process.start()
                self._processes.append(process)
                others.close()  # so that the end of the process ends the pipe
            with self._all_or_none():
                answers = [self._answer(worker) for worker in range(len(blocks))]
            self._results(answers)
        except BaseException:
            self.close()
            raise

    def ask(self, calls: Sequence[Calls]) -> list[Any]:
        """Make calls in each process, side by side; return the results of the last ones.

        Raises:
            EyasError: A call has raised an error, or a process was lost.
        """
        if self._ended:
            raise EyasError(self._ended)
        with self._all_or_none():
            for worker, pipe in enumerate(self._pipes):
                try:
                    pipe.send(calls[worker])
                except OSError:
                    raise self._lost(worker) from None
            answers = [self._answer(worker) for worker in range(len(self._pipes))]
        return self._results(answers)

    def close(self) -> None:
        """End the processes; may be called twice."""
        self._ended = self._ended or "the environments are closed"
        for pipe in self._pipes:
            pipe.close()
        for process in self._processes:  # they have nothing to bring to an end
            process.kill()
        for process in self._processes:
            process.join()
        self._pipes, self._processes = [], []

    @contextmanager
    def _all_or_none(self) -> Iterator[None]:
        """End the processes if the block is left halfway: later answers would be to other calls."""
        try:
            yield
        except BaseException as error:
            self._ended = str(error) if isinstance(error, EyasError) else "a call was interrupted"
            self.close()
            raise

    def _answer(self, worker: int) -> Answer:
        try:
            answer: Answer = self._pipes[worker].recv()
        except (EOFError, OSError):
            raise self._lost(worker) from None
        return answer

    def _lost(self, worker: int) -> EyasError:
        process = self._processes[worker]
        process.join(_PATIENCE)
        how = f"exit code {process.exitcode}"
        if process.exitcode is not None and process.exitcode < 0:
            how = f"signal {-process.exitcode}"
        return EyasError(
            f"{self._name(worker)}: its process has ended ({how}); a script that starts processes "
            "must do so below `if __name__ == '__main__':`"
        )

    def _results(self, answers: list[Answer]) -> list[Any]:
        for worker, answer in enumerate(answers):
            if answer.trace:
                error = EyasError(f"{self._name(worker)}: {answer.error}")
                error.add_note(answer.trace)
                raise error
            if answer.error:
                raise EyasError(answer.error)
        return [answer.result for answer in answers]

    def _name(self, worker: int) -> str:
        rows = self._rows[worker]
        return f"worker {worker} (environments {rows.start} to {rows.stop - 1})"
