"""The stress ladder: where time is short it is, too."""

from garmentbench.evals.stability import STABILITY
from garmentbench.scenes.presets import preset


def test_the_stiff_end_is_left_out_where_sequences_are_cut_short():
    short, whole = (
        {key for key in STABILITY.work(preset(p), 1).jobs if key[0] == "sequence"} for p in ("smoke", "laptop")
    )
    left_out = {("sequence", f"stress-{case}") for case in ("stiff-leather", "stiff-1000", "speed-2")}
    assert whole - short == left_out and short < whole


def test_what_takes_longest_is_begun_first():
    jobs = STABILITY.work(preset("laptop"), 1).jobs.values()
    simulated = sorted((job for job in jobs if job.key[0] == "sequence"), key=lambda job: -job.cost)
    assert {job.key[1] for job in simulated[:2]} == {"stress-stiff-leather", "stress-stiff-1000"}
