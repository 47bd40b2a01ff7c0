"""What `wayword export` writes for agents and for tables, read with the libraries that others use."""

import json

import pytest

SPECIAL = {
    "bert": ("[CLS]", "[SEP]"),
    "xlm": ("<s>", "</s>"),
}
LONGEST = 512


def done(ran):
    assert ran.returncode in (0, 3), ran.stderr
    return ran


@pytest.fixture
def run(cli, tmp_path):
    """A run over two paths in generated houses, with texts of both styles."""
    folder = tmp_path / "run"
    scenes = ["--scan", "house2-3", "--scan", "house2-4"]
    done(cli("generate", "--paths", 2, *scenes, "--style", "r2r", "--style", "reverie", "--out", folder))
    return folder


def records(run):
    return [json.loads(line) for line in (run / "instructions.jsonl").read_text().splitlines()]


def write_records(run, made):
    (run / "instructions.jsonl").write_text("".join(json.dumps(record) + "\n" for record in made))


def on_viewpoints(run, texts):
    """Makes the records of a style those of paths over viewpoints, with these texts."""
    base = next(record for record in records(run) if record["style"] == "r2r")
    made = []
    for number, text in enumerate(texts):
        record = json.loads(json.dumps(base))
        record["path"]["id"] = record["path_id"] = str(number)
        for place, frame in enumerate(record["path"]["frames"]):
            frame["viewpoint"] = f"v{place}"
        record.update(text=text, mentions=[], findings=[])
        made.append(record)
    write_records(run, made)


def make_tokenizer(kind, texts, file):
    """Trains a small vocabulary of the family's kind and saves it."""
    tokenizers = pytest.importorskip("tokenizers", reason="tokenizers is not installed")
    begin, end = SPECIAL[kind]
    if kind == "bert":
        made = tokenizers.Tokenizer(tokenizers.models.WordPiece(unk_token="[UNK]"))
        made.normalizer = tokenizers.normalizers.BertNormalizer(lowercase=True)
        made.pre_tokenizer = tokenizers.pre_tokenizers.BertPreTokenizer()
        trainer = tokenizers.trainers.WordPieceTrainer(
            vocab_size=120, special_tokens=["[PAD]", "[UNK]", begin, end, "[MASK]"], show_progress=False
        )
    else:
        made = tokenizers.Tokenizer(tokenizers.models.Unigram())
        made.normalizer = tokenizers.normalizers.NFKC()
        made.pre_tokenizer = tokenizers.pre_tokenizers.Metaspace()
        trainer = tokenizers.trainers.UnigramTrainer(
            vocab_size=80, special_tokens=[begin, "<pad>", end, "<unk>"], unk_token="<unk>", show_progress=False
        )
    made.train_from_iterator(texts, trainer)
    made.save(str(file))
    return made


TEXTS = [
    "Walk past the sofa, turn left and wait by the lamp.",
    "Géh ins CAFÉ, nach Ångström's Zimmer: naïve façade!",
    "Turn\tright — don't stop at the 2nd door (it's locked)…",
    "上楼 then 🚪 and ﬁnally the end",
    "[SEP] is a word of its own, and so is <s>",
    "walk " * 509,
    "walk " * 511,
    "Go straight on to the lamp. " * 200,
]


@pytest.mark.parametrize("kind", ["bert", "xlm"])
def test_token_ids_are_those_of_the_python_library(cli, run, tmp_path, kind):
    tokenizer = make_tokenizer(kind, TEXTS, tmp_path / "tokenizer.json")
    on_viewpoints(run, TEXTS)
    out = tmp_path / "annotations"
    arguments = ["export", "--run", run, "--style", "r2r", "--format", "duet", "--out", out]
    ran = cli(*arguments, "--tokenizer", tmp_path / "tokenizer.json")
    if "no tokenizers" in ran.stderr:
        pytest.skip("this build of wayword has no tokenizers")
    done(ran)
    (file,) = out.glob("R2R_train_enc*.json")
    assert file.name == {"bert": "R2R_train_enc.json", "xlm": "R2R_train_enc_xlmr.json"}[kind]
    begin, end = (tokenizer.token_to_id(token) for token in SPECIAL[kind])
    encoded = {}
    for item in json.loads(file.read_text()):
        encoded.update(zip(item["instructions"], item["instr_encodings"], strict=True))
    assert set(encoded) == set(TEXTS)
    for text, ids in encoded.items():
        words = tokenizer.encode(text, add_special_tokens=False).ids
        assert ids == [begin, *words[: LONGEST - 2], end]
    assert max(map(len, encoded.values())) == LONGEST


