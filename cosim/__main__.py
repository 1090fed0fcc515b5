"""`python -m cosim` is the command line `cosim`."""

from cosim.cli import main

if __name__ == "__main__":
    main()
