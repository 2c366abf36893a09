"""Every threshold of a diagnosis in one immutable value, each with unit, meaning, what it trades off, and its origin.

Thresholds stand only here; what a definition fixes (rows left out, channels compared) stands with that definition.
"""
