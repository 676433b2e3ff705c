"""Lets a model behind an HTTP endpoint fly, in the form that most servers of models speak: chat
completions of OpenAI with pictures (vLLM, llama.cpp, Ollama, LM Studio, ...).
"""

import base64
import json
import os
import urllib.error
import urllib.request
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import partial
from http.client import HTTPException
from pathlib import Path
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

from pydantic import Field

from eyas.benchmark.policies.waypoints import Look, Picture, WaypointPolicy, way_of
from eyas.engine.core.allowed import TextForm
from eyas.engine.core.codecs.png import png_bytes
from eyas.engine.core.config import Config, validated
from eyas.engine.core.decoding import decoded_json, read_json
from eyas.engine.core.errors import ConfigError, DataFileError

LOCAL = {"transformers", "lerobot"}  # Keys of files of models on this machine
KEY, HOST = "EYAS_AGENT_KEY", "EYAS_AGENT_HOST"
"""Environment variables with the key that an endpoint wants, and the machine that it is for: a file
of others could name any endpoint, which then would get the key."""

_LARGEST = 1 << 20  # Largest file and answer [bytes]
_READ = 20_000  # Length of the end of a text in which an answer is looked for

_FORMS = {
    "waypoints": '{"waypoints": [[x, y], ...]}: up to 8 places that the drone shall be at after '
    "every {step} s, x metres ahead of where it is now and y metres to the left of it",
    "velocity": '{"velocity": [ahead, left, up, turn]}: metres a second, and radians a second to '
    "the left",
    "box": '{"box": [left, top, width, height]}: the target in the last picture, in pixels',
}

PROMPT = (
    "You fly a drone whose camera looks down at the ground ahead. Keep the target in the middle of "
    "the picture. You get the last {pictures} pictures of {width}x{height} pixels, the newest "
    "last; up in them is ahead of the drone. Answer with one JSON object and nothing else: {form}."
)
"""What the model is asked to do, where the file has no `prompt`."""


class AskedConfig(Config):
    """How a model of language and vision is asked."""

    answer: Literal["waypoints", "velocity", "box"] = "box"
    """What it is asked for; any of the three is understood."""
    rate: Annotated[float, Field(ge=0.01, le=125)] = 1.0
    """How often it looks, while it does not think [Hz]."""
    latency: Annotated[float, Field(ge=0, le=600)] | Literal["measured"] = "measured"
    """From a look to what it does about it [s]."""
    pictures: Annotated[int, Field(ge=1, le=16)] = 2
    size: tuple[Annotated[int, Field(ge=8, le=2048)], Annotated[int, Field(ge=8, le=2048)]] = (
        320,
        240,
    )
    """Width and height of the pictures [pixels]."""
    step: Annotated[float, Field(ge=0.01, le=60)] = 0.5
    """Time from one waypoint to the next [s]."""
    prompt: Annotated[str, Field(max_length=20_000)] = PROMPT
    """With {pictures}, {width}, {height}, {step} and {form}."""
    most_tokens: Annotated[int, Field(ge=1, le=100_000)] = 300


class ChatFile(AskedConfig):
    """A model behind an endpoint, by the file that describes it."""

    url: Annotated[
        str, Field(pattern=r"^https?://\S+$"), TextForm("an address, http:// or https://")
    ]
    """Base of the endpoint, such as http://localhost:8000/v1."""
    model: Annotated[str, Field(min_length=1, max_length=500)]
    timeout: Annotated[float, Field(gt=0, le=600)] = 60.0
    """How long an answer is waited for [s]."""
    at_once: Annotated[int, Field(ge=1, le=256)] = 8
    """How many questions are asked at the same time."""


class AskedAgent(ABC):
    """Asks a model for one drone. An answer that cannot be read changes nothing."""

    def __init__(self, file: AskedConfig) -> None:
        self.rate, self.latency, self.pictures = file.rate, file.latency, file.pictures
        self.step, self.size = file.step, file.size
        width, height = file.size
        words = {"form": _FORMS[file.answer], "pictures": file.pictures, "width": width,
                 "height": height, "step": f"{file.step:g}"}  # fmt: skip
        self._system = file.prompt
        for name, word in words.items():  # not by `format`, which looks into objects
            self._system = self._system.replace("{" + name + "}", str(word))

    def begin(self, words: str) -> None:  # noqa: B027  # its parameter asks for the words
        """No-op: every question has the words."""

    def plan(self, look: Look) -> object:
        """Return the model's answer."""
        words = look.words or "Follow the vehicle in the middle of the first picture."
        asked = f"Target: {words} Time: {look.time:.2f} s."
        return answer_in(self.written(self._system, asked, look.pictures), self.step, self.size)

    @abstractmethod
    def written(self, system: str, words: str, pictures: Picture) -> str:
        """Return what the model writes.

        Args:
            system: What it is asked to do.
            words: What it has to follow, and the time.
            pictures: The newest last, shape (K, H, W, 3).
        """


