"""Export a recording or a data set in the formats of other tools."""

import time
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from eyas.engine.recordings.export import ExportOptions, export, exports_folder
from eyas.engine.recordings.recording import load
from eyas.engine.terminal.progress import frames_bar


def run(
    folder: Path,
    formats: Sequence[str],
    out: Path | None,
    options: ExportOptions,
    *,
    quiet: bool = True,
) -> list[Path]:
    """Export a recording in one or several formats; return the folders.

    Args:
        folder: Of a recording or data set.
        formats: Names of formats, or `package.module:Class`.
        out: Folder of the exports; None: `exports` in that of the recording.
        options: What was chosen.
        quiet: Whether nothing is printed.

    Raises:
        EyasError: See `eyas.engine.recordings.export.export`.
        KeyboardInterrupt: The user stopped it; every file that exists is complete.
    """
    recording = load(folder)
    total, folders = recording.frame_count, []
    for name in dict.fromkeys(formats):
        target = exports_folder(folder, name, out)
        begun = time.perf_counter()
        with frames_bar(f"exporting {name}", total, quiet=quiet) as progress:
            try:
                export(recording, name, target, options, progress)
            except KeyboardInterrupt as interrupt:
                interrupt.add_note(f"every file in {target} is whole; continue with --resume")
                raise
        folders.append(target)
        if not quiet:
            rate = total / max(time.perf_counter() - begun, 1e-9)
            line = f"{total} frames of {len(recording)} episodes in {target} ({rate:.0f} a second)"
            Console().print(line, highlight=False, markup=False, soft_wrap=True)
    return folders
