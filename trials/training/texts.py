"""Makes the training texts of each row of the table, by `wayword generate` and `wayword export`, and by a template and a swap of our own."""

import json
import math
import random
import re
import subprocess
from pathlib import Path

from world import ROOMS, labels_at, read_rooms

HELD_BACK = 10
MIN_WALKS = 50
UNTRAINED_SHARE = 0.08
MISSING = {"YmJkqBEsHnH"}  # its labels do not lie with the others


def split_buildings(train: list[dict], seed: int) -> tuple[list[str], list[str]]:
    """The buildings to train in, and ten others that nobody trains in, drawn from those with at least 50 walks."""
    count: dict[str, int] = {}
    for entry in train:
        count[entry["scan"]] = count.get(entry["scan"], 0) + 1
    held = random.Random(f"held back {seed}").sample(sorted(scan for scan in count if count[scan] >= MIN_WALKS), HELD_BACK)
    return sorted(set(count) - set(held) - MISSING), sorted(held)


def walk_key(entry: dict) -> tuple[str, str, str]:
    """What makes two walks the same walk: building, first and last viewpoint."""
    return entry["scan"], entry["path"][0], entry["path"][-1]


def swap_sides(text: str) -> str:
    """The text with left and right exchanged."""
    swap = {"left": "right", "right": "left", "Left": "Right", "Right": "Left"}
    return re.sub(r"[^\W\d_]+", lambda word: swap.get(word[0], word[0]), text)


class Template:
    """Sentences from labels alone: at each viewpoint one thing that is seen there, without turns, stairs or rooms."""

    def __init__(self, data: Path, turns: bool = False):
        self.data, self.turns, self.graphs, self.rooms = data, turns, {}, {}

    def pose(self, scan: str, viewpoint: str) -> list[float]:
        if scan not in self.graphs:
            graph = json.loads((self.data / f"matterport/connectivity/{scan}_connectivity.json").read_text())
            self.graphs[scan] = {node["image_id"]: node["pose"] for node in graph}
        return self.graphs[scan][viewpoint]

    def turn(self, entry: dict, number: int) -> str:
        """The turn before hop `number`, in words; empty if it is under 30 degrees."""
        places = [self.pose(entry["scan"], viewpoint) for viewpoint in entry["path"]]
        headings = [entry["heading"]] + [math.atan2(b[3] - a[3], b[7] - a[7]) for a, b in zip(places, places[1:])]
        turned = math.degrees(math.remainder(headings[number + 1] - headings[number], 2 * math.pi))
        if abs(turned) < 30:
            return ""
        return "Turn around. " if abs(turned) > 150 else f"Turn {'right' if turned > 0 else 'left'}. "

    def write(self, entry: dict, draws: random.Random) -> str:
        text = ""
        for number, viewpoint in enumerate(entry["path"]):
            if self.turns and number < len(entry["path"]) - 1:
                text += self.turn(entry, number)
            names = sorted({name for _, name, _ in labels_at(self.data, entry["scan"], viewpoint)})
            last = number == len(entry["path"]) - 1
            if names:
                text += f"{'Stop at' if last else 'Walk past'} the {draws.choice(names)}. "
            elif last:
                text += "Stop. "
        return text.strip()

    def write_goal(self, entry: dict, draws: random.Random) -> str:
        """A goal in REVERIE's way: the target's label and its room."""
        seen = labels_at(self.data, entry["scan"], entry["path"][-1])
        name = next((name for object_id, name, _ in seen if object_id == str(entry["objId"])), "thing")
        scan = entry["scan"]
        if scan not in self.rooms:
            self.rooms[scan] = read_rooms(self.data, scan)
        room = ROOMS.get(self.rooms[scan].get(entry["path"][-1], ""), "room")
        return f"{draws.choice(['Go to', 'Find', 'Walk to'])} the {name} in the {room}."


def with_texts(entries: list[dict], write) -> list[dict]:
    """The walks with as many texts of `write` as they have."""
    return [{**entry, "instructions": [write(entry, number) for number in range(len(entry["instructions"]))]} for entry in entries]


