"""``python -m multirep``: the command line, started without importing numpy."""

from multirep.cli import main

__all__ = ["main"]

if __name__ == "__main__":
    main()
