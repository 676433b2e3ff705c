"""Take the picture of the demo's page for the documents: `python tools/demo_page.py FILE`.

It needs chromium and playwright (extra `dev`). The demo flies for real, so no two pictures are the
same.
"""

import re
import shutil
import subprocess
import sys
import time

from playwright.sync_api import sync_playwright

SIZE = {"width": 1360, "height": 820}
FLOWN = 20.0  # Time until the picture is taken, when no tree hides the car [s]


def main() -> None:
    """Start the demo, open its page, and take the picture."""
    run = [sys.executable, "-m", "eyas", "demo", "--no-browser", "--port", "0", "--seed", "4"]
    with subprocess.Popen(run, stdout=subprocess.PIPE, text=True) as demo:
        try:
            lines = iter(demo.stdout.readline, "")
            found = next(filter(None, (re.search(r"http://\S+", line) for line in lines)))
            with sync_playwright() as driver:
                browser = driver.chromium.launch(
                    executable_path=shutil.which("chromium"), args=["--no-sandbox"]
                )
                page = browser.new_page(viewport=SIZE)
                page.goto(found[0])
                time.sleep(FLOWN)
                page.screenshot(path=sys.argv[1], type="jpeg", quality=85)
                browser.close()
        finally:
            demo.terminate()


if __name__ == "__main__":
    main()
