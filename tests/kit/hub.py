"""A stand-in of the Hugging Face hub: what its client asks to publish files, on this machine.

Of its HTTP interface: making a repository, how each file is to be sent, large files (Git LFS), and
commits.
"""

import base64
import hashlib
import json
import re
import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import yaml

TOKEN = "hf_of_a_test"
LARGE = (".jpeg", ".jpg", ".onnx")
"""Ends of the names of files that are sent as large ones, as the hub's `.gitattributes` have it."""


class Hub:
    """What has arrived: repositories by kind and name, each with its commits and its files."""

    def __init__(self):
        self.repositories = {}
        self.large = {}
        self.refusal = None
        self.address = ""

    def environment(self):
        """Return the variables by which a program finds it."""
        return {
            "HF_ENDPOINT": self.address,
            "HF_TOKEN": TOKEN,
            "HF_HUB_DISABLE_XET": "1",  # another server's business
            "HF_HUB_DISABLE_TELEMETRY": "1",
            "HF_HUB_DISABLE_PROGRESS_BARS": "1",
        }

    def answer(self, method, path, body, known):
        """Return status and JSON of a request."""
        if not known:
            return 401, {"error": "Invalid username or password."}
        if self.refusal is not None:
            return self.refusal
        path = path.partition("?")[0]
        if path == "/api/repos/create":
            asked = json.loads(body)
            kind, name = asked.get("type", "model"), asked["name"]
            name = f"{asked.get('organization') or 'someone'}/{name}"
            place = "" if kind == "model" else f"{kind}s/"
            said = {"url": f"{self.address}/{place}{name}", "name": name}
            private = bool(asked.get("private") or asked.get("visibility") == "private")
            if (kind, name) in self.repositories:
                return 409, {"error": "You already created this repo", **said}
            self.repositories[kind, name] = {"private": private, "commits": [], "files": {}}
            return 200, said
        if path == "/api/validate-yaml":
            asked = json.loads(body)
            front = asked["content"].split("---\n")[1]
            wrong = [] if isinstance(yaml.safe_load(front), dict) else [{"message": "no mapping"}]
            return 200, {"errors": wrong, "warnings": []}
        if path == "/api/whoami-v2":
            return 200, {"name": "someone", "type": "user", "orgs": []}
        if found := re.fullmatch(r"/api/(\w+)s/([^/]+/[^/]+)/preupload/main", path):
            files = [
                {
                    "path": each["path"],
                    "uploadMode": "lfs" if each["path"].endswith(LARGE) else "regular",
                    "shouldIgnore": False,
                }
                for each in json.loads(body)["files"]
            ]
            return 200, {"files": files}
        if path.endswith(".git/info/lfs/objects/batch"):
            objects = [
                {**each, "actions": {"upload": {"href": f"{self.address}/large/{each['oid']}"}}}
                for each in json.loads(body)["objects"]
            ]
            return 200, {"transfer": "basic", "objects": objects}
        if found := re.fullmatch(r"/api/(\w+)s/([^/]+/[^/]+)/commit/main", path):
            return 200, self._commit(found[1], found[2], body)
        return 404, {"error": f"{method} {path}"}

    def _commit(self, kind, name, body):
        repository = self.repositories[kind, name]
        header, *changes = (json.loads(line) for line in body.splitlines())
        for change in changes:
            value = change["value"]
            if change["key"] == "lfsFile":
                repository["files"][value["path"]] = self.large[value["oid"]]
            else:
                repository["files"][value["path"]] = base64.b64decode(value["content"])
        paths = [change["value"]["path"] for change in changes]
        repository["commits"].append((header["value"]["summary"], paths))
        number = hashlib.sha1(body).hexdigest()
        return {"commitUrl": f"{self.address}/{name}/commit/{number}", "commitOid": number}


@contextmanager
def running_hub():
    """Yield a stand-in that listens on this machine."""
    hub = Hub()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            body = self.rfile.read(int(self.headers["Content-Length"] or 0))
            known = self.headers["Authorization"] == f"Bearer {TOKEN}"
            self.reply(*hub.answer(self.command, self.path, body, known))

        do_GET = do_POST  # noqa: N815

        def do_PUT(self):
            content = self.rfile.read(int(self.headers["Content-Length"]))
            number = self.path.rpartition("/")[2]
            assert hashlib.sha256(content).hexdigest() == number
            hub.large[number] = content
            self.reply(200, {})

        def reply(self, status, content):
            said = json.dumps(content).encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(said)))
            self.end_headers()
            self.wfile.write(said)

        def log_message(self, *words):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        hub.address = f"http://127.0.0.1:{server.server_port}"
        thread = threading.Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        try:
            yield hub
        finally:
            server.shutdown()
            thread.join()
