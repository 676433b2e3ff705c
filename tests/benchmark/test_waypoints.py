"""Slow agents: ways to fly in the frame of an old picture, latency, and models behind endpoints."""

import base64
import io
import json
import math
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from eyas.benchmark.policies.chat_agent import answer_in
from eyas.benchmark.policies.local_model import _features, _refuse_classes
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.policies.waypoints import WaypointPolicy, own_agent, way_of
from eyas.engine.core.errors import EyasError
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.policies.policy import Instruction, PolicyInput, Start

SIZE = (240, 320)
DONE = {"total_steps": 9000, "no_reward_steps": 9000}  # Though the target drives away


def seen_of(pictures):
    """Return an observation of drones whose sensors read nothing."""
    return {"image": pictures, "sensors": np.zeros((len(pictures), 19), np.float32)}


class Ahead:
    """Asks for a way of 8 m ahead and 4 m to the left in two seconds, once."""

    rate, latency, pictures, size, step = 0.1, 0.0, 2, (64, 48), 1.0

    def begin(self, words):
        self.words = words
        self.looks = []

    def plan(self, look):
        self.looks.append(look)
        return [[4.0, 2.0], [8.0, 4.0, 0.5]]


def flown(policy, seconds, words=("a red car",)):
    """Fly one drone by a policy in a real environment; return its places and turns every 32 ms."""
    settings = {"seed": 5, "env": policy.env.model_dump(mode="json"), "done": DONE}
    env = EyasVectorEnv(1, settings, copy=False)
    told = Instruction(tuple(words), np.zeros((1, 0), np.float32)) if words else None
    policy.begin(Start(np.zeros(1, np.int64), lambda: np.zeros((1, 4), np.int32), told))
    observation, _ = env.reset()
    poses = []
    for step in range(round(seconds / 0.032)):
        state = env.truth().snapshot.trackers
        poses.append([*state.position[0], state.euler[0, 2]])
        sight = PolicyInput(
            observation, np.ones(1, np.bool_), dict, dict, np.zeros(1, np.bool_),
            clock=0.032 * step, told=told,
        )  # fmt: skip
        decision = policy.act(sight)
        assert not decision.failed, decision.failed
        observation = env.step(decision.actions)[0]
    env.close()
    return np.array(poses)


def own_frame(poses):
    """Return places ahead and to the left of the first, and turns, shape (T, 3)."""
    x, y = (poses[:, :2] - poses[0, :2]).T
    yaw = poses[0, 3]
    cosine, sine = math.cos(yaw), math.sin(yaw)
    turn = np.unwrap(poses[:, 3]) - yaw
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, turn], axis=1)


@pytest.mark.slow
def test_a_way_is_flown_in_time_and_held_at_its_end():
    policy = own_agent(Ahead, {}, "x:Ahead")
    way = own_frame(flown(policy, 4.0))
    np.testing.assert_allclose(way[0], 0.0)
    np.testing.assert_allclose(way[31, :2], [4.0, 2.0], atol=0.35)  # after a second
    np.testing.assert_allclose(way[-1], [8.0, 4.0, 0.5], atol=0.05)
    (flight,) = policy._flights
    (look,) = flight.agent.looks
    assert look.pictures.shape == (2, 48, 64, 3)
    assert not look.pictures[0].any()  # before the first
    assert look.pictures[1].std() > 3.0
    assert look.state.shape == (10,)
    assert math.hypot(*look.state[6:]) == pytest.approx(1.0, abs=1e-5)  # a quaternion
    assert (look.words, flight.agent.words, look.time) == ("a red car", "a red car", 0.0)


@pytest.mark.slow
def test_an_answer_is_flown_when_it_comes_but_from_where_the_agent_looked():
    class Late(Ahead):
        latency = 1.0

        def plan(self, look):
            return {"waypoints": [[6.0, 0.0]], "step": 2.0}

    way = own_frame(flown(own_agent(Late, {}, "x:Late"), 4.0))
    assert np.abs(way[:31]).max() == 0.0  # nothing is done before
    np.testing.assert_allclose(way[-1, :2], [6.0, 0.0], atol=0.05)

    class Fast(Late):
        rate = 10.0  # waits for one answer before it looks again

        def plan(self, look):
            self.looks.append(look.time)
            return {"velocity": [2.0, 0.0, 0.0, 0.0]}

    policy = own_agent(Fast, {}, "x:Fast")
    way = own_frame(flown(policy, 4.0))
    assert way[-1, 0] == pytest.approx(2.0 * 3.0, abs=0.2)
    assert len(policy._flights[0].agent.looks) in (3, 4)


