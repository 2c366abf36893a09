"""Tune every law of `scenarios/laws.yaml` by one rule, and print the keys that it finds.

    python benchmarks/tune_laws.py [LAW...]

The rule: on a road of another seed, over a grid of keys, the least Wk-weighted acceleration of the driver among the
settings whose travel stays within the buffers; where none does, the setting with the least travel.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ruamel.yaml import YAML

import seatsim

SEED = 2
BUFFER = 0.045
"""m of travel at which the buffers begin."""
Keys = dict[str, object]
"""Keys of a controller in a scenario."""
WEIGHTS = ("travel", "force")
"""Keys that are weights of a law's criterion."""
GRIDS: Mapping[str, Mapping[str, Sequence[object]]] = YAML(typ="safe").load(Path(__file__).with_suffix(".yaml"))


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
        weights = {name: keys.pop(name) for name in WEIGHTS if name in keys}
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