class ChatAgent(AskedAgent):
    """Asks a model behind an endpoint."""

    def __init__(self, file: ChatFile) -> None:
        super().__init__(file)
        self._file = file

    def written(self, system: str, words: str, pictures: Picture) -> str:
        """Return what the model writes.

        Raises:
            ConnectionError: The endpoint cannot be reached, or refuses the question.
        """
        shown = [
            {"type": "image_url", "image_url": {"url": _as_url(picture)}} for picture in pictures
        ]
        question = {
            "model": self._file.model,
            "temperature": 0,
            "max_tokens": self._file.most_tokens,
            "messages": [
                {"role": "system", "content": system},
                {"role": "user", "content": [{"type": "text", "text": words}, *shown]},
            ],
        }
        return text_of(self._asked(question), self._file.url)

    def _asked(self, question: Mapping[str, Any]) -> bytes:
        url = f"{self._file.url.rstrip('/')}/chat/completions"
        head = {"Content-Type": "application/json"}
        if KEY in os.environ and os.environ.get(HOST) == urlsplit(url).hostname:
            head["Authorization"] = f"Bearer {os.environ[KEY]}"
        asked = urllib.request.Request(  # http or https, by its pattern
            url, json.dumps(question).encode(), head
        )
        try:
            with _OPENER.open(asked, timeout=self._file.timeout) as reply:
                return bytes(reply.read(_LARGEST))
        except urllib.error.HTTPError as error:
            said = error.read(300).decode(errors="replace")
            raise ConnectionError(f"{url}: {error.code} {error.reason}: {said}") from None
        except (OSError, HTTPException) as error:
            reason = getattr(error, "reason", error)
            raise ConnectionError(f"{url}: {reason}") from None


class _Stays(urllib.request.HTTPRedirectHandler):
    """Follows no redirection, which would carry the key to another machine."""

    def redirect_request(self, *_: object) -> None:
        """Refuse it."""


_OPENER = urllib.request.build_opener(_Stays)


def text_of(reply: bytes, url: str) -> str:
    """Return what a model has written, from the reply of its endpoint.

    Raises:
        ConnectionError: The reply is of another form.
    """
    try:
        text = decoded_json(reply)["choices"][0]["message"]["content"]
    except (LookupError, TypeError, ValueError, DataFileError):
        raise ConnectionError(f"{url}: a reply without choices[0].message.content") from None
    return text if isinstance(text, str) else ""


def answer_in(text: str, step: float, size: tuple[int, int]) -> object:
    """Return the last JSON object in a text that is an answer; None: there is none.

    Args:
        text: What the model has written, perhaps with words or marks around it.
        step: See `eyas.benchmark.policies.waypoints.way_of`.
        size: Width and height of the pictures [pixels].
    """
    text = text[-_READ:]
    decoder, found, at = json.JSONDecoder(), None, text.find("{")
    while at >= 0:
        try:
            value, end = decoder.raw_decode(text, at)
            way_of(value, step, size[::-1])
            found = value
        except (ValueError, TypeError, RecursionError):
            end = at + 1
        at = text.find("{", end)
    return found


def _as_url(picture: Picture) -> str:
    return "data:image/png;base64," + base64.b64encode(png_bytes(picture)).decode()


def open_agent(path: Path, changes: Mapping[str, Any], *, sampled: bool = False) -> WaypointPolicy:
    """Return the policy of a model, by the JSON file that describes it.

    Raises:
        DataFileError: The file, or that of a model, cannot be read.
        ConfigError: A key or a value is wrong.
    """
    if sampled:
        raise ConfigError("--sample: a model is asked as its file says")
    content = read_json(path, _LARGEST)
    if not isinstance(content, dict):
        raise DataFileError(f"{path}: not a JSON object")
    try:
        kinds = sorted({"url", *LOCAL} & content.keys())
        if len(kinds) != 1:
            found = " and ".join(kinds) if kinds else "none of them"
            raise ConfigError(f"one of 'lerobot', 'transformers', 'url' is allowed, not {found}")
        if kinds[0] in LOCAL:
            from eyas.benchmark.policies.local_model import local_agent

            return local_agent(content, changes, path)
        file = validated(ChatFile, content)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None
    return WaypointPolicy(
        partial(ChatAgent, file), ChatAgent(file), changes, str(path), file.at_once
    )
