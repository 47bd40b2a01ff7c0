"""Worlds in Python: in this process, and as a child."""

import json
import pathlib
import sys
import threading

import pytest
from halls import THINGS, Hall

import wayword
from wayword import errors


class Broken(Hall):
    def observe(self, scene, look):
        raise ValueError("the lens is broken")


def test_a_world_of_this_process_is_written_about(tmp_path):
    run = wayword.generate(tmp_path / "run", platform=Hall(), paths=4, hops=(2, 6), metres=(3, 14), seed=2)
    assert len(run) >= 3 and {text.path.scene for text in run} == {"hall"}
    assert any(name in text.text for text in run for name, _ in THINGS)
    assert run.platform["data"] == "python:Hall"
    again = wayword.generate(tmp_path / "run", platform=Hall(), paths=4, hops=(2, 6), metres=(3, 14), seed=2)
    assert again.instructions == run.instructions
    assert wayword.check(run).failed == 0


def test_the_same_world_as_a_child_gives_the_same_texts(tmp_path, cli):
    paths = dict(paths=3, hops=(2, 6), metres=(3, 14), seed=2, style="r2r")
    here = wayword.generate(tmp_path / "here", platform=Hall(), **paths)
    script = tmp_path / "world.py"
    folders = [str(pathlib.Path(__file__).parent), str(pathlib.Path(__file__).parents[1])]
    script.write_text(
        f"import sys\nsys.path[:0] = {folders!r}\n"
        "from halls import Hall\nfrom wayword.platform import serve\nserve(Hall)\n"
    )
    world = tmp_path / "world.json"
    world.write_text(json.dumps({"command": [sys.executable, "world.py"]}))
    flags = ["--paths", 3, "--hops", "2..6", "--metres", "3..14", "--seed", 2, "--style", "r2r"]
    done = cli("generate", "--platform", "process", "--data", world, *flags, "--out", tmp_path / "child")
    assert done.returncode in (0, 3), done.stderr
    child = wayword.load_run(tmp_path / "child")
    assert [text.text for text in child] == [text.text for text in here]
    inside = wayword.generate(tmp_path / "third", platform="process", data=world, **paths)
    assert [text.text for text in inside] == [text.text for text in here]


def test_a_world_that_fails_is_told_and_the_next_call_works(tmp_path):
    run = wayword.generate(tmp_path / "broken", platform=Broken(), paths=2, hops=(2, 6), metres=(3, 14))
    assert len(run) == 0 and len(run.errors) == 2 and "the lens is broken" in run.errors[0].reason
    with pytest.raises(errors.PlatformError, match="hall"):
        wayword.generate(tmp_path / "none", platform=Hall(), scan="attic", paths=1)
    with pytest.raises(errors.InputError, match="Hall"):
        wayword.generate(tmp_path / "gone", platform="process", data="python:Hall", paths=1)
    assert (
        len(wayword.generate(tmp_path / "well", platform=Hall(), paths=1, hops=(2, 6), metres=(3, 14), style="r2r"))
        == 1
    )


def test_a_world_takes_no_data(tmp_path):
    with pytest.raises(errors.InputError, match="takes no data"):
        wayword.generate(tmp_path / "run", platform=Hall(), data=tmp_path)


def test_calls_of_several_threads_wait_for_each_other(tmp_path):
    made = {}

    def make(seed):
        paths = dict(paths=1, hops=(2, 6), metres=(3, 14), style="r2r")
        made[seed] = wayword.generate(tmp_path / str(seed), platform=Hall(), seed=seed, progress=False, **paths)

    threads = [threading.Thread(target=make, args=(seed,)) for seed in (1, 2, 3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(made) == [1, 2, 3] and all(len(run) == 1 for run in made.values())


class Nested(Hall):
    def observe(self, scene, look):
        wayword.command("platforms")
        return super().observe(scene, look)


def test_a_call_inside_a_call_is_refused_and_does_not_wait_for_itself(tmp_path):
    paths = dict(paths=1, hops=(2, 6), metres=(3, 14))
    run = wayword.generate(tmp_path / "world", platform=Nested(), **paths)
    assert "cannot be called from" in run.errors[0].reason
    with pytest.raises(errors.InputError, match="cannot be called from"):
        nested = lambda *told: wayword.command("platforms")  # noqa: E731
        wayword.generate(tmp_path / "progress", platform=Hall(), progress=nested, **paths)
    assert wayword.command("platforms")


def test_what_progress_raises_comes_through_and_children_start_again(tmp_path):
    def fails(done, total, text):
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        wayword.generate(tmp_path / "run", platform=Hall(), paths=1, hops=(2, 6), metres=(3, 14), progress=fails)
    assert wayword.Follower(platform=Hall()).scenes == ["hall"]


def test_a_settings_file_counts_where_no_argument_is_given(tmp_path):
    config = tmp_path / "run.toml"
    config.write_text('style = ["reverie"]\npaths = 1\nmetres = "3..14"\nhops = "2..6"\n')
    run = wayword.generate(tmp_path / "run", platform=Hall(), config=config)
    assert {text.style for text in run} == {"reverie"}
    paths = dict(paths=1, hops=(2, 6), metres=(3, 14))
    both = wayword.generate(tmp_path / "both", platform=Hall(), style=("r2r", "reverie"), **paths)
    assert {text.style for text in both} == {"r2r", "reverie"}
