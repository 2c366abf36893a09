"""A scenario: the frozen value that one run is made of, and how it is read from a YAML file.

Nothing is simulated here.
"""
