"""Every place in the package that reads content which others may have made, found in its code."""

import ast
from collections.abc import Iterator
from pathlib import Path

import eyas

__all__ = ["OWN", "READERS", "places"]

SOURCE = Path(eyas.__file__).parent

_ANY = {
    "read_limited", "read_json", "decoded_json", "decoded_arrays", "npz_arrays", "decoded_picture",
    "gunzipped", "read_bytes", "read_text", "loadtxt", "genfromtxt", "decompress", "decompressobj",
    "LZMADecompressor", "GzipFile", "ZipFile", "memmap", "fromfile", "iterparse", "XMLParser",
    "ParserCreate", "InferenceSession", "FileProcessor", "validate_json", "unpacked",
}  # fmt: skip
_OF = {
    "load": {"np", "json", "torch", "export", "pickle", "tomllib"},
    "loads": {"json", "pickle", "tomllib", "marshal"},
    "open": {"Image", "av", "_av", "gzip", "tarfile", "bz2", "lzma", "zipfile"},
    "reader": {"csv"}, "DictReader": {"csv"}, "fromstring": {"ElementTree"},
    "parse": {"ElementTree"}, "load_scene": {"trimesh"}, "load_mesh": {"trimesh"},
    "File": {"h5py", "_h5"}, "read_table": {"pq"},
}  # fmt: skip


class _Finder(ast.NodeVisitor):
    def __init__(self, module: str) -> None:
        self.module, self.within, self.found = module, list[str](), set[str]()

    def visit(self, node: ast.AST) -> None:
        named = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
        if named:
            self.within.append(node.name)
        if isinstance(node, ast.Call):
            self._note(node)
        self.generic_visit(node)
        if named:
            self.within.pop()

    def _note(self, node: ast.Call) -> None:
        called = node.func
        name = getattr(called, "attr", getattr(called, "id", ""))
        owner = getattr(called, "value", None)
        of = getattr(owner, "attr", getattr(owner, "id", ""))
        if name in _ANY or of in _OF.get(name, ()):
            self.found.add(f"{self.module}:{'.'.join(self.within)}")


def places() -> Iterator[str]:
    """Yield `room.module:function` of each place that reads or unpacks content."""
    for path in sorted(SOURCE.rglob("*.py")):
        module = ".".join(path.relative_to(SOURCE).with_suffix("").parts)
        finder = _Finder(module)
        finder.visit(ast.parse(path.read_text(encoding="utf-8")))
        yield from sorted(finder.found)


READERS = {
    "core.decoding:decoded_arrays": "network",
    "core.decoding:decoded_json": "json",
    "core.decoding:decoded_picture": "mask",
    "core.decoding:gunzipped": "plan.gz",
    "core.decoding:npz_arrays": "traffic",
    "core.decoding:read_json": "json",
    "custom.gltf_file:_Mender._buffer": "gltf",
    "custom.gltf_file:mended_gltf": "gltf",
    "custom.mesh_file:_from_trimesh": "obj",
    "custom.mesh_file:_parts": "obj",
    "custom.mesh_file:_parts.Beside.get": "obj",
    "custom.proto_file:_Walk._visit_proto": "proto",
    "custom.trajectory:read_trajectory": "trajectory",
    "datasets.export:_Checksums.require_whole": "export",
    "datasets.export:_identity": "export",
    "datasets.export:_read": "export",
    "datasets.formats.mcap:_messages": "export",
    "datasets.formats.rerun:Rerun._log": "export",
    "datasets.formats.shards:WebDataset.add": "export",
    "datasets.layout:read_plan": "dataset plan",
    "datasets.recording:RecordedEpisode.frame_count": "labels",
    "datasets.recording:RecordedFrame._flow_levels": "flow",
    "datasets.recording:RecordedFrame._image": "mask",
    "datasets.recording:RecordedFrame.arrays": "arrays",
    "datasets.recording:_table": "dataset",
    "evaluation.delay:_read": "latencies",
    "evaluation.policies.apart:receive": "policy messages",
    "evaluation.policies.onnx:_session": "onnx",
    "evaluation.policies.tracker.metadata:metadata": "onnx",
    "evaluation.record:read_records": "records",
    "evaluation.result:load_run": "stamp",
    "exports.checksums:read_checksums": "checksums",
    "exports.label_reading:labels_in": "labels",
    "learning.checkpoint:RunFolder.load": "checkpoint",
    "learning.checkpoint:RunFolder.load_network": "checkpoint",
    "modes.drone.log:_columns": "drone log",
    "modes.drone.log:_rows": "drone log",
    "modes.leaderboard.card:read_card": "card",
    "modes.leaderboard.mark:content_hash": "mark",
    "modes.leaderboard.mark:fitting_mark": "mark",
    "modes.leaderboard.submission:_text_in": "submission",
    "modes.leaderboard.verify:_flown_again": "records",
    "modes.track.run:_open": "json",
    "modes.track.run:_scored": "boxes",
    "settings.file:_parsed": "settings",
    "traffic.net_file:SumoNet.__init__": "roads",
    "traffic.recording_file:RecordingFile.outline": "traffic",
    "traffic.recording_file:RecordingFile.read": "traffic",
    "traffic.recording_file:_expanded": "traffic",
    "traffic.recording_file:_poses": "traffic",
    "traffic.recording_file:_read_arrays": "traffic",
    "traffic.recording_file:_recording": "traffic",
    "traffic.recording_file:_unpacked_npz": "traffic",
    "world.maps.files:origin_of": "map.json",
    "world.maps.files:roads_in": "roads",
    "world.osm.pbf:read_pbf": "pbf",
    "world.osm.reader:_read_xml": "osm",
    "world.plan.file:content_of": "plan",
    "world.roads.network_file:load_network": "network",
}
"""Rows of `test_readers`, by places."""

