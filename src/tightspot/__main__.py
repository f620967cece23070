"""``python -m tightspot`` is the command ``tightspot``."""

import sys

from tightspot.cli import main

if __name__ == "__main__":
    sys.exit(main())
