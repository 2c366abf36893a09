"""One setting for all floors, temperatures and drivers: `python benchmarks/ride.py --data DIR --out OUT`.

Cells are roads of class C and D at two speeds, the floors EM1, EM2 and EM5 of ISO 7096 and measured ones where DIR
holds them, each with the damper at 20, 50 and 80 degC and with 45, 80 and 110 kg on the seat. The variants of
`quickstart.yaml` and `ride.yaml` run in every cell. Their figure is the driver's Wk RMS over that of the best viscous
damper of that floor and driver, which is found anew in every cell. With `--tuned` a gain on five
measures is tuned on the very draw of every cell, which no law with one gain can do better than. Written is
`OUT/ride.csv`, a row for each run.
"""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path
from typing import Any

import cma
import numpy as np
import pandas as pd
from ruamel.yaml import YAML
from scipy.stats import gmean

import seatsim
from seatsim.schema.arrays import Array

HERE = Path(__file__).parent
TEMPERATURES, MASSES = (20.0, 50.0, 80.0), (45.0, 80.0, 110.0)
"""degC; kg."""
DAMPINGS = np.geomspace(150.0, 2500.0, 15)
"""N s/m of the viscous dampers of which a cell takes the best."""
SECONDS = 60.0
RIDE = "driver_acceleration_weighted"
Settings = dict[str, Any]
QUICKSTART, RIDE_FILE = (
    YAML(typ="safe").load(path) for path in (HERE.parent / "scenarios" / "quickstart.yaml", HERE / "ride.yaml")
)
VARIANTS: dict[str, Settings] = QUICKSTART["variants"] | RIDE_FILE["variants"]
ALONE: Settings = {"sweep": {}, "checks": {}}
"""What leaves the quickstart its variants alone."""
GENERATIONS, TRIALS = 24, 10
"""Of a search for the gain of a cell, and gains that are tried in each."""


def list_floors(data: Path | None) -> dict[str, Settings]:
    """Return the excitation of every floor by name, measured ones where their folder is given."""
    floors: dict[str, Settings] = dict(RIDE_FILE["floors"])
    for name, floor in (RIDE_FILE["measured"] if data else {}).items():
        floors[name] = floor | {"kind": "table", "path": str(data / floor["path"])}
    return {name: floor | {"duration": SECONDS} for name, floor in floors.items()}


def find_best_viscous(cell: Settings) -> float:
    """Return the least Wk RMS in m/s^2 of a driver over the viscous dampers."""
    viscous = VARIANTS["passive, best"]
    parameters = viscous["damper.parameters"]
    dampers = {f"{c:.0f}": viscous | {"damper.parameters": parameters | {"c_a": float(c)}} for c in DAMPINGS}
    return min(run.metrics[RIDE].value for run in seatsim.run("quickstart", ALONE | cell | {"variants": dampers}).runs)


def tune_gain(settings: Settings) -> Settings:
    """Return the variant whose fixed gain has the least Wk RMS in a cell, by CMA-ES."""
    controller, spread = RIDE_FILE["tuned"]["controller"], RIDE_FILE["tuned"]["spread"]
    search = cma.CMAEvolutionStrategy(np.zeros(len(spread)), 1.0, {"popsize": TRIALS, "seed": 3, "verbose": -9})

    def state(trial: Array) -> Settings:
        return {"controller": controller | {"gain": (trial * spread).tolist()}}

    for _ in range(GENERATIONS):
        trials = search.ask()
        variants = {str(number): state(trial) for number, trial in enumerate(trials)}
        runs = seatsim.run("quickstart", settings | {"variants": variants}).runs
        search.tell(trials, [run.metrics[RIDE].value for run in runs])
    return state(search.result.xbest)


def run_cells(floors: dict[str, Settings], seed: int, tuned: bool) -> pd.DataFrame:
    """Return a row for each run."""
    rows = []
    for (floor, excitation), mass in itertools.product(floors.items(), MASSES):
        cell: Settings = {"seed": seed, "excitation": excitation, "plant.driver_mass": mass}
        best = find_best_viscous(cell)
        print(f"{floor}, {mass:g} kg: best viscous damper {best:.3f} m/s^2", flush=True)
        for temperature in TEMPERATURES:
            alone = ALONE | cell | {"temperature": temperature}
            settings = alone | {"variants": VARIANTS | ({"gain of the cell": tune_gain(alone)} if tuned else {})}
            for run in seatsim.run("quickstart", settings).runs:
                ride, peak = (run.metrics[name].value for name in (RIDE, "suspension_displacement_peak"))
                variant = run.scenario.label["variant"]
                rows.append([variant, floor, mass, temperature, ride, best, ride / best, 1e3 * peak])
    columns = ["variant", "floor", "mass", "temperature", "ride", "viscous", "ratio", "peak_mm"]
    return pd.DataFrame(rows, columns=columns)


def main() -> None:
    """Run the cells and print the figures of each variant."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder with `bus_floor` and `roads`")
    parser.add_argument("--only", nargs="*", help="names of floors, such as EM1")
    parser.add_argument("--seed", type=int, default=11, help="of the random floors")
    parser.add_argument("--tuned", action="store_true", help="tune a gain in every cell, a quarter of a minute each")
    parser.add_argument("--out", type=Path, default=Path("out/ride"))
    asked = parser.parse_args()
    floors = {name: floor for name, floor in list_floors(asked.data).items() if not asked.only or name in asked.only}
    table = run_cells(floors, asked.seed, asked.tuned)
    asked.out.mkdir(parents=True, exist_ok=True)
    table.to_csv(asked.out / "ride.csv", index=False)
    for name, part in table.groupby("variant", sort=False):
        text = f"{name:18} mean {gmean(part.ratio):.3f}, worst {part.ratio.max():.3f}"
        text += f", peak travel {part.peak_mm.max():.1f} mm"
        print(text, flush=True)


if __name__ == "__main__":
    main()
