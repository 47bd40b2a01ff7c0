"""Exports walks in the layouts that training code reads, reads them with the genuine loaders, and compares.

python loaders.py --clones CLONES --wayword WAYWORD --out OUT [NAME...]   (README.md)
"""

import argparse
import contextlib
import io
import json
import os
import subprocess
import sys
from collections import namedtuple
from pathlib import Path

import numpy as np
from PIL import Image

import internnav
import navila
import pretraining
import rxrce
import streamvln
import uninavid

HERE = Path(__file__).resolve().parent
ONE_LEVEL = 3.0  # mean difference of a decoded picture, of 255
HALF_MM = 0.00051  # the steps' depths are in millimetres
MOST_MM = 6553.5  # in tenths of a millimetre, 16 bits hold no more
Loader = namedtuple("Loader", "name layout run steps repository read")
Walk = namedtuple("Walk", "text actions pictures goals")

# `steps` is the folder of the run from which Wayword packs the layout.
LOADERS = [
    Loader("streamvln", "streamvln", "houses", "steps", "InternRobotics/StreamVLN", streamvln.read),
    Loader("internnav", "internnav", "houses", "steps", "InternRobotics/InternNav", internnav.read),
    Loader("internnav-n1", "internnav-n1", "houses", "steps", "InternRobotics/InternNav", internnav.read_n1),
    Loader("navila", "navila", "houses", "steps", "AnjieCheng/NaVILA", navila.read),
    Loader("navila-speaker", "navila", "houses", "steps", "AnjieCheng/NaVILA", navila.read_speaker),
    Loader("uninavid", "uninavid", "houses", "steps_30deg", "jzhzhang/Uni-NaVid", uninavid.read),
    Loader("navid", "uninavid", "houses", "steps_30deg", "jzhzhang/NaVid-VLN-CE", uninavid.read_navid),
    Loader("lerobot", "lerobot", "houses", "steps", "huggingface/lerobot", None),
    Loader("rxrce", "rxrce", "houses", "steps_30deg", "jacobkrantz/VLN-CE", rxrce.read),
    Loader("rxrce-val-seen", "rxrce", "val_seen", None, "jacobkrantz/VLN-CE", rxrce.read),
    Loader("duet", "duet-pretrain", "val_seen", None, "cshizhe/VLN-DUET", pretraining.read),
    Loader("scalevln", "duet-pretrain", "val_seen", None, "wz0919/ScaleVLN", pretraining.read),
]


def lines(file):
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]


def generate(args, run, platform):
    """A run of 20 walks with two texts each."""
    folder = args.out / run
    if not (folder / "instructions.jsonl").exists():
        command = [args.wayword, "generate", *platform, "--style", "r2r", "--per-path", "2", "--out", folder]
        subprocess.run([*command, "--quiet"], check=True, stdout=subprocess.DEVNULL)


def export(args, loader):
    """The folder of a split in the layout."""
    run, folder = args.out / loader.run, args.out / f"{loader.layout}-{loader.run}"
    wanted = [(folder, [loader.layout])]
    if loader.layout == "duet-pretrain":
        wanted = [(folder, [loader.layout, "--tokenizer", args.tokenizer])]
    elif loader.layout == "rxrce" and loader.steps:  # its actions are compared with these steps
        wanted += [(run / loader.steps, ["steps", "--turn-deg", "30"])]
    for out, form in wanted:
        if not out.exists():
            command = [args.wayword, "export", "--run", run, "--out", out, "--quiet", "--format", *form]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    split = folder / ("val_seen" if loader.run == "val_seen" else "train")
    return split if split.exists() else folder


