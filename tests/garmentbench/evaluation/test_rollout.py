"""Whatever a method does, its roll-out is a value that says so."""

import re
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evaluation.rollout import RollOut, one_step, roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.method import Clock, span

FRAMES = 12
BAD = 7


@dataclass
class Last:
    """Repeats the last garment of its history. `at(frame, garment)` may change what is returned at a frame."""

    at: object = None

    def begin(self, template, history):
        self.begun = getattr(self, "begun", 0) + 1
        return {"garment": history.garments[-1], "frame": 3}

    def step(self, state, body):
        garment = state["garment"].copy()
        if self.at is not None:
            garment = self.at(state["frame"], garment)
        return garment, state | {"frame": state["frame"] + 1}


def at_bad_frame(change):
    return Last(lambda frame, garment: change(garment) if frame == BAD else garment)


def fail(garment):
    raise ArithmeticError("the matrix is singular")


@pytest.fixture
def sequence():
    return tiny_sequence(FRAMES)


def test_a_roll_out_begins_once_and_runs_freely(sequence):
    roll = roll_out(Last(), sequence)
    assert (roll.kind, roll.start, roll.status, roll.first_bad_frame, roll.message) == ("roll_out", 3, "ok", None, "")
    np.testing.assert_array_equal(roll.garment[:3], sequence.garment[:3])
    np.testing.assert_array_equal(roll.garment[3:], np.repeat(sequence.garment[2:3], FRAMES - 3, axis=0))
    assert roll.before_collision is None and roll.garment.dtype == np.float32


def test_one_step_begins_at_every_frame(sequence):
    roll = one_step(Last(), sequence)
    assert roll.kind == "one_step"
    np.testing.assert_array_equal(roll.garment[3:], sequence.garment[2:-1])


def test_progress_is_told_once_a_frame(sequence):
    told = []
    roll_out(Last(), sequence, lambda: told.append(1))
    assert len(told) == FRAMES - 3


@pytest.mark.parametrize(
    ("change", "status", "says"),
    [
        (fail, "failed", "raised ArithmeticError: the matrix is singular"),
        (lambda g: g[:-1], "failed", "returned float32 of shape (104, 3); wanted floats of shape (105, 3)"),
        (lambda g: None, "failed", "returned object of shape ()"),
        (lambda g: g.astype(int), "failed", "returned int64 of shape (105, 3)"),
        (lambda g: [g[:3], 3], "failed", "raised ValueError"),
        (lambda g: np.where(np.arange(105)[:, None] < 4, np.nan, g), "diverged", "4 of 105 vertices are not finite"),
        (lambda g: g * 1e30, "diverged", "from the reference, farther than the limit of 1.6 m"),
        (lambda g: g.astype(np.float64) * 1e300, "diverged", "farther than the limit"),
        (lambda g: g + np.float32(1.0), "diverged", "a vertex is 1.7"),
    ],
)
@pytest.mark.parametrize("run", [roll_out, one_step])
def test_a_bad_frame_ends_it_and_stays(sequence, change, status, says, run):
    method = at_bad_frame(change) if run is roll_out else OneStepBad(change)
    roll = run(method, sequence)
    assert (roll.status, roll.first_bad_frame) == (status, BAD) and says in roll.message
    assert np.isfinite(roll.garment[:BAD]).all() and np.isnan(roll.garment[BAD:]).all()
    assert np.isfinite(roll.ms[3:BAD]).all() and np.isnan(roll.ms[BAD:]).all() and np.isnan(roll.ms[:3]).all()


class OneStepBad(Last):
    """Bad where the history is that of the bad frame."""

    def __init__(self, change):
        super().__init__(lambda _, garment: change(garment) if self.bad else garment)
        self.true = tiny_sequence(FRAMES).garment

    def begin(self, template, history):
        self.bad = np.array_equal(history.garments[-1], self.true[BAD - 1])
        return super().begin(template, history)


def test_an_error_within_the_body_height_is_an_error_not_a_divergence(sequence):
    roll = roll_out(at_bad_frame(lambda g: g + np.float32([0, 0, 1.5])), sequence)
    assert roll.status == "ok"
    roll = roll_out(at_bad_frame(lambda g: g + np.float32([0, 0, 1.7])), sequence)
    assert roll.status == "diverged"


@pytest.mark.parametrize("kind", ["object", None])
def test_without_a_human_body_the_limit_is_twice_the_garment_size(kind):
    sequence = tiny_sequence(FRAMES, kind)
    size = float(np.linalg.norm(np.ptp(sequence.template.garment.rest, axis=0)))
    nearly, beyond = (at_bad_frame(lambda g, k=k: g + np.float32([0, 0, k * size])) for k in (1.8, 2.2))
    assert roll_out(nearly, sequence).status == "ok"
    assert roll_out(beyond, sequence).status == "diverged"


def test_a_method_that_can_not_begin_has_failed(sequence):
    class NoBegin(Last):
        def begin(self, template, history):
            raise KeyError("upper_body")

    roll = roll_out(NoBegin(), sequence)
    assert (roll.status, roll.first_bad_frame) == ("failed", 3)
    assert re.fullmatch(r"raised KeyError: 'upper_body' \(.*test_rollout.py:\d+\)", roll.message)


def test_ctrl_c_passes(sequence):
    def interrupt(garment):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        roll_out(at_bad_frame(interrupt), sequence)


