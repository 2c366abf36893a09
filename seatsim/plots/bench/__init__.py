"""Figures of a damper alone on a bench: its characterisation, and a model identified from it; not of a whole rig."""
