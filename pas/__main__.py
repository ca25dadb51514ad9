"""`python -m pas` is the command line `pas`."""

from pas.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
