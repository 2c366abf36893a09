"""Every law of a scenario against the clairvoyant bracket: `python benchmarks/law_comparison.py SCENARIO --out DIR`.

The variants of SCENARIO (its plant, damper and laws, without its effects) on roads B to F and the floors EM1 to EM9 of
ISO 7096, with the damper at 20 and 80 degC. A damper without temperature factors gets those that cost it a third of its
force at 80 degC. Brackets stand in DIR as JSON by road, temperature and settings and are not made again, so that a run
may be stopped and resumed; the laws are simulated anew. Written are `laws.csv`, a row for each law, road and
temperature, and `brackets.csv`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
from pathlib import Path

import numpy as np
import pandas as pd

import seatsim
from controllers.clairvoyant import ClairvoyantBounds, clairvoyant
from seatsim.rig.temperature import TemperatureFactors
from seatsim.scenario.scenario import Scenario
from seatsim.schema.files import write_json
from seatsim.simulation.performance_bounds import measure_distance
from seatsim.simulation.result import Run
from seatsim.simulation.runs import run_many

SPEEDS = {"B": 25.0, "C": 20.0, "D": 15.0, "E": 8.0, "F": 4.0}
"""m/s at which each class of road is driven."""
TEMPERATURES = (20.0, 80.0)
FADING = {"viscous": -0.0067, "stiffness": -0.0067, "yield_force": -0.0067}
WEIGHTS = np.array([12.0, 25.0, 50.0, 90.0, 150.0]) ** 2


def list_floors(duration: float) -> dict[str, dict[str, object]]:
    """Return the excitation of every floor by name."""
    roads = {
        f"road {name}": {"kind": "road", "road_class": name, "speed": speed, "duration": duration}
        for name, speed in SPEEDS.items()
    }
    classes = [f"EM{number}" for number in range(1, 10)]
    return roads | {name: {"kind": "iso7096", "spectral_class": name, "duration": duration} for name in classes}


def load_variants(path: str, excitation: dict[str, object], temperature: float) -> list[Scenario]:
    """Return the variants of a scenario on a floor, without effects, with a damper that fades."""
    settings: dict[str, object] = {"excitation": excitation, "temperature": temperature, "effects": []}
    if seatsim.load(path, settings)[0].damper.factors == TemperatureFactors():
        settings["damper.temperature_factors"] = FADING
    return seatsim.load(path, settings)


def load_bracket(scenario: Scenario, name: str, hold: float, folder: Path) -> ClairvoyantBounds:
    """Return the bracket of a scenario, from its file where that is there."""
    settings = hashlib.sha256(f"{scenario.rig} {hold} {WEIGHTS.tolist()}".encode()).hexdigest()[:12]
    path = folder / f"bracket-{name.replace(' ', '-')}-{settings}.json"
    if not path.exists():
        write_json(path, clairvoyant(scenario, WEIGHTS, hold))
    kept = json.loads(path.read_text(encoding="utf-8"))
    curves = {key: np.array(kept[key]) for key in ("weights", "lower", "acceleration", "travel")}
    return ClairvoyantBounds(**curves, force=np.zeros((len(WEIGHTS), 0)), step=hold)


def show_tables(laws: pd.DataFrame, brackets: pd.DataFrame) -> None:
    """Print the excess over the bound by law and floor, and the brackets."""
    for temperature, part in laws.groupby("temperature"):
        table = 100 * part.pivot(index="law", columns="floor", values="above_bound")[list(part.floor.unique())]
        table.insert(0, "median", table.median(axis=1))
        print(f"excess over the bound at the law's own travel, %, damper at {temperature:g} degC")
        print(table.sort_values("median").to_string(float_format="%.0f"))
    print("the brackets: RMS of least weight and of most, width in %")
    print(brackets.to_string(index=False, float_format="%.2f"))


def main() -> None:
    """Run the study and write its tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", nargs="?", default="quickstart")
    parser.add_argument("--out", type=Path, default=Path("out/law_comparison"))
    parser.add_argument("--duration", type=float, default=20.0, help="s of every floor")
    parser.add_argument("--hold", type=float, default=0.005, help="s over which the ideal damper's force is held")
    parser.add_argument("--only", nargs="*", help="names of floors, such as 'road D' EM1")
    asked = parser.parse_args()
    laws, brackets = [], []
    for floor, excitation in list_floors(asked.duration).items():
        for temperature in TEMPERATURES if not asked.only or floor in asked.only else ():
            variants = load_variants(asked.scenario, excitation, temperature)
            found = load_bracket(variants[0], f"{floor} {temperature:g}", asked.hold, asked.out)
            place = {"floor": floor, "temperature": temperature}
            for scenario, answer in run_many(variants, lambda _: None):
                if isinstance(answer, Run):
                    law = {"law": scenario.label.get("variant", "")}
                    laws.append(place | law | measure_distance(answer, found)._asdict())
                else:
                    print(f"{scenario.title}: {answer}")
            ends = {"aw": found.acceleration, "travel_mm": 1e3 * found.travel, "width_percent": 100 * found.width}
            spans = {f"{end}_{kind}": float(pick(of)) for end, of in ends.items() for kind, pick in _SPAN.items()}
            brackets.append(place | spans)
            print(f"{floor}, {temperature:g} degC: width {spans['width_percent_most']:.1f} % at most", flush=True)
    asked.out.mkdir(parents=True, exist_ok=True)
    tables = {"laws": pd.DataFrame(laws), "brackets": pd.DataFrame(brackets)}
    for name, table in tables.items():
        table.to_csv(asked.out / f"{name}.csv", index=False)
    show_tables(**tables)


_SPAN = {"least": np.min, "most": np.max}

if __name__ == "__main__":
    main()
