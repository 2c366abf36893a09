"""Where files come from: the command that made them, its inputs by hash, versions, and how it is run again.

What computes anything does not belong here.
"""
