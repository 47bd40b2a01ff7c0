"""Makes the texts, trains a follower on each row's, and writes the table: figures with intervals clustered by building, and paired differences."""

import argparse
import filecmp
import json
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from texts import Preparation

DRAWS = 5000
MEASURES = ("success", "spl", "ndtw")
R2R_SETS = ("val_seen", "held_back", "untrained")
PEOPLE_SETS = ("val_seen", "held_back")  # taken together
GOAL_SETS = ("goals_val_seen", "goals_held_back")


@dataclass
class Row:
    """A row of the table: what it is trained on, and how many seeds it gets."""

    name: str
    what: str
    files: tuple[str, ...]
    seeds: int = 1
    share: float = 1.0
    goals: bool = False


ROWS = (
    Row("a", "people's texts", ("people.json",), 3),
    Row("b", "ours on the same walks", ("ours.json",), 3),
    Row("c", "ours by an earlier program", ("earlier.json",)),
    Row("d", "a template of labels", ("template.json",), 3),
    Row("d-turns", "a template of labels and turns", ("template_turns.json",)),
    Row("e", "ours with left and right exchanged", ("swapped.json",), 3),
    Row("f", "people's and ours", ("people.json", "ours.json")),
    Row("g-1x", "people's, and ours on as many new walks", ("people.json", "new_1x.json")),
    Row("g-3x", "people's, and ours on 3 times as many new walks", ("people.json", "new_3x.json")),
    Row("g-10x", "people's, and ours on 10 times as many new walks", ("people.json", "new_10x.json")),
    Row("h", "ours in half of the buildings, people's in the other half", ("half.json",)),
    *(Row(f"{row}-{round(1 / share)}th", f"{what}, 1/{round(1 / share)} of the walks", (file,), share=share)
      for row, what, file in (("a", "people's texts", "people.json"), ("b", "ours", "ours.json")) for share in (1 / 2, 1 / 4, 1 / 8)),
    Row("goals-a", "people's goals", ("goals_people.json",), goals=True),
    Row("goals-b", "our goals", ("goals_ours.json",), goals=True),
    Row("goals-d", "a template of goals", ("goals_template.json",), goals=True),
)


def train_row(args, row: Row, number: int) -> Path:
    """Trains and evaluates, unless that was done already."""
    out = args.out / f"{row.name}.{number}.json"
    if out.exists():
        return out
    if args.unchanged and (args.unchanged / out.name).exists() and all(
        filecmp.cmp(args.out / "texts" / file, args.unchanged / "texts" / file, shallow=False) for file in (*row.files, "scans.json")
    ):
        shutil.copy(args.unchanged / out.name, out)
        return out
    sets = GOAL_SETS if row.goals else R2R_SETS
    command = [
        sys.executable, str(Path(__file__).parent / "train.py"), "--data", str(args.data), "--scans", str(args.out / "texts/scans.json"),
        "--texts", *(str(args.out / "texts" / file) for file in row.files), "--share", str(row.share), "--seed", str(100 * args.seed + number),
        "--updates", str(args.updates), "--threads", str(args.threads), "--out", str(out),
        "--evaluate", *(f"{name}={args.out / 'texts' / name}.json" for name in sets),
    ]
    with open(out.with_suffix(".log"), "w") as log:
        if subprocess.run(command, stdout=log, stderr=subprocess.STDOUT).returncode != 0:
            raise SystemExit(f"{row.name}, seed {number}: training failed, see {out.with_suffix('.log')}")
    print(f"{row.name}, seed {number}: done", flush=True)
    return out


def read_figures(files: list[Path], sets: tuple[str, ...]) -> dict[tuple[str, str], tuple[str, np.ndarray]]:
    """For each item of some sets the building and the figures, as means over the seeds."""
    runs = [{(name, record["item"]): record for name in sets for record in json.loads(file.read_text())[name]} for file in files]
    return {item: (record["scan"], np.mean([[run[item][measure] for measure in MEASURES] for run in runs], axis=0)) for item, record in runs[0].items()}