def test_rxr_lines_have_what_the_loader_formats(cli, run, tmp_path):
    make_tokenizer("xlm", TEXTS, tmp_path / "tokenizer.json")
    on_viewpoints(run, TEXTS)
    out = tmp_path / "annotations"
    arguments = ["export", "--run", run, "--style", "r2r", "--format", "duet", "--dataset", "rxr", "--out", out]
    ran = cli(*arguments, "--split", "val_seen", "--tokenizer", tmp_path / "tokenizer.json")
    if "no tokenizers" in ran.stderr:
        pytest.skip("this build of wayword has no tokenizers")
    done(ran)
    lines = (out / "rxr_val_seen_guide_enc_xlmr.jsonl").read_text().splitlines()
    items = [json.loads(line) for line in lines]
    names = {"%d_%d" % (item["path_id"], item["instruction_id"]) for item in items}  # noqa: UP031 (as the loader)
    assert len(names) == len(TEXTS)
    assert all(isinstance(item["path_id"], int) and item["instr_encoding"][:512] for item in items)


def test_a_folder_is_read_by_datasets_without_a_network(cli, run, tmp_path, monkeypatch):
    monkeypatch.setenv("HF_DATASETS_OFFLINE", "1")
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    monkeypatch.setenv("HF_HOME", str(tmp_path / "hf"))
    datasets = pytest.importorskip("datasets", reason="datasets is not installed")
    out = tmp_path / "houses"
    ran = cli("export", "--run", run, "--format", "hf", "--out", out, "--val-share", 0.5)
    if "writes no tables" in ran.stderr:
        pytest.skip("this build of wayword writes no tables")
    done(ran)
    read = datasets.load_dataset(str(out), cache_dir=str(tmp_path / "cache"))
    made = records(run)
    assert set(read) == {"train", "val"}
    rows = [row for split in read.values() for row in split]
    assert sorted(row["text"] for row in rows) == sorted(record["text"] for record in made)
    features = next(iter(read.values())).features
    assert {name: features[name].dtype for name in ("text", "length_m", "ambiguous", "seed", "ends")} == {
        "text": "string",
        "length_m": "float64",
        "ambiguous": "bool",
        "seed": "uint64",
        "ends": "int64",
    }
    assert all(len(row["positions"]) == len(row["headings"]) and len(row["positions"][0]) == 3 for row in rows)
    assert {check["check"] for row in rows for check in row["checks"]} >= {"form", "landmarks", "turns"}


def test_a_table_is_read_by_pyarrow_and_pandas(cli, run, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    file = tmp_path / "houses.parquet"
    ran = cli("export", "--run", run, "--format", "parquet", "--out", file)
    if "writes no tables" in ran.stderr:
        pytest.skip("this build of wayword writes no tables")
    done(ran)
    rows = parquet.read_table(file).to_pylist()
    made = records(run)
    assert len(rows) == len(made)
    for row, record in zip(rows, made, strict=True):
        frames = record["path"]["frames"]
        assert (row["text"], row["style"], row["verdict"]) == (record["text"], record["style"], record["verdict"])
        assert row["positions"] == [frame["pose"]["position"] for frame in frames]
        assert row["headings"] == [frame["pose"]["heading"] for frame in frames]
        assert row["viewpoints"] is None
        checks = [(found["check"], found["verdict"], found.get("reason", "")) for found in record["findings"]]
        assert [tuple(check.values()) for check in row["checks"]] == checks
        assert row["writer"] == record["provenance"]["writer"]
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    table = pandas.read_parquet(file)
    assert len(table) == len(made) and set(table["split"]) == {"train"}
