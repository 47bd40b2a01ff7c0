"""Makes sheets for people who read texts beside the pictures of their walks.

    wayword generate --platform house --paths 24 --seed 1 --out runs/read
    python trials/readers/sheets.py runs/read --style r2r --out sheets --seed 1

Writes into OUT for each walk `NN.png` (the pictures ahead, in order, each with its number and the turn before the next one) and
`NN.txt` (the text, and nothing else of the run), in an order drawn from the seed, and `key.json`, which names the run's record of
each sheet. Readers get the folder without `key.json`. Needs Pillow.
"""

import argparse
import json
import math
import pathlib
import random

from PIL import Image, ImageDraw

COLUMNS = 4
WIDTH_PX, HEIGHT_PX, CAPTION_PX = 400, 300, 22
SLIGHT_DEG, FULL_DEG, AROUND_DEG = 25, 55, 150


def read_records(run: pathlib.Path, style: str) -> list[dict]:
    """The records of a run in one style."""
    with open(run / "instructions.jsonl", encoding="utf-8") as lines:
        records = [json.loads(line) for line in lines]
    return [record for record in records if record["style"] == style]


def turn_words(frames: list[dict], at: int) -> str:
    """How the walk turns and climbs from a frame to the next one."""
    if at + 1 >= len(frames):
        return "end"
    here, after = frames[at]["pose"], frames[at + 1]["pose"]
    degrees = math.degrees(after["heading"] - here["heading"])
    degrees = (degrees + 180) % 360 - 180
    side = "right" if degrees > 0 else "left"
    size = abs(degrees)
    if size < SLIGHT_DEG:
        turn = "straight on"
    elif size < FULL_DEG:
        turn = f"slightly {side}"
    elif size < AROUND_DEG:
        turn = side
    else:
        turn = "around"
    rise_m = after["position"][2] - here["position"][2]
    climb = ", up" if rise_m > 0.1 else ", down" if rise_m < -0.1 else ""
    return f"then {turn}{climb}"


def draw_sheet(run: pathlib.Path, record: dict) -> Image.Image:
    """All pictures of a walk on one sheet."""
    frames = record["path"]["frames"]
    rows = math.ceil(len(frames) / COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * WIDTH_PX, rows * (HEIGHT_PX + CAPTION_PX)), "white")
    pen = ImageDraw.Draw(sheet)
    for at in range(len(frames)):
        left, top = at % COLUMNS * WIDTH_PX, at // COLUMNS * (HEIGHT_PX + CAPTION_PX)
        file = run / "frames" / f"{record['path_id']}_{at}.jpg"
        if file.exists():
            with Image.open(file) as picture:
                sheet.paste(picture.resize((WIDTH_PX, HEIGHT_PX)), (left, top + CAPTION_PX))
        pen.text((left + 4, top + 4), f"{at}: {turn_words(frames, at)}", fill="black")
    return sheet


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=pathlib.Path)
    parser.add_argument("--style", default="r2r")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--seed", type=int, default=0)
    flags = parser.parse_args()
    records = read_records(flags.run, flags.style)
    random.Random(flags.seed).shuffle(records)
    flags.out.mkdir(parents=True, exist_ok=True)
    key = {}
    for number, record in enumerate(records):
        name = f"{number:02}"
        draw_sheet(flags.run, record).save(flags.out / f"{name}.png")
        (flags.out / f"{name}.txt").write_text(record["text"] + "\n", encoding="utf-8")
        key[name] = record["path_id"]
    (flags.out / "key.json").write_text(json.dumps(key, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
