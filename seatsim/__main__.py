"""Run the command line as `python -m seatsim`."""

from seatsim.cli.app import main

main()
