"""Every threshold of a diagnosis in one frozen value, each with unit, meaning, what it trades off, and its origin.

A threshold stands here and nowhere else; what is fixed by a definition (rows left out, channels compared) stands with
that definition.
"""
