"""The program `proprio`."""

import sys

from ._proprio import run
from ._table import FILES


def main() -> int:
    """Runs the command of the program's arguments; returns its exit status."""
    return run(["proprio", *sys.argv[1:]], FILES)


if __name__ == "__main__":
    sys.exit(main())
