"""A synthesised design, as the terminal shows it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from rich.table import Table

from seatsim.rig.designs import BoxProof, CheckedLaw, DesignedLoop, SynthesisedDesign
from seatsim.scenario.scenario import Scenario
from seatsim.simulation.simulate import DEFAULT_SAMPLE_TIME

_UNITS = {"displacement": "N/m", "velocity": "N s/m", "acceleration": "kg"}
"""Unit of the gain on a measured quantity, by the last word of its name."""


def design_table(design: SynthesisedDesign, scenario: Scenario) -> Table:
    """Return a design as a table: gain, norm and what no controller can go below, certificate, margins, poles.

    The margins in the same row as the disk's are those of the scenario's own plant, coil and controller.
    """
    table = Table(title="H-infinity static output feedback", title_justify="left", show_header=False, box=None)
    proof = design.certificate
    rows = {
        f"gain on {', '.join(design.measures)}": ", ".join(f"{value:.6g}" for value in design.gain.ravel())
        + f"  [{', '.join(_UNITS[measure.rpartition('_')[2]] for measure in design.measures)}]",
        "gamma": f"{design.gamma:.6g} (largest gain permitted {design.max_gain:g})",
        "lower bound": f"{design.lower_bound:.6g}, of any linear controller of any order",
        "certificate": f"bounded-real lemma at gamma {proof.gamma:.6g}" if proof else "none in double precision",
        "disk margin": _describe_disk_margin(min(loop.disk_margin for loop in design.loops)),
        "peak": f"{design.peak_frequency / (2 * math.pi):.3g} Hz",
        "poles": ", ".join(f"{pole:.3g}" for pole in design.poles) + "  [rad/s]",
    }
    if design.proof is not None:
        rows["best gain"] = _describe_proof(design.proof)
    if len(design.loops) > 1:
        rows["plants"] = _describe_loops(design.loops)
    if not all(loop.norms_agree for loop in design.loops):
        rows["norms"] = "bisection and frequency grid differ by more than 1e-6: gamma may be too small"
    for name, value in {**rows, **_check_loop(design, scenario)}.items():
        table.add_row(name, value)
    return table


def _describe_disk_margin(margin: float) -> str:
    # A margin of 2 stands for any gain; its factor (2 + a) / (2 - a) would divide by zero.
    most = "any" if margin > 2 - 1e-6 else f"{(2 + margin) / (2 - margin):.3g}"
    least, turn = (2 - margin) / (2 + margin), 2 * math.degrees(math.atan(margin / 2))
    return f"gain times {max(least, 0.0):.2g} to {most}, phase {turn:.3g} degrees"


def _describe_proof(proof: BoxProof) -> str:
    if proof.better is not None:
        return f"no: {', '.join(f'{value:.6g}' for value in proof.better.ravel())} is better"
    if proof.is_proven:
        return f"proven: no permitted gain is better by more than 0.1 % ({proof.boxes} boxes)"
    return f"not decided in the time permitted ({proof.boxes} boxes)"


def _describe_loops(loops: Sequence[DesignedLoop]) -> str:
    norms, proven = [loop.gamma for loop in loops], sum(loop.certificate is not None for loop in loops)
    return f"{len(loops)}, of which {proven} certified; gamma {min(norms):.6g} to {max(norms):.6g}, the worst is shown"


def _check_loop(design: SynthesisedDesign, scenario: Scenario) -> Mapping[str, str]:
    """Return what the scenario's own law says of its loop with the design's gain, by heading."""
    control, plant = scenario.control, scenario.plant
    if control is None or plant is None or not isinstance(control.law, CheckedLaw):
        return {}
    return control.law.checks(plant, scenario.coil, control.sample_time or DEFAULT_SAMPLE_TIME, design.gain)