class Preparation:
    """The files of one seed in one folder. What is there already is not made again."""

    def __init__(self, data: Path, out: Path, seed: int, wayword: Path, earlier: Path):
        self.data, self.out, self.seed, self.wayword, self.earlier = data, out, seed, wayword, earlier
        out.mkdir(parents=True, exist_ok=True)

    def put(self, name: str, entries: list) -> Path:
        path = self.out / name
        path.with_suffix(".part").write_text(json.dumps(entries))
        path.with_suffix(".part").rename(path)
        return path

    def split(self) -> None:
        """Walks to train on, walks in the same buildings that nobody trains on, and what is walked at the end."""
        train = [entry for entry in self.read("r2r/R2R_train.json") if entry["scan"] not in MISSING]
        trained, held = split_buildings(train, self.seed)
        self.put("scans.json", trained)
        inside = [entry for entry in train if entry["scan"] in trained]
        random.Random(f"untrained {self.seed}").shuffle(inside)
        untrained = round(UNTRAINED_SHARE * len(inside))
        self.put("untrained.json", inside[:untrained])
        self.put("people.json", inside[untrained:])
        self.put("held_back.json", [entry for entry in train if entry["scan"] in held])
        self.put("val_seen.json", [entry for entry in self.read("r2r/R2R_val_seen.json") if entry["scan"] in trained])
        goals = self.read("reverie/REVERIE_train.json")
        self.put("goals_people.json", [entry for entry in goals if entry["scan"] in trained])
        self.put("goals_held_back.json", [entry for entry in goals if entry["scan"] in held])
        self.put("goals_val_seen.json", [entry for entry in self.read("reverie/REVERIE_val_seen.json") if entry["scan"] in trained])

    def read(self, name: str) -> list[dict]:
        path = self.data / name
        return json.loads((path if path.exists() else self.out / name).read_text())

    def generate(self, program: Path, name: str, style: str, *flags: str, texts: int = 3) -> None:
        """A run of the program, exported as a dataset's file."""
        if (self.out / name).exists():
            return
        run = self.out / name.removesuffix(".json")
        where = ["--platform", "matterport", "--data", str(self.data), *flags]
        command = [str(program), "generate", *where, "--style", style, "--per-path", str(texts), "--seed", str(self.seed), "--out", str(run), "--quiet"]
        print(" ".join(command), flush=True)
        done = subprocess.run(command).returncode
        if done not in (0, 3):
            raise SystemExit(f"{command[0]} generate ended with {done}")
        part = self.out / f"{name}.part"
        subprocess.run([str(program), "export", "--run", str(run), "--style", style, "--format", style, "--out", str(part), "--quiet"], check=True)
        part.rename(self.out / name)

    def rows_by_program(self) -> None:
        people = ["--episodes", str(self.out / "people.json")]
        self.generate(self.wayword, "ours.json", "r2r", *people)
        self.generate(self.wayword, "goals_ours.json", "reverie", "--episodes", str(self.out / "goals_people.json"))
        self.generate(self.earlier, "earlier.json", "r2r", *people)

    def new_walks(self, times: int) -> None:
        """Our texts on random walks of the same buildings, `times` as many as people's; none begins and ends as a walk that people described."""
        name = f"new_{times}x.json"
        if (self.out / name).exists():
            return
        wanted = times * len(self.read("people.json"))
        scans = [flag for scan in self.read("scans.json") for flag in ("--scan", scan)]
        self.generate(self.wayword, "new_all.json", "r2r", *scans, "--paths", str(round(1.25 * 10 * len(self.read("people.json")))))
        taken = {walk_key(entry) for file in ("r2r/R2R_train.json", "r2r/R2R_val_seen.json") for entry in self.read(file)}
        new = []
        for entry in self.read("new_all.json"):
            if walk_key(entry) not in taken:
                taken.add(walk_key(entry))
                new.append(entry)
        random.Random(f"new {self.seed}").shuffle(new)
        if len(new) < wanted:
            print(f"{name}: the buildings have {len(new)} new walks, of {wanted}", flush=True)
        self.put(name, new[:wanted])

    def rows_by_rule(self) -> None:
        people, goals, ours = self.read("people.json"), self.read("goals_people.json"), self.read("ours.json")
        bare, turning = Template(self.data), Template(self.data, turns=True)
        draws = lambda entry, number: random.Random(f"{self.seed} {entry.get('id', entry['path_id'])} {number}")
        self.put("template.json", with_texts(people, lambda entry, number: bare.write(entry, draws(entry, number))))
        self.put("template_turns.json", with_texts(people, lambda entry, number: turning.write(entry, draws(entry, number))))
        self.put("goals_template.json", with_texts(goals, lambda entry, number: bare.write_goal(entry, draws(entry, number))))
        self.put("swapped.json", [{**entry, "instructions": [swap_sides(text) for text in entry["instructions"]]} for entry in ours])
        scans = self.read("scans.json")
        half = set(random.Random(f"half {self.seed}").sample(scans, len(scans) // 2))
        self.put("half.json", [entry for entry in ours if entry["scan"] in half] + [entry for entry in people if entry["scan"] not in half])
