"""The stress ladder: its statistics and rules by hand, its courses, networks in other precisions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from garmentbench.evals.stability.bones import joined, moved, pressed
from garmentbench.evals.stability.course import EVENT, Course
from garmentbench.evals.stability.judging import judged
from garmentbench.evals.stability.moving import animated
from garmentbench.evals.stability.precision import computing, has_network
from garmentbench.evals.stability.rungs import FIRST_LOOK, RUNGS, SHORT
from garmentbench.evals.stability.simulating import _while_whole
from garmentbench.evals.stability.statistics import growth_rate, kaplan_meier, wilson
from garmentbench.evals.stability.study import STABILITY, WHOLE, line_rows
from garmentbench.evaluation.results import Row
from garmentbench.evaluation.rollout import BROKEN, DIVERGED, FAILED, OK
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.method import BodyFrame, History
from garmentbench.methods.baselines.hold import Hold
from garmentbench.methods.baselines.pose_gru import PoseGru
from garmentbench.pipeline.choice import choose_method
from garmentbench.pipeline.train import training_run
from garmentbench.scenes.bodies import load_body, pose_exact
from garmentbench.scenes.presets import preset

SMOKE = preset("smoke")


def test_wilsons_interval():
    assert wilson(10, 10) == pytest.approx((0.7225, 1.0), abs=1e-4)  # so ten of ten still allow 28 % to fail
    assert wilson(0, 10) == pytest.approx((0.0, 0.2775), abs=1e-4)
    assert wilson(5, 10) == pytest.approx((0.2366, 0.7634), abs=1e-4)


def test_survival_by_hand():
    frames, ended = np.array([2, 3, 3, 5, 8, 8]), np.array([True, True, False, True, False, False])
    steps, shares = kaplan_meier(frames, ended)
    assert steps.tolist() == [0, 2, 3, 5]
    assert shares == pytest.approx([1, 5 / 6, 5 / 6 * 4 / 5, 5 / 6 * 4 / 5 * 2 / 3])


def test_a_distance_that_doubles_each_second_grows_by_the_logarithm_of_two():
    seconds = np.arange(61) / 30
    assert growth_rate(1e-4 * 2**seconds, 30.0) == pytest.approx(np.log(2))
    assert growth_rate(1e-4 * 0.5**seconds, 30.0) == pytest.approx(-np.log(2))
    assert growth_rate(np.zeros(61), 30.0) is None


def test_a_run_is_judged_by_the_first_rule_that_it_breaks():
    sequence = tiny_sequence(30)
    garment, bodies, template = sequence.garment.copy(), sequence.body_positions, sequence.template
    fine = judged(garment, bodies, template)
    assert fine.status == OK and fine.survived == fine.frames == 27 and fine.first_bad_frame is None
    stretched = garment.copy()
    stretched[12] = garment[12].mean(axis=0) + 2.2 * (garment[12] - garment[12].mean(axis=0))
    torn = judged(stretched, bodies, template)
    assert (torn.status, torn.first_bad_frame, torn.rule, torn.survived) == (BROKEN, 12, "strain", 9)
    stretched[20:] = np.nan
    assert judged(stretched, bodies, template).status == DIVERGED
    assert judged(stretched, bodies, template).first_bad_frame == 12  # the earliest, whatever came later
    away = garment.copy()
    away[15:, 0] += 100.0
    assert (judged(away, bodies, template).rule, judged(away, bodies, template).status) == ("far", DIVERGED)
    away[15:] = np.nan
    raised = judged(away, bodies, template, raised="raised ValueError")
    assert (raised.status, raised.first_bad_frame, raised.rule) == (FAILED, 15, "raised")


def test_what_happens_on_a_course_happens_at_once():
    plain = animated(Course(), 0, SMOKE)
    at = plain.warm_up + EVENT
    stopped, dropped, away = (animated(Course(event=e), 0, SMOKE).positions for e in ("stop", "dropped", "teleport"))
    assert (stopped[at:] == plain.positions[at]).all() and (stopped[:at] == plain.positions[:at]).all()
    assert (dropped[at] == plain.positions[at - 1]).all() and (dropped[at + 1] == plain.positions[at + 1]).all()
    np.testing.assert_allclose(away[at:], plain.positions[at:] + [1.0, 0.0, 0.0], atol=1e-12)


def test_a_pair_of_starts_has_one_motion_and_two_pushes():
    one, two, three = (animated(Course(), start, SMOKE).positions for start in range(3))
    assert (one == two).all() and not np.allclose(one, three, atol=1e-3)
    places, pins = np.random.default_rng(0).normal(size=(9, 3)), np.zeros(9, bool)
    pushes = [Course().pushed(start).offsets(places, pins) for start in range(2)]
    assert not np.allclose(*pushes, atol=1e-5)


def test_another_frame_rate_shows_the_same_motion():
    plain, fast, slow = (animated(Course(fps=fps), 0, SMOKE) for fps in (30.0, 60.0, 15.0))
    assert (fast.warm_up, slow.warm_up) == (120, 30)
    np.testing.assert_allclose(fast.positions[::2][:60], plain.positions[:60], atol=1e-9)
    np.testing.assert_allclose(slow.positions[:30], plain.positions[::2][:30], atol=1e-12)


def test_arms_are_pressed_and_motions_joined_without_a_leap():
    base, scene = load_body("base", "small"), Course(event="pressed").scene(0)
    clip = pressed(base, scene, 40, EVENT)
    hand = base.joint_names.index("fore_arm.L")
    plain = moved(base, "armspace-90", 60)
    assert len(clip) == 55 and not np.allclose(clip.rotations[-1, hand], plain.rotations[-1, hand], atol=0.1)
    both = joined(plain, moved(base, "run", 60))
    positions = pose_exact(base, both.rotations, both.root, slice(None, None, 50))
    speed = 30 * np.sqrt(np.square(np.diff(positions, axis=0)).sum(axis=2).mean(axis=1))
    assert len(both) == 100 and speed.max() < 5.0  # [m/s] a run's; a leap of 20 cm would be 6


def test_what_has_blown_up_is_not_run_to_the_end():
    def run(frames: int, blown_up_at: int) -> SimpleNamespace:
        tried.append(frames)
        return SimpleNamespace(strain=np.array([[0.0, np.nan if t >= blown_up_at else 0.1] for t in range(frames)]))

    tried: list[int] = []
    assert len(_while_whole(lambda frames: run(frames, 99), 50).strain) == 50 and tried == [4, 8, 16, 32, 50]
    tried.clear()
    assert len(_while_whole(lambda frames: run(frames, 6), 50).strain) == 8 and tried == [4, 8]


def test_a_network_computes_in_another_precision_and_a_rule_has_none():
    sequence = tiny_sequence(24)
    config = choose_method(PoseGru, "full", SMOKE).config
    training = replace(config.training, steps=3)
    method = PoseGru.fit((sequence,), replace(config, training=training), training_run())
    start = method.begin(sequence.template, History.before(sequence, 3))
    body = BodyFrame(sequence.body_positions[3])
    plain = method.step(start, body)[0]
    assert has_network(method) and not has_network(Hold(Hold.Config()))
    with computing(method, "bfloat16"):
        coarse = method.step(start, body)[0]
    with computing(method, "float64"):
        fine = method.step(method.begin(sequence.template, History.before(sequence, 3)), body)[0]
    assert {p.dtype for p in method.net.parameters()} == {torch.float64}
    assert 0 < np.abs(coarse - plain).max() < 0.1
    assert np.abs(fine - plain).max() < 1e-4


def test_the_rows_of_a_line():
    ok = {"status": OK, "frames": 57, "first_bad_frame": None, "strain": 4.0, "inside": 1.0, "energy": 1.1}
    bad = {"status": BROKEN, "frames": 57, "first_bad_frame": 9, "strain": 140.0, "inside": 0.5, "energy": None}
    starts = [start | {"energy_left": None, "changed": None} for start in (ok, bad, ok)]
    rows = {row.metric: row for row in line_rows({"starts": starts, "growth": None}, Row(method="hold"))}
    assert {name: row.value for name, row in rows.items()} == {
        "passed": 2.0, "starts": 3.0, "strain_p99_max": 140.0, "inside_max": 1.0, "energy_max": 1.1
    }  # fmt: skip
    assert {(row.status, row.first_bad_frame, row.horizon) for row in rows.values()} == {(BROKEN, 9, 57)}


def test_the_short_ladder_is_a_part_of_the_whole_and_shorter_still_at_first_look():
    names = [rung.name for rung in RUNGS]
    assert len(set(names)) == len(names) >= 24 and set(FIRST_LOOK) < set(SHORT) < set(names)
    jobs = {p: STABILITY.work(preset(p), 1).jobs for p in ("smoke", "laptop")}
    climbed = {p: {key[1] for key in jobs[p] if key[0] == "climb"} for p in jobs}
    assert climbed == {"smoke": set(FIRST_LOOK), "laptop": set(SHORT)}
    whole = WHOLE.work(preset("laptop"), 1).jobs
    assert {key[2] for key in whole if key[0] == "course"} == {1, 10}  # the long one from one start
    costs = {key[1].event: job.cost for key, job in whole.items() if key[0] == "course"}
    assert costs["medley"] > 5 * costs["stop"]
