"""The gap between a simulation and a recording: where it lies, which effect causes it, how far it shrinks."""
