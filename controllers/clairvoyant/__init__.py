"""Performance bounds: what no semi-active damper can do better on a known floor, and what one could have done.

What belongs here is what needs the floor in advance, so that no law could run it; laws stand in `controllers.laws`.
Method and validity: docs/bracket.md, whose bracket is the interval between the two.
"""

from controllers.clairvoyant.solve import WEIGHTS, ClairvoyantBounds, clairvoyant

__all__ = ["WEIGHTS", "ClairvoyantBounds", "clairvoyant"]
