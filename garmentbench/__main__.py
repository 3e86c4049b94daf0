"""`python -m garmentbench`: the command line."""

import sys

from garmentbench.cli import main

if __name__ == "__main__":  # worker processes that are spawned import this module under another name
    sys.exit(main())
