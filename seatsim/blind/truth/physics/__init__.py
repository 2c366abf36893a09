"""Equations of the true rig and their integration; `faults` decides which parameters depart from nominal."""