def test_ways_in_all_forms():
    assert way_of(None, 0.5, SIZE) is None
    assert way_of([], 0.5, SIZE) is None
    way = way_of([[1, 2], [3, 4, 0.1], [5, 6, 7, 0.2]], 0.5, SIZE)
    assert way.points.tolist() == [[1, 2, 0, 0], [3, 4, 0, 0.1], [5, 6, 7, 0.2]]
    assert way.step == 0.5
    assert way_of({"velocity": [1, 0, 0, 0.3]}, 0.5, SIZE).step == 0.0
    ahead = way_of({"box": [150, 20, 20, 10]}, 0.5, SIZE).points[0]
    assert ahead[0] > 5.0
    assert ahead[1] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("answer", "line"),
    [
        ({"waypoints": 3}, "waypoints: 3 is not allowed: a list of points"),
        ({"waypoints": [[1]]}, "waypoints: 2, 3 or 4 numbers each"),
        ({"waypoints": [[1, float("nan")]]}, "waypoints: .* finite numbers"),
        ({"waypoints": [[1, 1e9]]}, "waypoints: .* finite numbers"),
        ({"waypoints": [[0, 0]] * 300}, "waypoints: 300; allowed: up to 200"),
        ({"waypoints": [[0, 0]], "step": 0}, "step: 0 is not allowed"),
        ({"velocity": ["fast"] * 4}, "velocity: .* finite numbers"),
        ({"fly": 1}, "no waypoints, velocity or box"),
    ],
)
def test_what_is_no_way_is_one_line(answer, line):
    with pytest.raises(ValueError, match=line):
        way_of(answer, 0.5, SIZE)


def test_words_are_for_those_whose_class_of_entry_has_them(tmp_path):
    class Deaf:
        def plan(self, look):
            return {"velocity": [float(len(look.words)), 0.0, 0.0, 0.0]}

    policy = own_agent(Deaf, {}, "x:Deaf")
    assert policy.told == frozenset()
    told = Instruction(("a",), np.zeros((1, 0), np.float32))
    policy.begin(Start(np.zeros(1, np.int64), lambda: np.zeros((1, 4), np.int32), told))
    one = np.ones(1, np.bool_)
    pictures = np.zeros((1, 240, 320, 3), np.uint8)
    sight = PolicyInput(seen_of(pictures), one, dict, dict, ~one, clock=0.0, told=told)
    assert policy.act(sight).actions.tolist() == [[0.0] * 4]
    assert chat(tmp_path, "http://localhost:1/v1").told == {"words"}


def test_an_agent_that_fails_ends_its_own_flight_only():
    class Odd(Ahead):
        def plan(self, look):
            if look.words == "b":
                raise RuntimeError("no idea")
            return {"velocity": [1.0, 0.0, 0.0, 0.0]}

    policy = own_agent(Odd, {}, "x:Odd")
    told = Instruction(("a", "b"), np.zeros((2, 0), np.float32))
    policy.begin(Start(np.zeros(2, np.int64), lambda: np.zeros((2, 4), np.int32), told))
    pictures = np.zeros((2, 48, 64, 3), np.uint8)
    everyone = np.ones(2, np.bool_)
    seen = PolicyInput(seen_of(pictures), everyone, dict, dict, ~everyone, clock=0.0)
    decision = policy.act(seen)
    assert decision.failed.keys() == {1}
    assert decision.failed[1].line == "RuntimeError: no idea"
    assert decision.actions[0].tolist() == [1.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    "wrong", [{"rate": 0.0}, {"rate": "fast"}, {"size": (4, 4)}, {"size": 3}, {"pictures": 100}]
)
def test_attributes_out_of_range_are_one_line(wrong):
    bad = type("Bad", (Ahead,), wrong)
    with pytest.raises(EyasError, match=f"--policy: {next(iter(wrong))} = .* is not allowed"):
        own_agent(bad, {}, "x:Bad")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('Sure!\n```json\n{"box": [1, 2, 3, 4]}\n```', {"box": [1, 2, 3, 4]}),
        ('{"thought": "left"} so {"velocity": [0, 1, 0, 0]}.', {"velocity": [0, 1, 0, 0]}),
        ("I see a car.", None),
        ('{"box": [1, 2]} {"waypoints": [[1', None),
        ('{"box": [1, 2, 3, 4]} {"x": {"y": 1}}', {"box": [1, 2, 3, 4]}),
    ],
)
def test_the_answer_is_found_among_words(text, found):
    assert answer_in(text, 0.5, (320, 240)) == found


