"""Lets models on this machine fly: of language and vision as Hugging Face's `transformers` loads
them, and policies that LeRobot has trained. Weights are read from safetensors only; nothing that
lies beside them runs.
"""

import copy
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, Literal

from pydantic import Field

from eyas.benchmark.policies.chat_agent import AskedAgent, AskedConfig
from eyas.benchmark.policies.waypoints import Look, Picture, WaypointPolicy
from eyas.engine.core.allowed import TextForm
from eyas.engine.core.config import Config, shown, validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError

_LARGEST = 1 << 24  # Largest JSON file of a model [bytes]
_STATE = "observation.state"
_NUMBERS = 4  # Of an action: ahead, left, up [m/s], turn to the left [rad/s]

Device = Annotated[
    str,
    Field(pattern=r"^(cpu|mps|cuda(:[0-9]{1,3})?)$"),
    TextForm("'cpu', 'mps', 'cuda', 'cuda:1'"),
]


class TransformersFile(AskedConfig):
    """A model of language and vision on this machine, by the file that describes it."""

    transformers: Annotated[str, Field(min_length=1, max_length=1000)]
    """Folder of the model, from that of the file; or its name on Hugging Face's hub."""
    device: Device = "cpu"


class LeRobotFile(Config):
    """A policy of LeRobot, by the file that describes it."""

    lerobot: Annotated[str, Field(min_length=1, max_length=1000)]
    """Folder `pretrained_model` of a training, from that of the file."""
    device: Device = "cpu"
    rate: Annotated[float, Field(ge=0.01, le=125)] = 10.0
    """How often it acts [Hz]: that of the films that it has learned from."""
    latency: Annotated[float, Field(ge=0, le=600)] | Literal["measured"] = "measured"
    """From a look to what it does about it [s]."""


def local_agent(
    content: Mapping[str, Any], changes: Mapping[str, Any], path: Path
) -> WaypointPolicy:
    """Return the policy of a model on this machine.

    Args:
        content: That of the file: one of the keys `transformers` and `lerobot`, and others.
        changes: Changes of `env`.
        path: The file.

    Raises:
        ConfigError: A key or a value is wrong, or a package is missing.
        DataFileError: The model cannot be read.
    """
    if "lerobot" in content:
        loaded = _LeRobotPolicy(validated(LeRobotFile, content), path)
        agent = partial(LeRobotAgent, loaded)
        return WaypointPolicy(agent, agent(), changes, str(path))
    file = validated(TransformersFile, content)
    model = _LanguageModel(file, path)
    make = partial(TransformersAgent, file, model)
    return WaypointPolicy(make, make(), changes, str(path))


def _package(name: str) -> ModuleType:
    try:
        return __import__(name)
    except ImportError as error:
        raise ConfigError(
            f"{name}: needs the package {name} ({error}): pip install {name}"
        ) from None


class _LanguageModel:
    """Weights and processor of a model, for all drones."""

    def __init__(self, file: TransformersFile, path: Path) -> None:
        library = _package("transformers")
        beside = path.parent / file.transformers
        name = str(beside) if beside.is_dir() else file.transformers
        safe = {"trust_remote_code": False, "local_files_only": beside.is_dir()}
        try:
            self.processor = library.AutoProcessor.from_pretrained(name, **safe)
            model = library.AutoModelForImageTextToText.from_pretrained(
                name, use_safetensors=True, **safe
            )
        except (OSError, ValueError, KeyError, ImportError) as error:
            line = " ".join(str(error).split())[:300]
            raise DataFileError(f"transformers: {file.transformers}: {line}") from None
        usual = model.generation_config
        if usual.pad_token_id is None:  # or each answer would warn of it
            ends = usual.eos_token_id
            usual.pad_token_id = ends[0] if isinstance(ends, list) else ends
        self.model = model.to(file.device).eval()

    def written(self, messages: list[dict[str, Any]], most: int) -> str:
        """Return what follows messages, at most so many tokens."""
        inputs = self.processor.apply_chat_template(
            messages, add_generation_prompt=True, tokenize=True, return_dict=True,
            return_tensors="pt",
        ).to(self.model.device)  # fmt: skip
        written = self.model.generate(**inputs, max_new_tokens=most, do_sample=False)
        own = written[:, inputs["input_ids"].shape[1] :]
        return str(self.processor.batch_decode(own, skip_special_tokens=True)[0])


