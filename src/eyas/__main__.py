"""`python -m eyas`: the command `eyas`."""

from eyas.cli.main import main

main()
