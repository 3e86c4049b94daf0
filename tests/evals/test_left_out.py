"""What leaving out saves is measured once and then kept: its times differ from one measurement to the next."""

from garmentbench import sequence_file
from garmentbench.evals import left_out
from garmentbench.evals.left_out import LEAVING_OUT
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.scenes.presets import preset

SMOKE = preset("smoke")


def test_a_measurement_is_kept(home, monkeypatch):
    """N9: repeated `evals` wrote other times into results.csv."""
    sequence_file.save(tiny_sequence(40), home / "a.h5")
    calls = []
    monkeypatch.setattr(left_out, "measured", lambda path, size: [left_out._row("part_radii", len(calls), "ms")])
    made = left_out.left_out(home / "a.h5", SMOKE)
    calls.append(1)
    assert left_out.left_out(home / "a.h5", SMOKE) == made
    work = LEAVING_OUT.work(SMOKE, 1)
    rows = work.rows({key: made for key in work.jobs if key[0] == left_out.LEFT_OUT})
    assert [(row.metric, row.value, row.unit) for row in rows] == [("left_out:part_radii", 0.0, "ms")] * 2


def test_a_scene_that_needs_everything_says_so(home):
    sequence_file.save(tiny_sequence(8), home / "a.h5")
    assert [(row.metric, row.value) for row in left_out.measured(home / "a.h5", SMOKE)] == [("left_out:nothing", 0.0)]
