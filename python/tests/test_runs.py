"""Runs: making, loading, showing and checking them."""

import json
import pathlib
import re

import numpy as np
import pytest
from halls import Hall

import wayword
from wayword import errors


def test_a_run_is_made_and_loaded_with_shapes_and_units(houses):
    assert len(houses) == 4 and houses.summary["passed"] + houses.summary["unverified"] == 4
    first = houses[0]
    assert first.style == "r2r" and first.platform == "house" and len(first.text.split()) > 5
    assert first.path.positions.shape == (len(first.path.frames), 3)
    assert first.path.headings_rad.shape == (len(first.path.frames),)
    hops = np.linalg.norm(np.diff(first.path.positions, axis=0), axis=1)
    assert first.path.length_m == pytest.approx(hops.sum()) and 5 <= first.path.length_m <= 20
    assert len(first.captions) == len(first.path.frames) and first.provenance["answerer"] == "labels"
    text = first.text.encode()
    for mention in first.mentions:
        assert text[mention.span[0] : mention.span[1]].decode().strip() and mention.frame < len(first.path.frames)
    again = wayword.load_run(houses.folder)
    assert again.instructions == houses.instructions and again.platform == {"platform": "house"}


def test_the_same_call_goes_on_and_changes_nothing(houses):
    before = (houses.folder / "instructions.jsonl").read_bytes()
    said = []
    again = wayword.generate(
        houses.folder, paths=2, seed=3, style=["r2r", "reverie"], progress=lambda *told: said.append(told)
    )
    assert (houses.folder / "instructions.jsonl").read_bytes() == before and len(again) == 4


def test_progress_is_told_and_ends_with_all_items(tmp_path):
    told = []
    paths = dict(paths=2, hops=(2, 6), metres=(3, 14), progress=lambda done, total, text: told.append((done, total)))
    wayword.generate(tmp_path / "run", platform=Hall(), **paths)
    assert told[-1] == (2, 2) and [done for done, _ in told] == sorted(done for done, _ in told)


def test_pandas_and_datasets_have_a_row_for_each_text(houses):
    pytest.importorskip("pandas")
    frame = houses.to_pandas()
    assert len(frame) == 4 and list(frame.columns) == list(wayword.run.COLUMNS)
    assert set(frame["style"]) == {"r2r", "reverie"} and frame["length_m"].between(5, 20).all()
    pytest.importorskip("datasets")
    dataset = houses.to_datasets()
    assert len(dataset) == 4 and dataset[0]["text"] == houses[0].text and len(dataset[0]["positions"][0]) == 3


def test_the_parts_of_each_text_cover_its_path(houses):
    aligned = wayword.align(houses)
    assert [text.text for text in aligned] == [one.text for one in houses.instructions]
    ways = [(text, one) for text, one in zip(aligned, houses.instructions, strict=True) if text.parts]
    assert ways, "no text was aligned"
    for text, one in ways:
        assert text.parts == one.parts
        frames = [part.frames for part in text.parts]
        assert frames[0][0] == 0 and frames[-1][1] == len(one.path.frames) - 1
        assert all(before[1] == after[0] for before, after in zip(frames, frames[1:], strict=False))
        assert all(0 < part.confidence <= 1 + 1e-9 for part in text.parts)
        first = text.parts[0].span
        assert text.text.encode()[first[0] : first[1]].decode().strip()