def make_tokenizer(run, file):
    """A tokenizer of BERT's form that knows the words of a run: its special tokens have BERT's numbers."""
    from tokenizers import Tokenizer, models, normalizers, pre_tokenizers, processors

    bert = [normalizers.BertNormalizer(lowercase=True), pre_tokenizers.BertPreTokenizer()]
    texts = [bert[0].normalize_str(line["text"]) for line in lines(run / "instructions.jsonl")]
    words = sorted({word for text in texts for word, _ in bert[1].pre_tokenize_str(text)})
    special = {0: "[PAD]", 100: "[UNK]", 101: "[CLS]", 102: "[SEP]", 103: "[MASK]"}
    names = [special.get(i, f"[unused{i}]") for i in range(1996)] + words
    tokenizer = Tokenizer(models.WordPiece({name: i for i, name in enumerate(names)}, unk_token="[UNK]"))
    tokenizer.normalizer, tokenizer.pre_tokenizer = bert
    tokenizer.post_processor = processors.BertProcessing(("[SEP]", 102), ("[CLS]", 101))
    tokenizer.save(str(file))


def expected(args, loader):
    """What a loader must find: the walks of the steps, or the records of the run."""
    if loader.steps:
        return expected_of_steps(args.out / loader.run / loader.steps)
    records = lines(args.out / loader.run / "instructions.jsonl")
    if loader.layout == "rxrce":
        return [Walk(r["text"], None, None, None) for r in records]
    from tokenizers import Tokenizer

    tokenizer = Tokenizer.from_file(str(args.tokenizer))
    found = []
    for r in records:
        frames = r["path"]["frames"]
        places = [f["viewpoint"] for f in frames]
        if len(set(places)) == len(places):  # the others are left out
            actions = [r["path"]["scene"], frames[0]["pose"]["heading"], *places]
            found.append(Walk(tokenizer.encode(r["text"]).ids, actions, None, None))
    return found


def expected_of_steps(steps):
    goals, found = {}, []
    pitched = steps / "cameras/125cm_30deg/pictures.jsonl"
    for camera in lines(pitched) if pitched.exists() else []:
        goals[camera["trajectory_id"]] = [g and (g[1], *g[0]) for g in camera["pixel_goals"]]
    for walk in lines(steps / "trajectories.jsonl"):
        name = walk["trajectory_id"]
        pictures = lambda folder, step, name=name: next((steps / "cameras" / folder / name).glob(f"{step:04d}.*"))
        for instruction in walk["instructions"]:
            found.append(Walk(instruction["text"], walk["actions"], pictures, goals.get(name)))
    return found


def same_picture(content, file):
    if isinstance(content, Path):
        return content.read_bytes() == file.read_bytes()
    truth = np.asarray(Image.open(file), dtype=float)
    if file.suffix == ".png":
        truth[truth > MOST_MM] = 0  # unknown, and beyond what the loader takes
        return np.abs(content - truth / 1000).max() < HALF_MM
    return np.abs(content - truth).mean() < ONE_LEVEL


def compare(found, walks, fix):
    """Every text must be found once, with its walk's actions and pictures. Returns counts and differences."""
    differences, left, texts, actions, pictures = [], list(walks), 0, 0, set()
    for row in found["rows"]:
        same = [w for w in left if fix(w.text) == row["text"]]
        texts += bool(same)
        if "length" in row:
            same = [w for w in same if len(w.actions) == row["length"]]
        else:
            same = [w for w in same if w.actions == row["actions"]]
            actions += bool(same) and row["actions"] is not None
        if not same:
            differences.append(f"no walk has this text with these actions: {row['text']} {row.get('actions')}")
            continue
        walk = same[0]
        left.remove(walk)
        if "goals" in row and row["goals"] != walk.goals:
            differences.append(f"{row['text']}: other pixel goals")
        for folder, step, content in row.get("pictures", []):
            file = walk.pictures(folder, step)
            if same_picture(content, file):
                pictures.add(file)
            else:
                differences.append(f"{row['text']}: step {step} has another picture than {file}")
    differences += [f"not found: {walk.text}" for walk in left]
    return texts, actions, found.get("pictures", len(pictures)), differences