def by_building(figures: dict[tuple[str, str], tuple[str, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Sums and counts of each building, in the order of their names."""
    scans = sorted({scan for scan, _ in figures.values()})
    place = {scan: number for number, scan in enumerate(scans)}
    total, count = np.zeros((len(scans), len(MEASURES))), np.zeros(len(scans))
    for scan, values in figures.values():
        total[place[scan]] += values
        count[place[scan]] += 1
    return total, count


def draw_means(figures: dict, draws: np.ndarray) -> np.ndarray:
    """The mean of each draw of buildings, for each measure."""
    total, count = by_building(figures)
    return total[draws].sum(1) / count[draws].sum(1)[:, None]


def building_draws(figures: dict) -> np.ndarray:
    """The same draws for all rows, so that differences are paired. The first takes each building once: the estimate itself."""
    count = len({scan for scan, _ in figures.values()})
    return np.vstack([np.arange(count), np.random.default_rng(0).integers(count, size=(DRAWS, count))])


def in_words(means: np.ndarray, scale: float = 100) -> str:
    """The estimate and its 95 % interval."""
    low, high = np.percentile(means[1:], [2.5, 97.5])
    return f"{scale * means[0]:.1f} [{scale * low:.1f}, {scale * high:.1f}]"


def write_table(files: dict[str, list[Path]]) -> str:
    """The table in Markdown."""
    lines = []
    for sets in (*((name,) for name in R2R_SETS), PEOPLE_SETS, *((name,) for name in GOAL_SETS)):
        rows = [row for row in ROWS if row.goals == (sets[0] in GOAL_SETS) and row.name in files]
        if not rows:
            continue
        figures = {row.name: read_figures(files[row.name], sets) for row in rows}
        first = next(iter(figures.values()))
        draws = building_draws(first)
        means = {row: draw_means(values, draws) for row, values in figures.items()}
        lines += [f"### {' and '.join(sets)}: {len(first)} texts in {len(draws[0])} buildings", "", "| row | trained on | seeds | SR | SPL | nDTW | SR minus that of (a) |", "|---|---|---|---|---|---|---|"]
        base = means.get("a", means.get("goals-a"))
        for row in rows:
            mean = means[row.name]
            less = in_words(mean[:, 0] - base[:, 0]) if base is not None else ""
            lines.append(f"| {row.name} | {row.what} | {len(files[row.name])} | " + " | ".join(in_words(mean[:, at]) for at in range(3)) + f" | {less} |")
        prefix = "goals-" if sets[0] in GOAL_SETS else ""
        for bottom in ("d", "d-turns"):
            a, b, d = (means.get(prefix + row) for row in ("a", "b", bottom))
            if a is not None and b is not None and d is not None:
                share = [(b[:, at] - d[:, at]) / (a[:, at] - d[:, at]) for at in range(3)]
                lines += ["", f"Of what ({prefix}a) gains over ({prefix}{bottom}), ({prefix}b) reaches: SR {in_words(share[0])} %, SPL {in_words(share[1])} %, nDTW {in_words(share[2])} %."]
        lines.append("")
    return "\n".join(lines)


def main():
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--data", type=Path, required=True, help="folder with matterport/, r2r/ and reverie/ (docs/DATA.md)")
    asked.add_argument("--wayword", type=Path, required=True, help="the program")
    asked.add_argument("--earlier", type=Path, required=True, help="the program of commit cea7c07d, for row (c)")
    asked.add_argument("--out", type=Path, required=True, help="folder for texts, runs and table; the same command goes on")
    asked.add_argument("--unchanged", type=Path, help="folder of an earlier table with this seed: trainings on the same texts are taken from it")
    asked.add_argument("--seed", type=int, default=0, help="of everything: held-back buildings, texts, training")
    asked.add_argument("--rows", nargs="+", help="only these rows, by name")
    asked.add_argument("--updates", type=int, default=600)
    asked.add_argument("--parallel", type=int, default=2, help="trainings at a time")
    asked.add_argument("--threads", type=int, default=1, help="threads of each")
    args = asked.parse_args()
    rows = [row for row in ROWS if not args.rows or row.name in args.rows]
    made = Preparation(args.data, args.out / "texts", args.seed, args.wayword, args.earlier)
    if not (args.out / "texts/scans.json").exists():
        made.split()
    made.rows_by_program()
    made.rows_by_rule()
    for times in (1, 3, 10):
        if any(f"new_{times}x.json" in row.files for row in rows):
            made.new_walks(times)
    jobs = [(row, number) for number in range(3) for row in rows if number < row.seeds]
    with ThreadPoolExecutor(args.parallel) as pool:
        list(pool.map(lambda job: train_row(args, *job), jobs))
    table = write_table({row.name: [args.out / f"{row.name}.{number}.json" for number in range(row.seeds)] for row in rows})
    (args.out / "table.md").write_text(table)
    print(table)


if __name__ == "__main__":
    main()