def test_a_missing_package_is_named_with_the_way_to_get_it(houses, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(errors.MissingExtraError, match=r"pip install 'wayword\[pandas\]'"):
        houses.to_pandas()


def test_cards_show_frames_and_escape_every_text(houses):
    card = houses[0]._repr_html_()
    assert card.count("data:image/jpeg;base64,") == min(12, len(houses[0].path.frames))
    hostile = wayword.Instruction(
        text="<script>alert(1)</script>",
        style='"><img src=x onerror=alert(1)>',
        verdict="fail",
        platform="house",
        path=wayword.run.Path("../../etc/passwd", "<b>", houses[0].path.frames),
        captions=("</figcaption><script>",) * 20,
        folder=houses.folder,
    )
    card = hostile._repr_html_()
    assert not re.search(r"<(img|/figcaption><)", card.replace("</figcaption></figure>", ""))
    assert "<script" not in card and "onerror=alert(1)>" not in card and "base64" not in card
    assert str(len(houses.instructions)) in houses._repr_html_()


def test_a_picture_is_never_read_from_elsewhere(houses, tmp_path):
    secret = houses.folder / "frames" / "link_0.jpg"
    outside = tmp_path / "secret.jpg"
    outside.write_bytes(b"\xff\xd8\xffsecret")
    secret.symlink_to(outside)
    try:
        assert wayword.notebook.picture_of(houses.folder, "link", 0) is None
        assert wayword.notebook.picture_of(houses.folder, "../frames/link", 0) is None
        assert wayword.notebook.picture_of(houses.folder, houses[0].path.id, 0).startswith(b"\xff\xd8\xff")
    finally:
        secret.unlink()


def test_a_run_is_checked_on_its_own_platform_and_wrong_texts_fail(houses):
    checks = wayword.check(houses)
    assert (checks.passed, checks.failed) == (houses.summary["passed"], 0) and checks.checked_against == ("labels",)
    lines = (houses.folder / "instructions.jsonl").read_text().splitlines()
    records = [json.loads(line) for line in lines]
    for record in records:
        record["text"] = "Walk past the elephant and stop at the swimming pool."
        record["mentions"] = record["findings"] = []
    wrong = houses.folder.parent / "wrong.jsonl"
    wrong.write_text("".join(json.dumps(record) + "\n" for record in records[:1]))
    checks = wayword.check(wrong, platform="house", world="closed")
    assert checks.failed == 1 and any("elephant" in finding.reason for finding in checks.not_passed[0].findings)


def test_similarity_of_a_run_with_itself_is_one(houses):
    said = wayword.similarity(houses, houses, style="r2r")
    assert said["figure"]["mean"] == pytest.approx(1.0) and said["encoder"] == "words"


def test_a_run_is_exported_to_a_format_of_the_field(houses, tmp_path):
    written = wayword.export(houses, tmp_path / "out.jsonl", format="wayword", style="r2r")
    assert written["instructions"] == 2 and len((tmp_path / "out.jsonl").read_text().splitlines()) == 2


@pytest.mark.parametrize(
    "call, kind, where, hint",
    [
        (lambda at: wayword.load_run(at), errors.FileError, "", "out"),
        (lambda at: wayword.generate(at / "run", platform="nowhere"), errors.InputError, None, "help"),
        (lambda at: wayword.generate(at / "run", style="--dry-run"), errors.InputError, None, "help"),
        (lambda at: wayword.generate(at / "run", colour="red"), errors.InputError, None, "help"),
        (lambda at: wayword.generate(at / "run", style="nowhere.toml"), errors.FileError, "nowhere.toml", "spelling"),
        (lambda at: wayword.generate(at / "run", platform="matterport", data=at), errors.PlatformError, "", None),
        (lambda at: wayword.check(at / "none.json", platform="house"), errors.FileError, "none.json", "spelling"),
        (lambda at: wayword.check([{"path_id": 1}], platform="house"), errors.FormatError, "texts.json", None),
        (lambda at: wayword.check(["Turn left."], platform="house"), errors.InputError, None, "R2R"),
        (lambda at: wayword.generate(at / "run", platform=object()), errors.InputError, None, "wayword.Platform"),
    ],
)
def test_errors_say_what_where_and_what_to_do(call, kind, where, hint, tmp_path):
    with pytest.raises(kind) as told:
        call(tmp_path)
    error = told.value
    assert isinstance(error, wayword.WaywordError) and error.what and error.what in str(error)
    assert where is None or (error.where is not None and where in error.where)
    assert hint is None or (error.hint is not None and hint in error.hint)
    assert not (tmp_path / "run").exists()


def test_lines_of_other_versions_and_broken_lines_are_refused_with_their_place(houses, tmp_path):
    copy = tmp_path / "run"
    copy.mkdir()
    for name in ("config.toml", "walks.jsonl", "instructions.jsonl"):
        (copy / name).write_bytes((houses.folder / name).read_bytes())
    lines = (copy / "instructions.jsonl").read_text().splitlines(keepends=True)
    (copy / "instructions.jsonl").write_text(lines[0] + lines[1].replace("wayword/1", "wayword/9"))
    with pytest.raises(errors.FormatError, match="wayword/9") as told:
        wayword.load_run(copy)
    assert told.value.where.endswith("instructions.jsonl: line 2")
    (copy / "instructions.jsonl").write_text(lines[0] + '{"format": "wayword/1"}\n')
    with pytest.raises(errors.FormatError, match="line 2"):
        wayword.load_run(copy)
    config = (copy / "config.toml").read_text()
    (copy / "config.toml").write_text(config.replace("wayword-run/1", "wayword-run/2"))
    with pytest.raises(errors.FormatError, match="wayword-run/2") as told:
        wayword.load_run(copy)
    assert "version that wrote it" in told.value.hint
    (copy / "config.toml").write_text(config)
    # Other separators of lines may stand in a text.
    record = {**json.loads(lines[1]), "text": "Turn left.\u2028Stop.\x85", "mentions": [], "findings": []}
    (copy / "instructions.jsonl").write_text(lines[0] + json.dumps(record, ensure_ascii=False) + "\n")
    assert wayword.load_run(copy)[1].text == record["text"]
    # A run that is being written ends in half a line.
    (copy / "instructions.jsonl").write_text(lines[0] + lines[1][:40])
    assert len(wayword.load_run(copy)) == 1


def test_any_other_command_gives_its_result():
    names = [platform["name"] for platform in wayword.command("platforms")]
    assert "house" in names and "process" in names


def test_every_public_name_is_there_and_described():
    for name in wayword.__all__:
        assert name == "__version__" or getattr(wayword, name).__doc__, name
    assert wayword.__version__ in (pathlib.Path(__file__).parents[2] / "Cargo.toml").read_text()
    with pytest.raises(AttributeError):
        _ = wayword.nothing