class TransformersAgent(AskedAgent):
    """Asks a model of `transformers`."""

    def __init__(self, file: TransformersFile, model: _LanguageModel) -> None:
        super().__init__(file)
        self._model, self._most = model, file.most_tokens

    def written(self, system: str, words: str, pictures: Picture) -> str:
        """Return what the model writes."""
        from PIL import Image

        shown_ = [{"type": "image", "image": Image.fromarray(picture)} for picture in pictures]
        return self._model.written(
            [
                {"role": "system", "content": [{"type": "text", "text": system}]},
                {"role": "user", "content": [{"type": "text", "text": words}, *shown_]},
            ],
            self._most,
        )


class _LeRobotPolicy:
    """A policy with what comes before and behind it, for all drones."""

    def __init__(self, file: LeRobotFile, path: Path) -> None:
        self.file = file
        folder = path.parent / file.lerobot
        if not (folder / "config.json").is_file():
            raise DataFileError(f"lerobot: no config.json in the folder {folder}")
        _package("lerobot")
        from lerobot.configs.policies import PreTrainedConfig
        from lerobot.policies.factory import get_policy_class, make_pre_post_processors

        for name in ("policy_preprocessor.json", "policy_postprocessor.json"):
            _refuse_classes(folder / name)
        try:
            config = PreTrainedConfig.from_pretrained(folder, local_files_only=True)
            config.device = file.device
            self.camera, self.size = _features(config, folder)
            kind = get_policy_class(config.type)
            self.policy = kind.from_pretrained(folder, config=config, local_files_only=True).eval()
            self.before, self.behind = make_pre_post_processors(
                config,
                pretrained_path=str(folder),
                preprocessor_overrides={"device_processor": {"device": file.device}},
            )
        except (OSError, ValueError, KeyError, TypeError, ImportError) as error:
            line = " ".join(str(error).split())[:300]
            raise DataFileError(f"lerobot: {folder}: {line}") from None


def _refuse_classes(path: Path) -> None:
    """Refuse steps that name a class of Python, which LeRobot would import and make.

    Raises:
        DataFileError: A step names one, or LeRobot has not written the file.
    """
    content = read_json(path, _LARGEST)
    steps = content.get("steps") if isinstance(content, dict) else None
    if not isinstance(steps, list) or not all(isinstance(step, dict) for step in steps):
        raise DataFileError(f"{path}: no steps: write it by LeRobot 0.4 or newer")
    for step in steps:
        if "registry_name" not in step or "class" in step:
            raise DataFileError(
                f"{path}: steps: {shown(step.get('class'))} is not allowed: only steps of LeRobot, "
                "which have a registry_name"
            )


def _features(config: Any, folder: Path) -> tuple[str, tuple[int, int]]:  # noqa: ANN401  # LeRobot's
    """Return the name of a policy's pictures, and their width and height.

    Raises:
        DataFileError: It wants something else than a drone has, or does something else.
    """
    asked = {name: tuple(each.shape) for name, each in config.input_features.items()}
    state = asked.pop(_STATE, (10,))
    acts = {name: tuple(each.shape) for name, each in config.output_features.items()}
    if len(asked) != 1 or len(next(iter(asked.values()))) != 3 or state != (10,):
        raise DataFileError(
            f"{folder}: input_features: {shown(config.input_features)} is not allowed: one "
            f"picture, perhaps {_STATE} of 10 numbers, as `eyas export --format lerobot` has them"
        )
    if acts != {"action": (_NUMBERS,)}:
        raise DataFileError(
            f"{folder}: output_features: {shown(config.output_features)} is not allowed: action of "
            f"{_NUMBERS} numbers"
        )
    ((name, (_, height, width)),) = asked.items()
    return name, (width, height)


class LeRobotAgent:
    """Acts by a policy of LeRobot, which keeps its own chunk of actions for each drone."""

    pictures, step = 1, 0.5

    def __init__(self, loaded: _LeRobotPolicy) -> None:
        file = loaded.file
        self._loaded, self.rate, self.latency = loaded, file.rate, file.latency
        self.size = loaded.size
        self._policy = copy.copy(loaded.policy)  # The same weights
        self._policy.reset()  # makes queues of its own

    def begin(self, words: str) -> None:
        """No-op: every observation has the words."""

    def plan(self, look: Look) -> object:
        """Return the velocity until the next look."""
        import torch

        loaded = self._loaded
        picture = torch.from_numpy(look.pictures[-1]).permute(2, 0, 1).float() / 255.0
        seen = {
            loaded.camera: picture,
            _STATE: torch.from_numpy(look.state).float(),
            "task": look.words,
        }
        with torch.inference_mode():
            action = loaded.behind(self._policy.select_action(loaded.before(seen)))
        return {"velocity": action.reshape(-1)[:_NUMBERS].tolist()}
