"""Small physical changes of the rig, one file per block."""
