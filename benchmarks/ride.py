"""One setting for all floors, temperatures and drivers: `python benchmarks/ride.py --data DIR --bounds 1 --out OUT`.

Cells are roads of class C and D at two speeds, the floors EM1, EM2 and EM5 of ISO 7096 and measured ones where DIR
holds them, each with the damper at 20, 50 and 80 degC and with 45, 80 and 110 kg on the seat. The variants of
`quickstart.yaml` and `ride.yaml` run in every cell. Their figure is the driver's Wk RMS over that of the best viscous
damper of that floor and driver, which is found anew in every cell. For the worst cells of each variant the clairvoyant
bound follows: what no damper of the seat comes below at the variant's own travel. Written is `OUT/ride.csv`, a row for
each run.
"""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from ruamel.yaml import YAML

import seatsim
from seatsim.schema.errors import InputError
from seatsim.simulation.performance_bounds import compute_performance_bounds, measure_distance

HERE = Path(__file__).parent
TEMPERATURES, MASSES = (20.0, 50.0, 80.0), (45.0, 80.0, 110.0)
"""degC; kg."""
DAMPINGS = np.geomspace(150.0, 2500.0, 15)
"""N s/m of the viscous dampers of which a cell takes the best."""
SECONDS, BOUNDED = 60.0, 15.0
RIDE = "driver_acceleration_weighted"
Settings = dict[str, Any]
QUICKSTART, OURS = (
    YAML(typ="safe").load(path) for path in (HERE.parent / "scenarios" / "quickstart.yaml", HERE / "ride.yaml")
)
VARIANTS: dict[str, Settings] = {**QUICKSTART["variants"], **OURS}
ALONE: Settings = {"sweep": {}, "checks": {}}
"""What leaves the quickstart its variants alone."""


def list_floors(data: Path | None) -> dict[str, Settings]:
    """Return the excitation of every floor by name."""
    floors: dict[str, Settings] = {
        f"road {name}, {speed:g} m/s": {"kind": "road", "road_class": name, "speed": speed}
        for name, speed in itertools.product("CD", (12.0, 20.0))
    }
    floors |= {name: {"kind": "iso7096", "spectral_class": name} for name in ("EM1", "EM2", "EM5")}
    for path in sorted(data.glob("bus_floor/*.csv.gz")) if data else ():
        floors[path.name.partition("_")[0]] = {
            "kind": "table", "path": str(path), "time_column": "time_s", "column": "acc_z_m_s2", "start": 5.0,
        }  # fmt: skip
    if data:
        road = str(data / "roads" / "profile_1.csv.gz")
        floors["measured road, 15 m/s"] = {
            "kind": "table", "path": road, "distance_column": "distance_m", "column": "elevation_m", "speed": 15.0,
            "repeat": "mirror",
        }  # fmt: skip
    return {name: floor | {"duration": SECONDS} for name, floor in floors.items()}


def find_best_viscous(cell: Settings) -> float:
    """Return the least Wk RMS in m/s^2 of a driver over the viscous dampers."""
    viscous = VARIANTS["passive, best"]
    parameters = viscous["damper.parameters"]
    dampers = {f"{c:.0f}": viscous | {"damper.parameters": parameters | {"c_a": float(c)}} for c in DAMPINGS}
    return min(run.metrics[RIDE].value for run in seatsim.run("quickstart", ALONE | cell | {"variants": dampers}).runs)


def run_cells(floors: dict[str, Settings], seed: int) -> pd.DataFrame:
    """Return a row for each run."""
    rows = []
    for (floor, excitation), mass in itertools.product(floors.items(), MASSES):
        cell: Settings = {"seed": seed, "excitation": excitation, "plant.driver_mass": mass}
        best = find_best_viscous(cell)
        print(f"{floor}, {mass:g} kg: best viscous damper {best:.3f} m/s^2", flush=True)
        for temperature in TEMPERATURES:
            for run in seatsim.run(
                "quickstart", ALONE | cell | {"temperature": temperature, "variants": VARIANTS}
            ).runs:
                ride, peak = (run.metrics[name].value for name in (RIDE, "suspension_displacement_peak"))
                variant = run.scenario.label["variant"]
                rows.append([variant, floor, mass, temperature, ride, best, ride / best, 1e3 * peak])
    columns = ["variant", "floor", "mass", "temperature", "ride", "viscous", "ratio", "peak_mm"]
    return pd.DataFrame(rows, columns=columns)


def measure_excess(variant: str, settings: Settings) -> float:
    """Return the Wk RMS of a variant over the bound at its travel, in `BOUNDED` s of a cell without end stops."""
    floor = settings["excitation"] | {"duration": BOUNDED}
    rig = ALONE | settings | {"excitation": floor, "effects": [], "variants": {variant: VARIANTS[variant]}}
    [run] = seatsim.run("quickstart", rig).runs
    [(_, bounds)] = compute_performance_bounds([run], lambda _: None)
    return np.nan if isinstance(bounds, InputError) else 1.0 + measure_distance(run, bounds).above_bound


def main() -> None:
    """Run the cells, print the figures of each variant, and the bounds of its worst cells."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder with `bus_floor` and `roads`")
    parser.add_argument("--only", nargs="*", help="names of floors, such as EM1")
    parser.add_argument("--seed", type=int, default=11, help="of the random floors")
    parser.add_argument("--bounds", type=int, default=0, help="worst cells of each variant that get their bound")
    parser.add_argument("--out", type=Path, default=Path("out/ride"))
    asked = parser.parse_args()
    floors = {name: floor for name, floor in list_floors(asked.data).items() if not asked.only or name in asked.only}
    table = run_cells(floors, asked.seed)
    asked.out.mkdir(parents=True, exist_ok=True)
    table.to_csv(asked.out / "ride.csv", index=False)
    for name, part in table.groupby("variant", sort=False):
        mean, peak = np.exp(np.log(part.ratio).mean()), part.peak_mm.max()
        print(f"{name:18} mean {mean:.3f}, worst {part.ratio.max():.3f}, peak travel {peak:.1f} mm", flush=True)
        for row in part.nlargest(asked.bounds, "ratio").to_dict("records"):
            settings = {"seed": asked.seed, "excitation": floors[row["floor"]], "plant.driver_mass": row["mass"]}
            excess = measure_excess(row["variant"], settings | {"temperature": row["temperature"]})
            where = f"{row['floor']}, {row['mass']:g} kg, {row['temperature']:g} degC"
            print(f"{'':18} {where}: {row['ratio']:.3f}, no damper below {row['ratio'] / excess:.3f}", flush=True)


if __name__ == "__main__":
    main()
