"""Whether a recording can be trusted: faults of files, clocks, channels and units, found before anything is fitted."""
