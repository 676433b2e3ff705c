"""Write the hashes that `eyas verify` compares, and say which have changed.

    python tools/write_manifest.py

Run it when bytes have changed on purpose, and commit the file with the change.
"""

from eyas.cli.verify.cases import cases
from eyas.cli.verify.run import compared, manifest_path, measured, read_manifest, text_of
from eyas.engine.core.files import write_atomic


def main() -> None:
    """Compute all cases, write the manifest and print what differs from the last one."""
    known = read_manifest() if manifest_path().exists() else {}
    found = measured(cases())
    for case, names in compared(found, known).different.items():
        print(f"changed: {case}: {', '.join(names)}")
    for case in sorted(known.keys() - found.keys()):
        print(f"gone: {case}")
    write_atomic(manifest_path(), text_of(found).encode())
    print(f"{manifest_path()}: {len(found)} cases")


if __name__ == "__main__":
    main()