class _Model(BaseHTTPRequestHandler):
    """A small stand-in: it finds the brightest spot of the last picture, and answers in prose."""

    def do_POST(self):
        question = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.asked.append((self.path, self.headers.get("Authorization"), question))
        status = 200 if question["model"] == "spots" else 404
        *_, last = question["messages"][1]["content"]
        data = base64.b64decode(last["image_url"]["url"].partition(",")[2])
        luma = np.asarray(Image.open(io.BytesIO(data)).convert("L"), np.float64)
        row, column = np.unravel_index(np.argmax(luma), luma.shape)
        said = f'There it is: {{"box": [{column - 2}, {row - 2}, 4, 4]}}'
        reply = {"choices": [{"message": {"role": "assistant", "content": said}}]}
        content = json.dumps(reply if status == 200 else {"error": "no such model"}).encode()
        self.send_response(status)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_):
        pass


@pytest.fixture
def endpoint():
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Model)
    server.asked = []
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server, f"http://127.0.0.1:{server.server_port}/v1"
    server.shutdown()
    server.server_close()


def chat(tmp_path, url, **more):
    path = tmp_path / "agent.json"
    path.write_text(json.dumps({"url": url, "model": "spots", "latency": 0.0} | more))
    return open_policy(str(path), {})


def test_a_model_behind_an_endpoint_flies(tmp_path, endpoint, monkeypatch):
    server, url = endpoint
    monkeypatch.setenv("EYAS_AGENT_KEY", "secret")
    monkeypatch.setenv("EYAS_AGENT_HOST", "127.0.0.1")
    policy = chat(tmp_path, url, size=[64, 48], rate=2.0, step=1.0)
    assert isinstance(policy, WaypointPolicy)
    count = 3
    told = Instruction(("the bus",) * count, np.zeros((count, 0), np.float32))
    policy.begin(Start(np.zeros(count, np.int64), lambda: np.zeros((count, 4), np.int32), told))
    pictures = np.zeros((count, 48, 64, 3), np.uint8)
    pictures[0, 8, 32] = pictures[1, 24, 10] = pictures[2, 24, 54] = 255  # ahead, left, right
    everyone = np.ones(count, np.bool_)
    sight = PolicyInput(seen_of(pictures), everyone, dict, dict, ~everyone, clock=0.0)
    actions = policy.act(sight).actions
    assert actions[0][0] > 1.0 > abs(actions[0][1])
    assert actions[1][1] > 1.0 > abs(actions[1][0])
    assert actions[2][1] < -1.0
    path, key, question = server.asked[0]
    assert (path, key) == ("/v1/chat/completions", "Bearer secret")
    system, user = question["messages"]
    assert '{"box": [left, top, width, height]}' in system["content"]
    assert "the last 2 pictures of 64x48 pixels" in system["content"]
    assert "the bus" in user["content"][0]["text"]
    assert len(user["content"]) == 3
    policy.act(sight._replace(clock=0.25))
    assert len(server.asked) == 3  # it looks twice a second
    policy.act(sight._replace(clock=0.5))
    assert len(server.asked) == 6


