"""`python -m eyas`: the command `eyas`."""

import sys
from importlib.util import find_spec

if __name__ == "__main__":
    if find_spec("eyas.cli") is None:
        sys.exit("eyas: error: the command line is not here (eyas.cli)")
    from eyas.cli.main import main

    main()
