"""Parts of the documents that are made from the code are what the code says."""

import subprocess
import sys
from pathlib import Path


def test_made_documents_are_up_to_date():
    tool = Path(__file__).parents[1] / "tools/write_docs.py"
    done = subprocess.run([sys.executable, tool, "--check"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), "run `python tools/write_docs.py`"