def commit(clone):
    if (clone / ".commit").exists():
        return (clone / ".commit").read_text().strip()
    command = ["git", "-C", clone, "rev-parse", "HEAD"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def read_lerobot(args, clone, data, steps):
    """In the Python that has what LeRobot needs; the code is the clone's."""
    command = [args.lerobot_python, HERE / "lerobot_v3.py", data, steps]
    environment = {**os.environ, "PYTHONPATH": str(clone / "src")}
    result = subprocess.run(command, capture_output=True, text=True, env=environment)
    if result.returncode:
        raise RuntimeError(result.stderr[-2000:])
    return json.loads(result.stdout.splitlines()[-1])


def try_loader(args, loader):
    """A line of the result, or a text that says why the loader was left out."""
    clone = args.clones / loader.repository.replace("/", "__")
    if loader.run == "val_seen" and not args.val_seen:
        return "it needs --val-seen and --data"
    if loader.name == "lerobot" and not args.lerobot_python:
        return "it needs --lerobot-python"
    if not clone.is_dir():
        return f"no folder {clone}"
    data = export(args, loader)
    if loader.name == "lerobot":
        found = read_lerobot(args, clone, data, args.out / loader.run / loader.steps)
    else:
        more = [next(args.data.glob("**/connectivity"))] if loader.layout == "duet-pretrain" else []
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):  # loaders print
            found = loader.read(clone, data, *more)
    walks = expected(args, loader)
    fix = navila.as_loader_writes if loader.name == "navila" else lambda text: text
    texts, actions, pictures, differences = compare(found, walks, fix)
    errors = found["errors"] + differences
    return {
        "loader": f"{loader.repository}@{commit(clone)}",
        "ran": found["ran"],
        "samples": found["samples"],
        "texts": f"{texts} of {len(walks)}",
        "actions": f"{actions} of {len(walks)}" if actions else "none",
        "pictures": pictures,
        "equal": not errors,
        "errors": errors,
        "found": found.get("found", {}),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clones", type=Path, required=True, help="folder with OWNER__NAME for each repository")
    parser.add_argument("--wayword", type=Path, required=True, help="the program")
    parser.add_argument("--lerobot-python", type=Path, help="a Python that has lerobot")
    parser.add_argument("--val-seen", type=Path, help="R2R_val_seen.json")
    parser.add_argument("--data", type=Path, help="Matterport3D's folder, for --val-seen")
    parser.add_argument("--tokenizer", type=Path, help="tokenizer.json of BERT; else one is made of the run's words")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("names", metavar="NAME", nargs="*", help="only these loaders")
    args = parser.parse_args()
    if unknown := set(args.names) - {loader.name for loader in LOADERS}:
        parser.error(f"no loader is named {', '.join(sorted(unknown))}")
    if args.val_seen and not args.data:
        parser.error("--val-seen needs --data")
    args.out.mkdir(parents=True, exist_ok=True)
    generate(args, "houses", ["--paths", "20", "--houses", "5", "--seed", "46"])
    if args.val_seen:
        episodes = ["--episodes", args.val_seen, "--limit", "20"]
        generate(args, "val_seen", ["--platform", "matterport", "--data", args.data, *episodes])
        if not args.tokenizer:
            args.tokenizer = args.out / "tokenizer.json"
            make_tokenizer(args.out / "val_seen", args.tokenizer)
    results = []
    for loader in LOADERS:
        if args.names and loader.name not in args.names:
            continue
        try:
            result = try_loader(args, loader)
        except Exception as error:
            result = {"equal": False, "errors": [f"{type(error).__name__}: {error}"]}
        if isinstance(result, str):
            print(f"{loader.name}: left out: {result}")
            results.append({"name": loader.name, "left_out": result})
            continue
        results.append({"name": loader.name, **result})
        shown = {**result, "ran": ", ".join(result.get("ran", [])), "equal": "yes" if result["equal"] else "no"}
        print(f"{loader.name}: " + "; ".join(f"{k} {v}" for k, v in shown.items() if k not in ("errors", "found")))
        for error in result["errors"][:5]:
            print(f"  {error}")
    (args.out / "loaders.json").write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    sys.exit(any(not r.get("equal", True) for r in results))


if __name__ == "__main__":
    main()
