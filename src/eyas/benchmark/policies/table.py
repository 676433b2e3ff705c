"""Finds a policy by what a user calls it."""

from collections.abc import Callable, Mapping
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eyas.benchmark.policies.shipped import file_of, shipped_names
from eyas.engine.core.errors import ConfigError, DataFileError, UnknownNameError
from eyas.engine.core.named_code import PICKLED
from eyas.engine.core.registry import Registry

if TYPE_CHECKING:  # its observations know the whole simulation, and here are names
    from eyas.engine.policies.policy import Policy

_ROOM = "eyas.benchmark.policies"

_BUILT_IN = {
    "random": f"{_ROOM}.simple:Random",
    "hover": f"{_ROOM}.simple:Hover",
    "follow": f"{_ROOM}.follow:Follow",
    "sighted": f"{_ROOM}.road_search:sighted",
    "constant-velocity": f"{_ROOM}.predictors:constant_velocity",
    **{f"wait-{way}": f"{_ROOM}.predictors:wait_{way}" for way in (20, 45, 90)},
    "road-graph": f"{_ROOM}.predictors:road_graph",
    "relay": f"{_ROOM}.relay:relay",
    "servo": f"{_ROOM}.servo:Servo",
    "gimbal-servo": f"{_ROOM}.servo:GimbalServo",
    "attribute-servo": f"{_ROOM}.attribute_servo:attribute_servo",
    "salient-servo": f"{_ROOM}.attribute_servo:salient_servo",
    **{
        name: f"{_ROOM}.own_policy:{name}"
        for name in ("csrt", "kcf", "mosse", "medianflow", "nano", "stay")
    },
}

ABOUT: Mapping[str, str] = {
    "random": "one of the seven actions, drawn anew every 32 ms",
    "hover": "does nothing; the floor of every table",
    "follow": "oracle: flies over the target, whose position it knows at all times",
    "sighted": "oracle: knows where the target is while it is visible; then searches the roads",
    "constant-velocity": "oracle: the same sight; a hidden target goes straight on",
    **{
        f"wait-{way}": f"oracle: the same sight; waits for a hidden target {way} m straight on"
        for way in (20, 45, 90)
    },
    "road-graph": "oracle: the same sight; a hidden target goes on along the lanes",
    "relay": "oracle of a team: sighted, which reports the target's place to the other drones",
    "servo": "pixels: normalised correlation with the target's first picture",
    "gimbal-servo": "pixels: as servo, and turns its camera up and down",
    "attribute-servo": "words and pixels: follows the colour and kind that the words name",
    "salient-servo": "pixels: follows what stands out most, whatever the words say",
    "csrt": "box tracker of OpenCV: discriminative correlation filter (CSR-DCF)",
    "kcf": "box tracker of OpenCV: kernelised correlation filter",
    "mosse": "box tracker of OpenCV: MOSSE",
    "medianflow": "box tracker of OpenCV: median flow",
    "nano": "box tracker of OpenCV: NanoTrack, whose two networks you bring",
    "stay": "box tracker that leaves the box where it was",
}
"""What each built-in policy is, in a line; an oracle knows the truth."""

POLICIES: Registry[Callable[..., Any]] = Registry(
    "--policy",
    Callable,  # type: ignore[arg-type]  # a class to `isinstance`
    _BUILT_IN,
    group="eyas.policies",
)
"""Built in are classes and functions that take changes of `env`; what installed packages
add is what `package.module:name` may be, see `load_callable`."""

WAITERS = ("wait-20", "wait-45", "wait-90")  # Straight on by so many metres, and wait
ORACLES = ("follow", "sighted", "constant-velocity", *WAITERS, "road-graph", "relay")
"""Policies that know the truth; they fly by seven actions or, where `env.actions` says so, by
velocities."""

PERSON = "person"  # What `Policy.told` names where people fly
FLIGHTS = ".flights"  # Ending of files with the flights of people
FILES = {
    ".onnx": f"{_ROOM}.onnx:load_onnx",
    ".json": f"{_ROOM}.chat_agent:open_agent",
    ".zip": f"{_ROOM}.sb3:Sb3Policy",
    ".pt": f"{_ROOM}.torch_file:TorchPolicy",
    ".pth": f"{_ROOM}.torch_file:TorchPolicy",
    ".pt2": f"{_ROOM}.torch_file:TorchPolicy",
    FLIGHTS: f"{_ROOM}.person:RecordedPeople",
}
"""What takes a path and changes of `env` and returns a policy, by the file's ending."""


_LARGEST = 1 << 22
"""Largest number of pixels of an observation, with its frames, that a file may ask for."""


def policy_names() -> tuple[str, ...]:
    """Return the names of all policies: built in, of installed packages, trained ones that ship."""
    return (*POLICIES.names(), *shipped_names())


def runs_code(said: str) -> bool:
    """Return whether a user's policy is code that is not ours, or a file that may run some."""
    return said.endswith(PICKLED) or POLICIES.path(said) is not None


def open_policy(said: str, changes: Mapping[str, Any], *, sampled: bool = False) -> "Policy":
    """Return a policy.

    Args:
        said: A name of `policy_names`, the path of a file, or `package.module:name`.

    Raises:
        EyasError: There is no such policy, or it cannot be loaded.
    """
    policy: Policy
    path = file_of(said) if said in shipped_names() else Path(said)
    own = POLICIES.path(said)
    if said in POLICIES.built_in:
        _refuse_sampled(said, sampled=sampled)
        policy = POLICIES.get(said)(changes)
    elif path.suffix in FILES:
        if not path.is_file():
            raise DataFileError(f"{path}: cannot read: no such file")
        policy = _imported(FILES[path.suffix])(path, changes, sampled=sampled)
        _refuse_large(path, policy, changes)
    elif own is not None:
        from eyas.benchmark.policies.own_policy import load_callable

        _refuse_sampled(said, sampled=sampled)
        policy = load_callable(own, changes)
    else:
        raise UnknownNameError(
            "--policy",
            said,
            policy_names(),
            f"(nor a file {', '.join(FILES)}, nor 'package.module:name')",
        )
    if policy.env.mixture:
        raise ConfigError("env.mixture: not allowed here: the protocol chooses the conditions")
    return policy


def fingerprint(said: str) -> str | None:
    """Return a hash of a policy's file; None if it has none, or one that grows as people fly."""
    path = file_of(said) if said in shipped_names() else Path(said)
    if said in POLICIES.built_in or path.suffix not in FILES or path.suffix == FLIGHTS:
        return None
    return sha256(path.read_bytes()).hexdigest()[:16]


def _refuse_large(path: Path, policy: "Policy", changes: Mapping[str, Any]) -> None:
    """Refuse pictures that would take minutes, unless the user has asked for them."""
    image = policy.env.observation
    asked = {"width", "height", "frames"} & set(changes.get("observation", {}))
    if image.width * image.height * image.frames > _LARGEST and not asked:
        raise ConfigError(
            f"{path}: asks for observations of {image.frames} x {image.width} x {image.height} "
            f"pixels; allowed: up to {_LARGEST}, unless --set env.observation.width=... says so"
        )


def _refuse_sampled(said: str, *, sampled: bool) -> None:
    if sampled:
        raise ConfigError(f"--sample: not allowed for '{said}': it is not a network with scores")


def _imported(path: str) -> Any:  # noqa: ANN401  # a function of the tables above
    module, _, name = path.partition(":")
    return getattr(import_module(module), name)
