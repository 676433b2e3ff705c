"""Every place in the package that reads content which others may have made, found in its code."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import eyas

__all__ = ["OWN", "READERS", "places"]

SOURCE = Path(eyas.__file__).parent

_ANY = {
    "read_limited", "read_json", "decoded_json", "decoded_arrays", "npz_arrays", "decoded_picture",
    "gunzipped", "read_bytes", "read_text", "loadtxt", "genfromtxt", "decompress", "decompressobj",
    "LZMADecompressor", "GzipFile", "ZipFile", "memmap", "fromfile", "iterparse", "XMLParser",
    "ParserCreate", "InferenceSession", "decoded_xml", "FileProcessor", "validate_json", "unpacked",
}  # fmt: skip
_OF = {
    "decode": {"DracoPy"}, "load": {"np", "json", "torch", "export", "pickle", "tomllib"},
    "loads": {"json", "pickle", "tomllib", "marshal"},
    "open": {"Image", "av", "_av", "gzip", "tarfile", "bz2", "lzma", "zipfile"},
    "reader": {"csv"}, "DictReader": {"csv"}, "fromstring": {"ElementTree"},
    "parse": {"ElementTree"}, "load_scene": {"trimesh"}, "load_mesh": {"trimesh"},
    "File": {"h5py", "_h5"}, "read_table": {"pq"},
}  # fmt: skip
WORDS = re.compile(rf"\b({'|'.join([*_ANY, *_OF])})\b")


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
        text = path.read_text(encoding="utf-8")
        if not WORDS.search(text):  # parsing all would take seconds
            continue
        module = ".".join(path.relative_to(SOURCE).with_suffix("").parts)
        finder = _Finder(module)
        finder.visit(ast.parse(text))
        yield from sorted(finder.found)


READERS = {
    "cli.bring:_json": "json",
    "engine.camera.calibration:read_calibration": "calibration",
    "engine.core.decoding:decoded_arrays": "network",
    "engine.core.decoding:decoded_json": "json",
    "engine.core.decoding:_opened": "any picture",
    "engine.core.decoding:gunzipped": "plan.gz",
    "engine.core.decoding:npz_arrays": "traffic",
    "engine.core.decoding:read_json": "json",
    "engine.custom.gltf_file:_Mender._buffer": "gltf",
    "engine.custom.gltf_file:mended_gltf": "gltf",
    "engine.custom.mesh_file:_from_trimesh": "obj",
    "engine.custom.mesh_file:_parts": "obj",
    "engine.custom.mesh_file:_parts.Beside.get": "obj",
    "dat.proto_file:_Walk._opened": "proto",
    "engine.core.decoding:decoded_xml": "urdf",
    "engine.custom.collada_file:checked_collada": "dae",
    "engine.custom.gltf_file:_draco": "draco",
    "robotics.urdf_file:read_urdf": "urdf",
    "engine.custom.trajectory:read_table": "trajectory",
    "maps.traffic.tables:_opened": "vehicle table",
    "maps.traffic.tables:read_columns": "vehicle columns",
    "robotics.tracks.geo:_unzipped": "a.kmz",
    "robotics.tracks.geo:_xml": "a.gpx",
    "robotics.tracks.geo:read_geojson": "a.geojson",
    "robotics.tracks.geo:read_gpx": "a.gpx",
    "robotics.tracks.geo:read_kml": "a.kml",
    "robotics.tracks.logs:read_bin": "a.bin",
    "robotics.tracks.logs:read_tlog": "a.tlog",
    "robotics.tracks.logs:read_ulg": "a.ulg",
    "robotics.tracks.missions:read_plan": "a.plan",
    "robotics.tracks.missions:read_waypoints": "a.waypoints",
    "robotics.tracks.poses:_table": "a.tum",
    "engine.recordings.export:_Checksums.require_whole": "export",
    "engine.recordings.export:_identity": "export",
    "engine.recordings.export:_read": "export",
    "datasets.formats.mcap:_messages": "export",
    "datasets.formats.rerun:Rerun.add": "export",
    "datasets.formats.shards:WebDataset.add": "export",
    "datasets.layout:read_plan": "dataset plan",
    "engine.recordings.recording:RecordedEpisode.frame_count": "labels",
    "engine.recordings.recording:RecordedFrame._flow_levels": "flow",
    "engine.recordings.recording:RecordedFrame._image": "mask",
    "engine.recordings.recording:RecordedFrame.arrays": "arrays",
    "engine.recordings.recording:_table": "dataset",
    "benchmark.plan.latency:_read": "latencies",
    "benchmark.policies.person:read_log": "flights",
    "benchmark.policies.sandbox:receive": "policy messages",
    "benchmark.policies.chat_agent:open_agent": "chat file",
    "benchmark.policies.chat_agent:text_of": "chat reply",
    "benchmark.policies.local_model:_refuse_classes": "robot policy",
    "benchmark.policies.foreign:adapt": "onnx",
    "benchmark.policies.onnx:open_session": "onnx",
    "benchmark.policies.tracker.metadata:metadata": "onnx",
    "benchmark.records.record:read_records": "records",
    "benchmark.records.result:load_run": "stamp",
    "engine.exports.checksums:read_checksums": "checksums",
    "engine.exports.label_reading:labels_in": "labels",
    "learning.checkpoint:RunFolder.load": "checkpoint",
    "learning.checkpoint:RunFolder.load_network": "checkpoint",
    "robotics.fitting.log:_columns": "drone log",
    "robotics.fitting.log:_rows": "drone log",
    "benchmark.report.leaderboard.submission:read_card": "card",
    "benchmark.commands:verify": "entry",
    "benchmark.report.leaderboard.pack:unpacked": "entry",
    "benchmark.report.leaderboard.pack:_files_in": "entry",
    "benchmark.report.leaderboard.mark:content_hash": "mark",
    "benchmark.report.leaderboard.mark:fitting_mark": "mark",
    "benchmark.report.leaderboard.submission:_text_in": "submission",
    "benchmark.report.leaderboard.verify:_flown_again": "records",
    "datasets.tracking.run:_open": "json",
    "datasets.tracking.sequences:_column": "sequence",
    "datasets.tracking.sequences:_decoded": "film",
    "datasets.tracking.sequences:_facts": "sequence facts",
    "datasets.tracking.sequences:_rate_of": "sequence facts",
    "datasets.tracking.sequences:_uav123_parts": "sequence facts",
    "datasets.tracking.sequences:read_truth": "sequence",
    "datasets.tracking.run:_read_boxes": "boxes",
    "engine.settings.file:_parsed": "settings",
    "engine.traffic.net_file:SumoNet.__init__": "roads",
    "engine.traffic.recording_file:RecordingFile.outline": "traffic",
    "engine.traffic.recording_file:RecordingFile.read": "traffic",
    "engine.traffic.recording_file:_expanded": "traffic",
    "engine.traffic.recording_file:_poses": "traffic",
    "engine.traffic.recording_file:_read_arrays": "traffic",
    "engine.traffic.recording_file:_recording": "traffic",
    "engine.traffic.recording_file:_unpacked_npz": "traffic",
    "maps.files:origin_of": "map.json",
    "maps.files:roads_in": "roads",
    "maps.osm.reader:read_pbf": "pbf",
    "maps.osm.reader:_read_xml": "osm",
    "maps.plan.file:content_of": "plan",
    "maps.sumo.files:_root": "sumo routes",
    "maps.sumo.files:moved": "sumo net",
    "maps.sumo.files:place_of": "sumo net",
    "engine.world.roads.network_file:load_network": "network",
}
"""Rows of `test_readers`, by places."""

_PACKAGE = "a file of the package, or of this machine's system"
_CACHE = "the cache, whose files are this user's and have checksums"
_OUTPUT = "what this run, or an earlier one into the same folder, has written"
_CODE = "a file that is code, and is read only if its user says so"
_SOCKET = "a socket, tested in the servers' part"
OWN = {
    "cli.bring:_what_policy": "names in a zip, and a pickle's bytes, which are not unpickled",
    "datasets.hub:hub_files": "a data set of the user's own, whose card is read as text",
    "lanes.text_index:TextIndex.json_of": _PACKAGE,
    "maps.traffic.tables:forms": _PACKAGE,
    "maps.osm.driving_side:usual_side": _PACKAGE,
    "dat.shim:_listen_early": "settings, of which one number is looked for; they are read later",
    "engine.core.identity.build:_digest_of": _PACKAGE,
    "engine.core.cache.array_file:map_arrays": _CACHE,
    "engine.core.installed:_origin": _PACKAGE,
    "engine.core.named_code:origin_of": _CODE,
    "engine.core.machine:_processor": _PACKAGE,
    "engine.core.identity.program:definitions_of": _PACKAGE,
    "engine.recordings.export:_done": _OUTPUT,
    "engine.recordings.format:ExportJob.kept": _OUTPUT,
    "datasets.formats.lerobot:LeRobot._episode": _OUTPUT,
    "datasets.formats.minari:Minari.add": _OUTPUT,
    "datasets.formats.minari:Minari.finish": _OUTPUT,
    "benchmark.policies.sb3:_loaded": _CODE,
    "benchmark.policies.shipped:card_of": _PACKAGE,
    "benchmark.policies.table:fingerprint": _CODE,
    "benchmark.policies.torch_file:TorchPolicy._loaded": _CODE,
    "benchmark.records.record:order_records": _OUTPUT,
    "engine.exports.images:CameraWriter.read": _OUTPUT,
    "maps.formats.gltf.flight:SceneWriter.read": _OUTPUT,
    "engine.exports.episode_files:MarkWriter.read": _OUTPUT,
    "engine.exports.mp4:Mp4Episode.__init__": _OUTPUT,
    "engine.exports.mp4:Mp4Writer.read": _OUTPUT,
    "robotics.ros.bag:RosbagWriter.read": _OUTPUT,
    "maps.formats.openscenario:ScenarioWriter.read": _OUTPUT,
    "engine.exports.episode_files:TableWriter.read": _OUTPUT,
    "lanes.container:unpacked": _CACHE,
    "gpu.cuda.driver:gpu_line": _PACKAGE,
    "gpu.cuda.code:_shipped": _PACKAGE,
    "engine.mesh.shipped:_opened": _PACKAGE,
    "engine.mesh.shipped:read_block": _PACKAGE,
    "maps.textures.shipped:build_textures": _PACKAGE,
    "lanes.syntax:syntax_of": _PACKAGE,
    "lanes.text_index:TextIndex._brought": _PACKAGE,
    "lanes.text_index:TextIndex._name": _PACKAGE,
    "lanes.text_index:TextIndex.of": _CACHE,
    "lanes.trusted:read_trusted": _CACHE,
    "learning.tracking.lessons:load": _OUTPUT,
    "learning.tracking.training:_Run._learn": _OUTPUT,
    "learning.tracking.training:_refuse_other_build": _OUTPUT,
    "learning.tracking.training:_restore": _OUTPUT,
    "datasets.making.make:_damaged": _OUTPUT,
    "datasets.making.make:_lines": _OUTPUT,
    "datasets.making.merge:_digest": _OUTPUT,
    "datasets.making.parts:digest_of": _OUTPUT,
    "datasets.making.spread:_archive_of": _OUTPUT,
    "datasets.making.spread:_unpack": _OUTPUT,
    "demo.messages:parsed": _SOCKET,
    "demo.server:page_file": _PACKAGE,
    "benchmark.evaluation:_write_croissant": _OUTPUT,
    "maps.gallery.run:_check_folder": _OUTPUT,
    "benchmark.report.leaderboard.mark:_key": _PACKAGE,
    "maps.formats.layers:_collection": _OUTPUT,
    "maps.formats.usd:write_usd": _OUTPUT,
    "dat.webots.controllers.drone:Exchange.request": _OUTPUT,
    "dat.webots.controllers.ground:ground_of": _OUTPUT,
    "dat.webots.controllers.ground:settings_of": _OUTPUT,
    "dat.webots.controllers.sumo_supervisor:_offset_of": _OUTPUT,
    "dat.webots.project:_controllers": _PACKAGE,
    "benchmark.report.reproduce.model_card:model_card": _PACKAGE,
    "benchmark.report.reproduce.tables:expected": _PACKAGE,
    "dat.serve.stand_in:_is_ours": _OUTPUT,
    "datasets.tracking.run:_failures": _OUTPUT,
    "cli.verify.cases:recording_of": _OUTPUT,
    "cli.verify.run:_blas_kernel": _PACKAGE,
    "cli.verify.run:read_manifest": _PACKAGE,
    "engine.video.recorder:Checksums._of": _OUTPUT,
    "engine.video.folder:_origin": _OUTPUT,
    "engine.settings.file:parsed_override": "the command line",
    "dat.settings.layout:original_defaults": _PACKAGE,
    "engine.traffic.network:network_xml": _OUTPUT,
    "engine.traffic.network:without_comments": _OUTPUT,
    "maps.osm.streets:osm_network": _OUTPUT,
    "maps.formats.roads:opendrive_xml": _OUTPUT,
    "engine.traffic.signals:load_plan": _PACKAGE,
    "engine.world.maps.recipe:MapRecipe.attribution": _PACKAGE,
    "engine.world.maps.recipe:_digest_of": _PACKAGE,
    "engine.world.maps.recipe:MapRecipe.shipped_plan": _PACKAGE,
    "lanes.shipped:features": _PACKAGE,
    "benchmark.policies.isolation:close_memory": _PACKAGE,
    "benchmark.report.leaderboard.pack:pack": "copied into an archive as they are, not read",
    "benchmark.report.leaderboard.verify:write_verdict": "of which the hash is taken, not read",
    "maps.plan.file:plan_of": _CACHE,
    "engine.world.roads.network_file:save_network": _OUTPUT,
}
"""Why the others need no row."""
