"""Figures of trajectories, and where texts lead, in a small building that is made here."""

import json
import math

import numpy as np
import pytest

import wayword
from wayword import errors

NODES = {
    f"{name}": (2.0 * x, 2.0 * y) for name, x, y in [("a", 0, 0), ("b", 1, 0), ("c", 2, 0), ("d", 2, 1), ("e", 3, 0)]
}
EDGES = [("a", "b"), ("b", "c"), ("c", "d"), ("c", "e")]


@pytest.fixture(scope="module")
def building(tmp_path_factory):
    """The data folder of a building with five viewpoints, as Matterport's simulator has it."""
    folder = tmp_path_factory.mktemp("data")
    (folder / "connectivity").mkdir()
    names = list(NODES)
    joined = {frozenset(edge) for edge in EDGES}

    def pose(x, y):
        return [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, 1.5, 0, 0, 0, 1]

    rows = [
        {
            "image_id": name,
            "pose": pose(*NODES[name]),
            "included": True,
            "visible": [True] * len(names),
            "unobstructed": [frozenset((name, other)) in joined for other in names],
            "height": 1.5,
        }
        for name in names
    ]
    (folder / "connectivity" / "yard_connectivity.json").write_text(json.dumps(rows))
    (folder / "connectivity" / "scans.txt").write_text("yard\n")
    return folder


@pytest.fixture(scope="module")
def episodes():
    texts = ["Go straight and turn left.", "Walk ahead, then turn left and stop."]
    return [{"scan": "yard", "path_id": 7, "path": ["a", "b", "c", "d"], "heading": math.pi / 2, "instructions": texts}]


@pytest.fixture(scope="module")
def evaluator(building, episodes):
    return wayword.Evaluator(episodes, platform="matterport", data=building)


def test_a_right_walk_and_a_wrong_one(evaluator):
    scores = evaluator.score({"7_0": ["a", "b", "c", "d"], "7_1": ["a", "b"]})
    assert len(evaluator) == 2 and len(scores) == 2 and scores.rule == "distance"
    assert scores["sr"] == 0.5 and scores["tl_m"] == pytest.approx(4.0) and scores["ne_m"] == pytest.approx(2.0)
    assert scores.values("ndtw")[0] == pytest.approx(1.0) and scores.values("ndtw")[1] < 1
    assert np.isnan(scores.values("rgs")).all() and "rgs" not in scores.figures
    low = scores.interval("sr", resamples=200)
    assert low.low <= low.mean <= low.high and (low.trajectories, low.paths) == (2, 1)


@pytest.mark.parametrize(
    "walk",
    [
        ["a", "b", "c"],
        [["a", 0.0, 0.1], ["b", 1.0, 0.0], ["c", 2, 0]],
        [("a", 0.0, 0.0), ("b", 0.0, 0.0), ("c", 0.0, 0.0)],
        [["a"], ["b", "c"]],
        (["a", "b", "c"]),
    ],
)
def test_all_forms_of_a_trajectory_mean_the_same(evaluator, walk, tmp_path):
    both = [{"instr_id": "7_0", "trajectory": walk}, {"instr_id": "7_1", "trajectory": ["a", "b", "c"]}]
    scores = evaluator.score(both)
    assert scores.values("ne_m").tolist() == [2.0, 2.0]
    file = tmp_path / "submission.json"
    file.write_text(json.dumps(both))
    assert evaluator.score(file).figures == scores.figures


def test_every_problem_is_told_and_nothing_is_scored(evaluator):
    wrong = [
        {"instr_id": "7_0", "trajectory": ["b", "z"]},
        {"instr_id": "9_0", "trajectory": ["a"]},
        {"instr_id": "7_0", "trajectory": ["a"]},
    ]
    with pytest.raises(errors.SubmissionError) as told:
        evaluator.score(wrong)
    problems = told.value.problems
    assert [name for name, _ in problems] == ["9_0", "7_0", "7_0", "7_0", "7_1"] and told.value.missing == 1
    words = " ".join(problem for _, problem in problems)
    assert "starts at b" in words and "viewpoint z" in words and "another trajectory" in words
    assert evaluator.score({"7_1": ["a"]}, partial=True).instructions == ["7_1"]
    for bad in ([{"trajectory": ["a"]}], [{"instr_id": "7_0"}]):
        with pytest.raises(errors.SubmissionError, match="it has no"):
            evaluator.score(bad)
    for bad in ([3], {"7_0": [3]}, {"7_0": 3}, [{"instr_id": 7, "trajectory": ["a"]}]):
        with pytest.raises(errors.SubmissionError, match="trajectory 0"):
            evaluator.score(bad)
    with pytest.raises(errors.InputError, match="there is no figure"):
        evaluator.score({"7_1": ["a"]}, partial=True).interval("speed")
    with pytest.raises(errors.InputError, match="visible"):
        evaluator.score({"7_1": ["a"]}, partial=True, rule="visible")


def test_figures_are_those_of_the_command(evaluator, building, episodes, cli, tmp_path):
    submission = [
        {"instr_id": f"7_{n}", "trajectory": [[v, 0, 0] for v in walk]} for n, walk in enumerate(["abce", "ab"])
    ]
    for name, content in (("episodes", episodes), ("submission", submission)):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    at = ["--episodes", tmp_path / "episodes.json", "--platform", "matterport", "--data", building]
    done = cli("evaluate", tmp_path / "submission.json", *at, "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    told = {**report["rules"][0]["figures"], **report["whatever_the_rule"]}
    scores = evaluator.score(submission)
    for figure, mean in scores.figures.items():
        assert mean == pytest.approx(told[wayword.scoring.METRICS[figure]]["mean"], abs=1e-12)
        assert scores.interval(figure).low == pytest.approx(told[wayword.scoring.METRICS[figure]]["low"], abs=1e-12)
    assert scores.to_pandas().shape == (2, 12)


def test_a_text_is_followed_to_where_it_leads(building):
    follower = wayword.Follower(platform="matterport", data=building)
    assert follower.scenes == ["yard"] and follower.viewpoints("yard")["d"][:2] == pytest.approx((4, 2))
    at = dict(scene="yard", start="a", heading_rad=math.pi / 2)
    left = follower.follow("Walk straight ahead. Turn left and stop.", **at)
    assert left[0].viewpoints[-1] == "d" and 0 < left[0].share <= 1
    assert [walk.share for walk in left] == sorted((walk.share for walk in left), reverse=True)
    assert len(follower.follow("Go straight.", most=2, **at)) == 2
    for text, kind in (("", errors.InputError), ("Biegen Sie links ab.", errors.InputError)):
        with pytest.raises(kind, match="followed"):
            follower.follow(text, **at)
    with pytest.raises(errors.PlatformError):
        follower.follow("Go straight.", scene="yard", start="z", heading_rad=0.0)
    with pytest.raises(errors.PlatformError):
        follower.follow("Go straight.", scene="moon", start="a", heading_rad=0.0)
    with pytest.raises(errors.InputError):
        follower.follow("Go straight.", scene="yard", start="a", heading_rad=math.nan)