_PACKAGE = "a file of the package, or of this machine's system"
_CACHE = "the cache, whose files are this user's and have checksums"
_OUTPUT = "what this run, or an earlier one into the same folder, has written"
_CODE = "a file that is code, and is read only if its user says so"
_SOCKET = "a socket, tested in the servers' part"
OWN = {
    "cli.webots:_listen_early": "settings, of which one number is looked for; they are read later",
    "core.build:_digest_of": _PACKAGE,
    "core.cache.array_file:map_arrays": _CACHE,
    "core.installed:_origin": _PACKAGE,
    "core.origin:origin_of": _CODE,
    "core.machine:_processor": _PACKAGE,
    "core.program:definitions_of": _PACKAGE,
    "datasets.export:_done": _OUTPUT,
    "datasets.format:Job.kept": _OUTPUT,
    "datasets.formats.lerobot:LeRobot._episode": _OUTPUT,
    "datasets.formats.minari:Minari.add": _OUTPUT,
    "datasets.formats.minari:Minari.finish": _OUTPUT,
    "evaluation.policies.sb3:_loaded": _CODE,
    "evaluation.policies.shipped:card_of": _PACKAGE,
    "evaluation.policies.table:fingerprint": _CODE,
    "evaluation.policies.torch_file:TorchPolicy._loaded": _CODE,
    "evaluation.record:order_records": _OUTPUT,
    "exports.cameras:CameraWriter.read": _OUTPUT,
    "exports.gltf.flight:SceneWriter.read": _OUTPUT,
    "exports.mark:MarkWriter.read": _OUTPUT,
    "exports.mp4:Mp4Episode.__init__": _OUTPUT,
    "exports.mp4:Mp4Writer.read": _OUTPUT,
    "exports.ros.bag:RosbagWriter.read": _OUTPUT,
    "exports.scenario:ScenarioWriter.read": _OUTPUT,
    "exports.table:TableWriter.read": _OUTPUT,
    "lanes.container:unpacked": _CACHE,
    "lanes.cuda.cards:gpu_line": _PACKAGE,
    "lanes.cuda.code:_shipped": _PACKAGE,
    "lanes.modules:_shipped": _PACKAGE,
    "lanes.shipped:read_archive": _PACKAGE,
    "lanes.syntax:syntax_of": _PACKAGE,
    "lanes.text_index:TextIndex._brought": _PACKAGE,
    "lanes.text_index:TextIndex._name": _PACKAGE,
    "lanes.text_index:TextIndex.of": _CACHE,
    "lanes.trusted:read_trusted": _CACHE,
    "learning.tracking.shots:load": _OUTPUT,
    "learning.tracking.training:_Run._learn": _OUTPUT,
    "learning.tracking.training:_refuse_other_build": _OUTPUT,
    "learning.tracking.training:_restore": _OUTPUT,
    "modes.dataset.make:_damaged": _OUTPUT,
    "modes.dataset.make:_lines": _OUTPUT,
    "modes.dataset.merge:_digest": _OUTPUT,
    "modes.dataset.parts:digest_of": _OUTPUT,
    "modes.dataset.spread:_archive_of": _OUTPUT,
    "modes.dataset.spread:_unpack": _OUTPUT,
    "modes.demo.messages:parsed": _SOCKET,
    "modes.demo.requests:page_file": _PACKAGE,
    "modes.evaluate:_write_croissant": _OUTPUT,
    "modes.gallery.run:_check_folder": _OUTPUT,
    "modes.leaderboard.mark:_key": _PACKAGE,
    "modes.maps.plan_files:_collection": _OUTPUT,
    "modes.maps.usd:run": _OUTPUT,
    "modes.maps.webots.controllers.exchange:Exchange.request": _OUTPUT,
    "modes.maps.webots.controllers.ground:ground_of": _OUTPUT,
    "modes.maps.webots.controllers.ground:settings_of": _OUTPUT,
    "modes.maps.webots.controllers.sumo_supervisor:_offset_of": _OUTPUT,
    "modes.maps.webots.project:_controllers": _PACKAGE,
    "modes.reproduce.model_card:model_card": _PACKAGE,
    "modes.reproduce.tables:expected": _PACKAGE,
    "modes.serve.stand_in:_is_ours": _OUTPUT,
    "modes.track.run:_failures": _OUTPUT,
    "modes.verify.measures:recording_of": _OUTPUT,
    "modes.verify.run:_blas_kernel": _PACKAGE,
    "modes.verify.run:read_manifest": _PACKAGE,
    "modes.video.checksums:Checksums._of": _OUTPUT,
    "modes.video.folder:_origin": _OUTPUT,
    "settings.file:parsed_override": "the command line",
    "settings.legacy.layout:original_defaults": _PACKAGE,
    "traffic.network:network_xml": _OUTPUT,
    "traffic.network:without_comments": _OUTPUT,
    "traffic.osm_network:osm_network": _OUTPUT,
    "maps.formats.roads:opendrive_xml": _OUTPUT,
    "traffic.signals:load_plan": _PACKAGE,
    "world.maps.recipe:MapRecipe.attribution": _PACKAGE,
    "world.maps.recipe:_digest_of": _PACKAGE,
    "world.plan.file:plan_of": _CACHE,
    "world.roads.network_file:save_network": _OUTPUT,
}
"""Why the others need no row."""