def test_a_key_is_for_one_machine_whatever_a_file_names(tmp_path, endpoint, monkeypatch):
    server, url = endpoint
    monkeypatch.setenv("EYAS_AGENT_KEY", "secret")
    monkeypatch.setenv("EYAS_AGENT_HOST", "api.example.org")
    policy = chat(tmp_path, url, size=[64, 48])
    policy.begin(Start(np.zeros(1, np.int64), lambda: np.zeros((1, 4), np.int32), None))
    one = np.ones(1, np.bool_)
    pictures = np.zeros((1, 48, 64, 3), np.uint8)
    policy.act(PolicyInput(seen_of(pictures), one, dict, dict, ~one, clock=0.0))
    assert [key for _, key, _ in server.asked] == [None]


def test_an_endpoint_that_refuses_is_one_line(tmp_path, endpoint):
    _, url = endpoint
    for address, model, line in (
        (url, "other", "404 Not Found"),
        ("http://127.0.0.1:9/v1", "spots", "refused"),
    ):
        policy = chat(tmp_path, address, size=[64, 48], model=model)
        policy.begin(Start(np.zeros(1, np.int64), lambda: np.zeros((1, 4), np.int32), None))
        one = np.ones(1, np.bool_)
        pictures = np.zeros((1, 48, 64, 3), np.uint8)
        seen = PolicyInput(seen_of(pictures), one, dict, dict, ~one, clock=0.0)
        (failure,) = policy.act(seen).failed.values()
        assert failure.line.startswith(f"ConnectionError: {address}/chat/completions: ")
        assert line in failure.line


@pytest.mark.parametrize(
    ("more", "line"),
    [
        ({"url": "file:///etc/passwd"}, "url: 'file:///etc/passwd' is not allowed"),
        ({"key": "x"}, "key: unknown key"),
        ({"rate": 0}, "rate: 0 is not allowed"),
    ],
)
def test_a_file_of_a_model_that_is_wrong_is_one_line(tmp_path, more, line):
    with pytest.raises(EyasError, match=line):
        chat(tmp_path, **{"url": "http://localhost:1/v1"} | more)


def test_a_policy_on_this_machine_without_its_files_is_one_line(tmp_path):
    path = tmp_path / "agent.json"
    for content, line in (
        ({"lerobot": "nowhere"}, "lerobot: no config.json in the folder .*nowhere"),
        ({"lerobot": "x", "rate": 0.0}, "rate: 0.0 is not allowed"),
        ({"lerobot": "x", "transformers": "y"}, "not lerobot and transformers"),
        ({}, "one of 'lerobot', 'transformers', 'url' is allowed, not none"),
        ({"url": "http://a"}, "model: missing, allowed: text, not empty"),
        ({"url": "file:///etc", "model": "m"}, "'file:///etc' is not allowed: an address, http"),
        ({"transformers": "y", "device": "gpu"}, "device: 'gpu' is not allowed"),
    ):
        path.write_text(json.dumps(content))
        with pytest.raises(EyasError, match=line) as caught:
            open_policy(str(path), {})
        assert "\n" not in str(caught.value)


def test_a_processor_that_names_a_class_of_python_is_refused(tmp_path):
    path = tmp_path / "policy_preprocessor.json"
    path.write_text('{"steps": [{"class": "subprocess.Popen", "config": {"args": ["ls"]}}]}')
    with pytest.raises(EyasError, match=r"'subprocess\.Popen' is not allowed"):
        _refuse_classes(path)


def test_a_robots_policy_sees_and_does_what_a_drone_can():
    def config(inputs, action=(4,)):
        shapes = {name: SimpleNamespace(shape=shape) for name, shape in inputs.items()}
        acts = {"action": SimpleNamespace(shape=action)}
        return SimpleNamespace(input_features=shapes, output_features=acts)

    picture = {"observation.images.camera": (3, 48, 64)}
    name, size = _features(config({**picture, "observation.state": (10,)}), "here")
    assert (name, size) == ("observation.images.camera", (64, 48))
    for wrong in (
        config({"observation.state": (10,)}),
        config({**picture, "observation.environment_state": (8,)}),
        config({**picture, "observation.state": (7,)}),
        config(picture, action=(6,)),
    ):
        with pytest.raises(EyasError, match=r"^here: (in|out)put_features: "):
            _features(wrong, "here")
