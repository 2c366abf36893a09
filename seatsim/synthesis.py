"""From a scenario to the design of its control law, and the report on it."""

from __future__ import annotations

import math
from typing import Any

from rich.table import Table

from seatsim.errors import InputError
from seatsim.registry import name_of
from seatsim.scenario import Scenario


def design_for(scenario: Scenario) -> Any:
    """Return the design of a law that has a synthesis, for the scenario's plant.

    Raises:
        InputError: the scenario has no seat, or its law is not synthesised.
        SynthesisError: there is no such design.
    """
    with scenario.placed("controller"):
        if scenario.plant is None or scenario.control is None:
            raise InputError("a damper bench has no controller to synthesise")
        law = scenario.control.law
        if not hasattr(law, "synthesis"):
            name = name_of("law", type(law))
            raise InputError(f"law '{name}' is not synthesised; use 'law: static_output_feedback' with 'weights'")
        return law.synthesis(scenario.plant)


def report(design: Any) -> Table:
    """Return a design as a table: gain, norm beside what no controller can go below, certificate, poles."""
    table = Table(title="H-infinity static output feedback", title_justify="left", show_header=False, box=None)
    proof = design.certificate
    rows = {
        "gain on (x, v)": ", ".join(f"{value:.6g}" for value in design.gain.ravel()) + "  [N/m, N s/m]",
        "gamma": f"{design.gamma:.6g} (largest gain permitted {design.max_gain:g})",
        "lower bound": f"{design.lower_bound:.6g}, of any linear controller of any order",
        "certificate": f"bounded-real lemma at gamma {proof.gamma:.6g}" if proof else "none in double precision",
        "peak": f"{design.peak_frequency / (2 * math.pi):.3g} Hz",
        "poles": ", ".join(f"{pole:.3g}" for pole in design.poles) + "  [rad/s]",
    }
    for name, value in rows.items():
        table.add_row(name, value)
    return table
