"""Tune every law of `scenarios/laws.yaml` by one rule, and print the keys that it finds.

    python benchmarks/tune_laws.py [LAW...]

The rule: on a road of another seed, over a grid of keys, the least Wk-weighted acceleration of the driver among the
settings whose travel stays within the buffers; where none does, the setting with the least travel.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator, Mapping, Sequence

import seatsim

SEED = 2
BUFFER = 0.045
"""m of travel at which the buffers begin."""
Keys = dict[str, object]
"""Keys of a controller in a scenario."""
CURRENTS = [0.2, 0.4, 0.7, 1.0]
QUADRATIC = {"travel": [20.0, 40.0, 80.0, 160.0], "force": [0.007, 0.01, 0.015]}
GRIDS: Mapping[str, Mapping[str, Sequence[object]]] = {
    "constant": {"current": [0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0]},
    "on_off_skyhook": {"on": CURRENTS},
    "skyhook": {"damping": [500.0, 1000.0, 2000.0, 3000.0, 5000.0, 8000.0]},
    "no_jerk_skyhook": {"gain": [2e3, 5e3, 1e4, 2e4, 4e4, 8e4]},
    "groundhook": {"damping": [250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0]},
    "hybrid": {"damping": [1000.0, 2000.0, 4000.0, 8000.0], "share": [0.5, 0.55, 0.6, 0.7, 0.8]},
    "acceleration_driven": {"on": [0.1, *CURRENTS]},
    "skyhook_add": {"crossover": [1.0, 1.5, 2.0, 3.0, 4.0], "on": CURRENTS},
    "power_driven": {"share": [0.1, 0.3, 0.5, 0.7, 1.0]},
    "pid": {
        "proportional": [1000.0, 2000.0, 4000.0],
        "integral": [0.0, 1000.0, 3000.0, 6000.0],
        "derivative": [0.0, 5.0, 20.0],
    },
    "sliding_mode": {"damping": [1000.0, 2000.0, 4000.0], "reaching": [0.5, 2.0, 5.0], "boundary": [0.05, 0.1, 0.2]},
    "lqr": QUADRATIC,
    "lqg": QUADRATIC,
    "clipped_optimal": QUADRATIC | {"on": [0.4, 0.7, 1.0]},
    "static_output_feedback": {"gain": [[k1, k2] for k1 in (-3000.0, -2000.0, 0.0) for k2 in (600.0, 1000.0, 1500.0)]},
    "mpc": {"travel": [40.0, 60.0, 80.0, 120.0], "force": [0.0005, 0.002]},
}


def main() -> None:
    """Tune the laws named on the command line, or all of them."""
    parser = argparse.ArgumentParser(description="tune every law of scenarios/laws.yaml by one rule")
    parser.add_argument("laws", nargs="*", metavar="LAW", help=f"of {', '.join(GRIDS)}; all where none is named")
    for law in parser.parse_args().laws or GRIDS:
        keys, (comfort, travel) = tune(law)
        print(f"{law}: {keys}  # {comfort:.3f} m/s^2, {1e3 * travel:.1f} mm", flush=True)


def tune(law: str) -> tuple[Keys, tuple[float, float]]:
    """Return the keys of a law that the rule chooses, with weighted acceleration in m/s^2 and peak travel in m."""
    found = [(keys, score(law, keys)) for keys in grid_points(law)]
    within = [(keys, figures) for keys, figures in found if figures[1] <= BUFFER]
    return min(within, key=lambda one: one[1][0]) if within else min(found, key=lambda one: one[1][1])


def grid_points(law: str) -> Iterator[Keys]:
    """Yield the points of a law's grid as keys of a controller."""
    grid = GRIDS[law]
    for values in itertools.product(*grid.values()):
        keys = dict(zip(grid, values, strict=True))
        weights = {name: keys.pop(name) for name in QUADRATIC if name in keys}
        yield keys | ({"weights": weights} if weights else {})


def score(law: str, keys: Keys) -> tuple[float, float]:
    """Return weighted acceleration in m/s^2 and peak travel in m of one run."""
    source = seatsim.load("laws")[0].source
    assert source is not None
    stated = source.data["controller"]
    assert isinstance(stated, dict)
    controller = {key: stated[key] for key in ("sample_time", "sensors")} | {"law": law} | keys
    metrics = seatsim.run("laws", {"variants": {}, "seed": SEED, "controller": controller}).runs[0].metrics
    return metrics["driver_acceleration_weighted"].value, metrics["suspension_displacement_peak"].value


if __name__ == "__main__":
    main()
