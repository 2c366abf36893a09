"""Run the command line as `python -m seatsim`."""

import sys

# `python -m` puts the current folder first on the import path. It may be that of a stranger's recording, whose files
# are not to be taken for modules of seatsim or of its libraries.
if not sys.flags.safe_path:
    del sys.path[0]

from seatsim.cli.begin import begin

begin()
