"""Weighted acceleration and doses of seatsim beside two other implementations, for each weighting of ISO 8041-1.

phonometry (https://github.com/jmrplens/phonometry; for Python 3.13 by its metadata, but 3.3.0 runs on 3.11) where it
is installed:

    pip install --no-deps --ignore-requires-python phonometry && python benchmarks/comfort_peers.py

and always scipy's bilinear transform of the analog sections at 32 times the sample rate, written for this comparison.
"""

from __future__ import annotations

import importlib
import warnings

import numpy as np
from scipy import signal

from seatsim.metrics.comfort import dose
from seatsim.metrics.spine import spinal_dose, spine_response
from seatsim.metrics.weighting import WEIGHTINGS, sections, weight
from seatsim.schema.arrays import Array

RATE, SECONDS, OVERSAMPLED = 500.0, 120.0, 32


def main() -> None:
    """Print the largest relative differences of a_w, VDV and MTVV, and fail above half a percent."""
    record = make_record()
    peers = {"oversampled bilinear": weigh_oversampled}
    try:
        vibration = importlib.import_module("phonometry.vibration")
    except ImportError:
        print("phonometry is not installed: compared with the oversampled filter alone")
    else:
        peers["phonometry"] = lambda x, name: np.asarray(vibration.apply_weighting(x, RATE, name))
        spine = abs(spinal_dose(spine_response(record, RATE)) / vibration.acceleration_dose(record, RATE) - 1)
        print(f"phonometry  ISO 2631-5  difference of the dose {spine:.1e}")
        assert spine < 1e-9
    worst = 0.0
    for peer, weigh in peers.items():
        for name in WEIGHTINGS.keys() - {"Wh"}:
            ours, theirs = dose(weight(record, RATE, name), RATE), dose(weigh(record, name), RATE)
            off = [abs(a / b - 1) for a, b in zip(ours, theirs, strict=True)]
            worst = max(worst, *off)
            print(f"{peer:22} {name}  largest difference of a dose figure {1e2 * max(off):.4f} %")
    print(f"largest of all: {1e2 * worst:.4f} %")
    assert worst < 5e-3


def make_record() -> Array:
    """Return band-limited random acceleration with shocks, in m/s^2; it rises from rest and ends at rest."""
    rng = np.random.default_rng(3)
    x = rng.normal(size=int(SECONDS * RATE))
    x[int(15 * RATE) :: int(20 * RATE)] += 40.0
    x *= signal.windows.tukey(len(x), 0.2)
    low = signal.butter(8, 80.0, fs=RATE, output="sos")
    return np.asarray(signal.sosfiltfilt(low, x))


def weigh_oversampled(x: Array, name: str) -> Array:
    """Return the record weighted by recursive filters at many times its rate."""
    fine = signal.resample(np.concatenate([x, np.zeros_like(x)]), 2 * len(x) * OVERSAMPLED)
    for section in sections(name):
        b, a = (coefficients[::-1] for coefficients in section)
        fine = signal.lfilter(*signal.bilinear(b, a, OVERSAMPLED * RATE), fine)
    return np.asarray(fine[::OVERSAMPLED][: len(x)])


if __name__ == "__main__":
    warnings.simplefilter("ignore", DeprecationWarning)
    main()
