"""Which words and parts of people's texts go with walks that the follower of (a) finds and that of (b) does not. Only texts of the training buildings that
nobody trained on are looked at, and only what holds in both halves of these buildings is listed."""

import argparse
import json
import math
from collections import Counter
from pathlib import Path

import numpy as np

from world import words_of

MIN_TEXTS = 8


def features_of(text: str) -> set[str]:
    """Runs of one to three words, and the shape of the text."""
    words = words_of(text)
    runs = {" ".join(words[first : first + length]) for length in (1, 2, 3) for first in range(len(words) - length + 1)}
    sentences = sum(1 for part in text.split(".") if part.strip())
    return runs | {f"<{min(sentences, 5)} sentences>", f"<{10 * (len(words) // 10)} words or more>"}


def share_found(files: list[Path], name: str) -> dict[str, float]:
    """How many of the seeds find each item."""
    runs = [{record["item"]: record["success"] for record in json.loads(file.read_text())[name]} for file in files]
    return {item: float(np.mean([run[item] for run in runs])) for item in runs[0]}


def standard_score(feature: str, lost: Counter, kept: Counter) -> float:
    """How far the shares of two groups of texts that have a feature differ, in standard errors."""
    lost_texts, kept_texts = lost["<texts>"], kept["<texts>"]
    share = (lost[feature] + kept[feature]) / (lost_texts + kept_texts)
    error = math.sqrt(share * (1 - share) * (1 / lost_texts + 1 / kept_texts))
    return (lost[feature] / lost_texts - kept[feature] / kept_texts) / error if error > 0 else 0.0


def main():
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("folder", type=Path, help="the folder of table.py")
    asked.add_argument("--set", default="untrained")
    asked.add_argument("--show", type=int, default=60)
    args = asked.parse_args()
    entries = json.loads((args.folder / "texts" / f"{args.set}.json").read_text())
    texts = {f"{entry['path_id']}_{number}": (entry["scan"], text) for entry in entries for number, text in enumerate(entry["instructions"])}
    found = {row: share_found(sorted(args.folder.glob(f"{row}.[0-9].json")), args.set) for row in ("a", "b")}
    scans = sorted({scan for scan, _ in texts.values()})
    halves = [set(scans[0::2]), set(scans[1::2])]
    counts = {}
    for half, inside in enumerate(halves):
        for group in ("lost", "kept"):
            counts[half, group] = Counter()
        for item, (scan, text) in texts.items():
            if scan not in inside or found["a"][item] <= 0.5:
                continue
            group = "kept" if found["b"][item] > 0.5 else "lost"
            counts[half, group].update(features_of(text) | {"<texts>"})
    usage = {row: Counter() for row in ("people", "ours")}
    for row in usage:
        written = json.loads((args.folder / "texts" / f"{row}.json").read_text())
        for entry in written:
            for text in entry["instructions"]:
                usage[row].update(features_of(text) | {"<texts>"})
    for half in (0, 1):
        lost, kept = (counts[half, group]["<texts>"] for group in ("lost", "kept"))
        print(f"half {half + 1} of the buildings: of the texts that (a) finds, (b) loses {lost} and finds {kept}")
    listed = []
    for feature in set(counts[0, "lost"]) | set(counts[0, "kept"]):
        together = [counts[half, "lost"][feature] + counts[half, "kept"][feature] for half in (0, 1)]
        if feature == "<texts>" or min(together) < MIN_TEXTS:
            continue
        scores = [standard_score(feature, counts[half, "lost"], counts[half, "kept"]) for half in (0, 1)]
        if scores[0] * scores[1] > 0:
            listed.append((sum(scores) / math.sqrt(2), feature, scores, together))
    print("standard score (both halves together; each) | words | texts with them | share of people's training texts | share of ours")
    for way in (1, -1):
        print("found by (a) alone:" if way > 0 else "found by both:")
        for score, feature, scores, together in sorted(listed, key=lambda row: -way * row[0])[: args.show]:
            shares = [100 * usage[row][feature] / usage[row]["<texts>"] for row in ("people", "ours")]
            print(f"{score:5.1f} ({scores[0]:4.1f} {scores[1]:4.1f}) | {feature} | {sum(together)} | {shares[0]:.1f} % | {shares[1]:.1f} %")


if __name__ == "__main__":
    main()
