"""Data sets behind a URL: on moto's server of S3, which is real but for the disks."""

import os
import shutil

import pytest

from eyas.datasets.making.make import Making
from eyas.datasets.making.run import run
from eyas.engine.core.errors import ConfigError, OutputError

pytestmark = pytest.mark.slow  # what its tests share takes long to make

moto = pytest.importorskip("moto.server")
s3fs = pytest.importorskip("s3fs")


@pytest.fixture(scope="module")
def server():
    serving = moto.ThreadedMotoServer(port=0, verbose=False)
    serving.start()
    host, port = serving.get_host_and_port()
    yield f"http://{host}:{port}"
    serving.stop()


@pytest.fixture
def bucket(server, monkeypatch):
    told = {
        "AWS_ACCESS_KEY_ID": "test",
        "AWS_SECRET_ACCESS_KEY": "test",
        "AWS_ENDPOINT_URL": server,
        "AWS_DEFAULT_REGION": "us-east-1",
    }
    for name, value in told.items():
        monkeypatch.setenv(name, value)
    s3fs.S3FileSystem.clear_instance_cache()
    files = s3fs.S3FileSystem()
    files.mkdir("sets")
    yield files
    files.rm("sets", recursive=True)
    s3fs.S3FileSystem.clear_instance_cache()


def fetched(files, path, folder):
    files.invalidate_cache()
    files.get(path, str(folder), recursive=True)
    return folder


def test_it_is_put_there_whole(bucket, recipe_file, made, contents, tmp_path):
    run(str(recipe_file), "s3://sets/tiny", Making(workers=1))
    assert contents(fetched(bucket, "sets/tiny", tmp_path / "got")) == contents(made)
    with pytest.raises(OutputError, match=r"s3://sets/tiny: not empty; continue .* --resume"):
        run(str(recipe_file), "s3://sets/tiny", Making())
    run(str(recipe_file), "s3://sets/tiny", Making(resume=True))
    assert contents(fetched(bucket, "sets/tiny", tmp_path / "again")) == contents(made)


def test_another_machine_continues_it(bucket, recipe_file, made, contents, tmp_path, plan):
    # As a run leaves it that was killed on a machine of which nothing is left.
    half = tmp_path / "half"
    shutil.copytree(made, half)
    for name in ("dataset.json", "README.md", "croissant.json", "exports"):
        path = half / name
        shutil.rmtree(path) if path.is_dir() else os.unlink(path)
    from eyas.datasets.layout import write_plan

    write_plan(half, plan)
    parts = sorted(half.glob("parts/*/*"))
    (parts[0] / "part.json").unlink()
    shutil.rmtree(parts[1])
    bucket.put(str(half), "sets/tiny", recursive=True)
    run(str(recipe_file), "s3://sets/tiny", Making(workers=1, resume=True))
    assert contents(fetched(bucket, "sets/tiny", tmp_path / "got")) == contents(made)


def test_what_cannot_be_reached_is_one_line(recipe_file, monkeypatch, bucket):
    with pytest.raises(ConfigError, match="--out: 'nosuch://x/y' is not allowed"):
        run(str(recipe_file), "nosuch://x/y", Making())
    with pytest.raises(OutputError, match="s3://nosuchbucket/x: cannot read or write") as raised:
        run(str(recipe_file), "s3://nosuchbucket/x", Making(workers=1))
    assert "\n" not in str(raised.value)
