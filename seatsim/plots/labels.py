"""Text of pictures: what metrics are called, and names that matplotlib must not interpret."""

from __future__ import annotations

from seatsim.metrics.table import METRICS, SHORT
from seatsim.schema.printing import LONGEST, Quantity, describe_channel, shorten


def describe_metric(name: str) -> Quantity:
    """Return how a metric of a run is shown, in few words."""
    return describe_channel(SHORT.get(name, name), METRICS[name].unit)


def clean_text(text: str, longest: int = LONGEST) -> str:
    """Return a text of at most `longest` letters that matplotlib prints as it stands.

    Names come from scenarios and recordings. matplotlib would set what stands between two dollar signs as a formula,
    and hides a label that begins with an underscore.
    """
    short = shorten(text, longest)
    return (f" {short}" if short.startswith("_") else short).replace("$", r"\$")