def test_a_method_can_neither_reach_nor_spoil_the_reference(sequence):
    true = sequence.garment.copy(), sequence.body.copy()

    class Vandal(Last):
        def begin(self, template, history):
            assert history.garments.base is None and history.garments.shape == (3, 105, 3)
            state = super().begin(template, history)
            history.garments[:] = 0
            history.bodies[:] = 0
            return state | {"garment": state["garment"] + 1}

        def step(self, state, body):
            body.vertices[:] = np.nan
            return super().step(state, body)

    roll_out(Vandal(), sequence)
    np.testing.assert_array_equal(sequence.garment, true[0])
    np.testing.assert_array_equal(sequence.body, true[1])


def test_output_is_kept_even_if_the_method_writes_over_it(sequence):
    class Reuses(Last):
        def step(self, state, body):
            state["garment"] += np.float32(0.01)
            return state["garment"], state

    roll = roll_out(Reuses(), sequence)
    steps = np.diff(roll.garment[3:], axis=0)
    np.testing.assert_allclose(steps, 0.01, atol=1e-5)


class Timed(Last):
    """Spends known times; its very first steps, as with a compiler, are slow."""

    def step(self, state, body):
        self.calls = getattr(self, "calls", 0) + 1
        with span("prepare"):
            time.sleep(0.3 if self.calls <= 3 else 0.004)
        with span("collide"):
            time.sleep(0.012)
        time.sleep(0.008)
        return super().step(state, body)


def test_the_clock_splits_a_step_and_leaves_the_warm_up_out(sequence):
    roll = roll_out(Timed(), sequence)
    prepare, predict, collide = np.median(roll.ms[3:], axis=0)
    assert 4 <= prepare < 30 and 8 <= predict < 40 and 12 <= collide < 60
    assert roll.ms[3:, 0].max() < 290
    assert np.nanmedian(roll.processor_ms) < 5 and np.isnan(roll.processor_ms[:3]).all()  # it only slept


def test_processor_time_is_that_of_the_work():
    """N12: it stands beside wall time, so that other work on the machine shows."""
    clock = Clock()
    with clock.running():
        end = time.process_time() + 0.02
        while time.process_time() < end:
            pass
        time.sleep(0.03)
    assert 20 <= clock.processor_ms < 30 and clock.ms["predict"] >= 50


def test_no_processor_time_with_a_cuda_device_for_which_the_processor_waits(sequence, monkeypatch):
    cuda = SimpleNamespace(is_initialized=lambda: True, synchronize=lambda: None)
    monkeypatch.setitem(sys.modules, "torch", SimpleNamespace(cuda=cuda))
    assert roll_out(Last(), sequence).processor_ms is None


def test_garments_before_the_collision_stage_are_kept(sequence):
    @dataclass(frozen=True)
    class State:
        garment: np.ndarray
        before_collision: np.ndarray | None
        frame: int = 3

    class Collides(Last):
        def begin(self, template, history):
            return State(history.garments[-1], None)

        def step(self, state, body):
            before = state.garment - 1 if state.frame != 5 else None
            return state.garment, State(state.garment, before, state.frame + 1)

    roll = roll_out(Collides(), sequence)
    np.testing.assert_array_equal(roll.before_collision[3], roll.garment[3] - 1)
    assert np.isnan(roll.before_collision[5]).all() and np.isnan(roll.before_collision[:3]).all()


@pytest.mark.parametrize("method", [Last(), at_bad_frame(fail)])
def test_a_roll_out_comes_back_as_it_was(sequence, tmp_path, method):
    roll = roll_out(method, sequence)
    roll = replace(roll, before_collision=roll.garment + 1)
    roll.save(tmp_path / "roll.h5")
    read = RollOut.load(tmp_path / "roll.h5")
    for name in ("garment", "before_collision", "ms", "processor_ms"):
        assert getattr(read, name).tobytes() == getattr(roll, name).tobytes()
    for name in ("kind", "start", "status", "first_bad_frame", "message"):
        assert getattr(read, name) == getattr(roll, name)


def test_a_broken_roll_out_file_is_refused(sequence, tmp_path):
    path = tmp_path / "roll.h5"
    roll_out(Last(), sequence).save(path)
    whole = path.read_bytes()
    for cut in np.linspace(0, len(whole) - 1, 20).astype(int):
        path.write_bytes(whole[:cut])
        with pytest.raises(UserError, match="evaluate again"):
            RollOut.load(path)


def test_a_disk_that_fills_leaves_no_roll_out(tmp_path):
    code = """
import resource, sys
from pathlib import Path
import numpy as np
from garmentbench.errors import UserError
from garmentbench.evaluation.rollout import RollOut
sys.dont_write_bytecode = True  # a module compiled now would be cut off, and stay so
resource.setrlimit(resource.RLIMIT_FSIZE, (9_000, 9_000))
try:
    RollOut("roll_out", 3, np.random.rand(9, 99, 3).astype("f4"), None, np.ones((9, 3))).save(Path(sys.argv[1]))
except UserError as e:
    sys.exit(f"refused: {e}")
"""
    done = subprocess.run([sys.executable, "-c", code, tmp_path / "r.h5"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and done.stderr.startswith("refused: ")
    assert list(tmp_path.iterdir()) == []


def test_too_short_a_sequence_is_refused():
    with pytest.raises(UserError, match="has 3 frames; wanted at least 4"):
        roll_out(Last(), tiny_sequence(3))
