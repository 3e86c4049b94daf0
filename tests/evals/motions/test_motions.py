"""The map of motions: distances by hand, what does not count, and the whole study to its plot, the same bytes every
time."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from garmentbench.errors import UserError
from garmentbench.evals.experiment import finished_rows
from garmentbench.evals.motions import study as motions
from garmentbench.evals.motions.distribution import _upright, embed, nearest_cm, poses
from garmentbench.evals.motions.table import APART, POINTS
from garmentbench.evals.report import make_report
from garmentbench.evals.run import write_results
from garmentbench.scenes.presets import PRESETS
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.jobs import Failure

SMOKE = PRESETS["smoke"]
KEPT = ("tshirt-armspace-75", "tshirt-dance-latin", "tshirt-armspace-60", "tshirt-jump")


def test_distance_from_the_nearest_pose_by_hand():
    """Two seeds. The first pose is one of the others; the second is 3 and 5 cm from the nearer one.

    4 on average, 2 of both.
    """
    others = np.zeros((2, 2, 3))
    others[1, :, 2] = 1.0
    points = others.copy()
    points[1, 0, 0] += 0.03
    points[1, 1, 1] += 0.05
    assert nearest_cm(points, others) == pytest.approx(2.0)
    assert nearest_cm(others, others) == 0.0


def test_place_and_heading_do_not_count_and_height_does():
    rest = np.random.default_rng(0).normal(size=(20, 3))
    turn = Rotation.from_euler("z", 70, degrees=True)
    moved = turn.apply(rest) + [5.0, -2.0, 0.3]
    centred = rest - rest.mean(axis=0) * [1, 1, 0]
    np.testing.assert_allclose(_upright(moved[None], rest)[0], centred + [0.0, 0.0, 0.3], atol=1e-12)


def test_a_turned_scene_has_the_same_poses():
    plain = load_scene("tshirt-armspace-90")
    placed = replace(plain, motion=replace(plain.motion, turn=90.0, translate=(1000.0, 0.0, 0.0)))
    np.testing.assert_allclose(poses(placed, SMOKE), poses(plain, SMOKE), atol=1e-6)


def test_groups_that_are_far_apart_stay_apart_and_nothing_is_left_to_chance():
    chance = np.random.default_rng(0)
    groups = [chance.normal(size=(25, 4, 3)) * 0.1 + 10 * k for k in range(3)]
    plane = embed(np.concatenate(groups))
    np.testing.assert_array_equal(plane, embed(np.concatenate(groups)))
    means = plane.reshape(3, 25, 2).mean(axis=1)
    within = np.linalg.norm(plane.reshape(3, 25, 2) - means[:, None], axis=-1).max()
    between = np.linalg.norm(means[:, None] - means[None], axis=-1)[~np.eye(3, dtype=bool)].min()
    assert between > within


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """The study of a few scenes, really run: the folder of runs and reports, its run, its rows."""
    with pytest.MonkeyPatch.context() as patch:
        root = tmp_path_factory.mktemp("motions")
        patch.chdir(root)
        patch.setattr(motions, "choose_scenes", lambda words: [load_scene(name) for name in KEPT])
        made = motions.distribute(SMOKE)
        rows = motions.STUDY.work(SMOKE, 1).rows({motions.KEY: made})
        write_results(root / "reports" / "smoke" / "results.csv", rows)
        yield root, made, rows


def test_rows_say_how_far_each_motion_is_from_those_trained_on(study):
    _, made, rows = study
    apart = {(row.motion, row.metric.removeprefix(APART)): row.value for row in rows}
    assert apart["armspace-75", "armspace-75"] == apart["dance-latin", "dance-latin"] == 0
    assert apart["armspace-60", "armspace-75"] < apart["armspace-60", "dance-latin"]
    assert {row.run_id for row in rows} == {made} and len(rows) == 2 * len(KEPT)


def test_a_finished_study_is_kept_and_not_run_again(study, monkeypatch):
    _, made, rows = study
    monkeypatch.setattr(motions, "embed", None)
    assert motions.distribute(SMOKE) == made
    assert finished_rows(motions.STUDY, SMOKE) == rows


def test_the_report_has_table_and_map_and_is_remade_byte_for_byte(study):
    root, made, _ = study
    folder = root / "reports" / "smoke"
    make_report("smoke", root / "reports", root / "runs")
    before = {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    make_report("smoke", root / "reports", root / "runs")
    assert before == {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    table = (folder / "tables" / "motions.md").read_text().splitlines()
    assert [line.split("|")[1].strip() for line in table if line.startswith("| ")][1:] == [
        "---",
        "armspace-75",
        "dance-latin",
        "jump",
        "armspace-60",
    ]
    svg = before["motions.svg"].decode()
    assert svg.startswith("<?xml") and 'src="plots/motions.svg"' in (folder / "index.html").read_text()
    points = np.load(root / "runs" / made / POINTS)
    assert set(points.files) == {"armspace-75", "dance-latin", "armspace-60", "jump"}


def test_a_missing_run_is_named_and_a_failed_one_keeps_its_line(study, tmp_path):
    root, made, _ = study
    with pytest.raises(UserError, match="motions.npz: named in results.csv, but missing; `garmentbench evals motions`"):
        make_report("smoke", root / "reports", tmp_path)
    rows = motions.STUDY.work(SMOKE, 1).rows({motions.KEY: Failure("motions", "no memory")})
    write_results(tmp_path / "smoke" / "results.csv", rows)
    make_report("smoke", tmp_path, tmp_path)
    assert "| armspace-75 | train | – | – | failed |" in (tmp_path / "smoke" / "tables" / "motions.md").read_text()
    assert not (tmp_path / "smoke" / "plots" / "motions.svg").exists()
