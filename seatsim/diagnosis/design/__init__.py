"""What a recording, or the next experiment, can tell apart: isolability, collinearity, proposed experiments.

Nothing here changes a verdict.
"""
