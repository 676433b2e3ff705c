"""The Hugging Face hub, where data sets and policies are published; the one import of its client.

The address is that of `HF_ENDPOINT`, and the user that of `hf auth login` or `HF_TOKEN`, as in all
programs that use `huggingface_hub`.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, Literal

from eyas.engine.core.errors import ConfigError, MissingExtraError, OutputError

Kind = Literal["dataset", "model"]

CARD = "README.md"
"""The file that the hub shows as the page of a repository."""
COMMIT_FILES = 1000
"""Files in one commit: the hub answers larger ones too late."""


class HubRepository:
    """A repository of the user on the hub, made where it does not exist.

    Args:
        name: `ACCOUNT/NAME`, or `NAME` for the user's own account.
        private: True if only the user may see a repository that is made; None: as the hub does.

    Raises:
        MissingExtraError: `huggingface_hub` is not installed.
        ConfigError: The name is not one of a repository.
        OutputError: The hub is not reached, or refuses.
    """

    def __init__(self, name: str, kind: Kind, *, private: bool | None = None) -> None:
        try:
            import huggingface_hub
            from huggingface_hub.errors import HFValidationError
        except ImportError as error:
            raise MissingExtraError("the Hugging Face hub", "hub") from error
        self._hub: Any = huggingface_hub
        self.name, self.kind = name, kind
        try:
            self._api = huggingface_hub.HfApi(library_name="eyas")
            self.url = str(
                self._api.create_repo(name, repo_type=kind, private=private, exist_ok=True)
            )
            self.name = huggingface_hub.RepoUrl(self.url).repo_id
        except HFValidationError as error:
            raise ConfigError(
                f"{name!r}: not a name on the Hugging Face hub: ACCOUNT/NAME of letters, digits, "
                "'-', '_' and '.', at most 96"
            ) from error
        except Exception as error:  # of the client, of what it sends with, of the system
            raise self._refused(error) from error

    def push(self, files: Mapping[str, Path | bytes], message: str) -> None:
        """Add files, in as many commits as they need; the card comes last, when all else is there.

        Args:
            files: Files, or their contents, by the path in the repository.
            message: What the commits say.

        Raises:
            OutputError: A file cannot be read, the hub is not reached, or refuses.
        """
        paths = sorted(files, key=lambda path: (path == CARD, path))
        for batch in _batches(paths, COMMIT_FILES):
            adding = [
                self._hub.CommitOperationAdd(path_in_repo=path, path_or_fileobj=files[path])
                for path in batch
            ]
            try:
                self._api.create_commit(
                    self.name, adding, commit_message=message, repo_type=self.kind
                )
            except Exception as error:
                raise self._refused(error) from error

    def _refused(self, error: Exception) -> OutputError:
        response = getattr(error, "response", None)
        status = getattr(response, "status_code", None)
        if status == 401:
            return OutputError(
                f"{self.name}: the Hugging Face hub does not know who sends: hf auth login, or "
                "HF_TOKEN"
            )
        said = " ".join(str(getattr(error, "server_message", None) or error).split())
        what = "was not reached" if status is None else f"refuses ({status})"
        return OutputError(f"{self.name}: the Hugging Face hub {what}: {said}")


def _batches(paths: Sequence[str], size: int) -> Iterator[list[str]]:
    rest = iter(paths)
    while batch := list(islice(rest, size)):
        yield batch
