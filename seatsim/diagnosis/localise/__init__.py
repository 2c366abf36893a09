"""Which block of the rig an unexplained remainder lies in, and what is known of it.

What the library's effects explain is not asked here: that is the business of `select` and `decide`.
"""
