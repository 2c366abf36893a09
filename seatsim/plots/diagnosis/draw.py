"""All figures of a diagnosis, and of a gap."""

from __future__ import annotations

from matplotlib.figure import Figure

from seatsim.diagnosis.result import Diagnosis
from seatsim.plots.diagnosis.answer import plot_gap, plot_gaps, plot_location, plot_ranking
from seatsim.plots.diagnosis.maps import plot_discrepancy, plot_maps
from seatsim.plots.diagnosis.signals import plot_gap_signals, plot_signals
from seatsim.recordings.gap import Gap


def plot_diagnosis(diagnosis: Diagnosis) -> dict[str, Figure]:
    """Return the figures of a diagnosis by name; without a gap there is no evidence for causes to be drawn."""
    found = {"gaps": plot_gaps(diagnosis)}
    if diagnosis.verdict != "none":
        found |= {"location": plot_location(diagnosis), "ranking": plot_ranking(diagnosis)}
        found |= {"discrepancy": plot_discrepancy(diagnosis), "maps": plot_maps(diagnosis)}
    found |= plot_signals(diagnosis)
    return {name: figure for name, figure in found.items() if figure is not None}


def plot_all_of_gap(found: Gap) -> dict[str, Figure]:
    """Return the figures of a gap by name."""
    return {"gap": plot_gap(found), **plot_gap_signals(found)}
