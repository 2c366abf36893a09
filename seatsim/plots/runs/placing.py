"""Places for the names of points so that no two overlap, in inches: estimated, without drawing any text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

TALL = 0.16
LETTER = 0.077
"""Height of a name and width of a letter in inches, at 9.5 points."""
MARK, THIN = 0.07, 0.02
"""Half the side of a point, and of a line, in inches."""
DISTANCES = (0.1, 0.22, 0.36, 0.5, 0.7, 0.9)
"""Distances of a name from its point in inches; beyond the first a line leads to it."""
DIRECTIONS = (0, 60, -60, 180, 90, -90, 120, -120, 30, -30, 150, -150)
"""Degrees, the preferred first."""


class Spot(NamedTuple):
    """Left end of a name, at half its height, from its point; whether a line must lead there."""

    right: float
    up: float
    far: bool


class Box(NamedTuple):
    """A rectangle in inches."""

    left: float
    low: float
    right: float
    high: float

    def meets(self, other: Box) -> bool:
        """Tell whether two rectangles overlap."""
        return self.left < other.right and other.left < self.right and self.low < other.high and other.low < self.high


def place_names(
    points: Sequence[tuple[float, float]], names: Sequence[str], size: tuple[float, float]
) -> list[Spot] | None:
    """Return a spot for the name of each point, all in inches from the lower left corner of a panel.

    points: (x, y) of each. size: width and height of the panel. None is returned where one name finds no room. The
    lowest point, the most comfortable run, chooses first: its name stands nearest.
    """
    taken = [Box(x - MARK, y - MARK, x + MARK, y + MARK) for x, y in points]
    spots: list[Spot | None] = [None] * len(points)
    for index in sorted(range(len(points)), key=lambda k: points[k][1]):
        found = _find_free_spot(points[index], LETTER * len(names[index]), taken, size)
        if found is None:
            return None
        spot, box = found
        spots[index] = spot
        taken += [box, *(_cover_leader(points[index], box) if spot.far else [])]
    return [spot for spot in spots if spot]


def _find_free_spot(
    point: tuple[float, float], wide: float, taken: Sequence[Box], size: tuple[float, float]
) -> tuple[Spot, Box] | None:
    """Return the nearest free spot for a name `wide` inches wide in the preferred direction, with its rectangle."""
    x, y = point
    for distance in DISTANCES:
        for direction in DIRECTIONS:
            across, up = math.cos(math.radians(direction)), math.sin(math.radians(direction))
            left = x + distance * across - (wide if across < -0.1 else 0.5 * wide if across < 0.1 else 0.0)
            middle = y + (distance + 0.5 * TALL * (distance == DISTANCES[0])) * up
            box = Box(left, middle - 0.5 * TALL, left + wide, middle + 0.5 * TALL)
            inside = box.left >= 0 and box.low >= 0 and box.right <= size[0] and box.high <= size[1]
            far = distance > DISTANCES[0]
            needed = [box, *(_cover_leader(point, box) if far else [])]
            if inside and not any(one.meets(other) for one in needed for other in taken):
                return Spot(left - x, middle - y, far), box
    return None


def _cover_leader(point: tuple[float, float], box: Box) -> list[Box]:
    """Return small rectangles along the line between a point and the middle of its name, clear of both."""
    x, y = 0.5 * (box.left + box.right) - point[0], 0.5 * (box.low + box.high) - point[1]
    shares = [0.1 * tenth for tenth in range(1, 10) if 0.1 * tenth * max(abs(x), abs(y)) > MARK + THIN]
    dots = [
        Box(*(point[k % 2] + share * (x, y)[k % 2] + (THIN if k > 1 else -THIN) for k in range(4))) for share in shares
    ]
    return [dot for dot in dots if not dot.meets(box)]
