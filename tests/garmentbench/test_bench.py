"""This machine's clock, as typed, and what is computed of the times."""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest

from garmentbench.cli import main
from garmentbench.commands.bench import _row
from garmentbench.methods.motion_guided.config import config_for
from garmentbench.pipeline.bench import Timed, ratio, shortened

SHORT = ("--scene", "sheet-stick-a", "--preset", "smoke", "--frames", "12")


def test_a_line_for_the_simulators_and_each_method_and_the_last_on_all_cores(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("garmentbench.pipeline.bench.core_count", lambda: 2)
    monkeypatch.setattr("garmentbench.pipeline.bench._in_a_process", lambda call, *arguments: call(*arguments))
    assert main(["--home", str(tmp_path), "bench", "skinning", "hold", *SHORT]) == 0
    said, header, *lines = capsys.readouterr().out.splitlines()
    assert "cores" in said and "float32" in said and said.endswith("sheet-stick-a, smoke")
    names = [re.split(r"\s{2,}", line)[:2] for line in lines]
    assert names == [
        ["simulator", "1"], ["simulator, XPBD, 16 substeps", "1"], ["skinning", "1"], ["hold", "1"], ["hold", "2"]
    ]  # fmt: skip
    assert "ms a frame" in header and "processor ms" in header and "peak memory [MB]" in header
    assert not list(tmp_path.rglob("*.h5")) and not (tmp_path / "runs").exists()


def test_two_in_turn(tmp_path, capsys):
    assert main(["--home", str(tmp_path), "bench", "skinning", "hold", "--pair", *SHORT]) == 0
    times, low, high = map(float, re.findall(r"\d+\.\d\d", capsys.readouterr().out.splitlines()[-1]))
    assert 0.1 < low <= high < 10 and 0.1 < times < 10


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (["--pair", "skinning"], "1 methods are given; wanted two"),
        (["skining"], "did you mean 'skinning'"),
        (["motion_guided@push_outt"], "did you mean 'push_out'"),
        (["--frames", "5"], "bench: 5 frames; wanted more than 6"),
    ],
)
def test_a_wrong_call_is_refused_before_anything_is_simulated(typed, said, capsys):
    assert main(["bench", *typed]) == 2
    assert said in capsys.readouterr().err


def test_the_ratio_and_its_interval():
    rng = np.random.default_rng(1)
    noise = 1 + 0.02 * rng.standard_normal((2, 200))
    times, low, high = ratio(3 * noise[0], 2 * noise[1])
    assert times == pytest.approx(1.5, rel=0.01) and low < 1.5 < high and high - low < 0.03


def test_each_training_in_a_configuration_is_shortened_and_nothing_else():
    full = config_for("laptop")
    short = shortened(full, 0.1)
    assert (short.sdf.training.steps, short.stage1.training.steps, short.stage2.training.steps) == (150, 300, 250)
    back = replace(short, sdf=full.sdf, stage1=full.stage1, stage2=full.stage2)
    assert back == full and short.collision.steps == full.collision.steps

    @dataclass(frozen=True)
    class Own:
        steps: int = 7

    assert shortened(Own()) == Own()


def test_a_time_under_load_is_told():
    idle, ms = np.full(10, 4.0), np.full(10, 8.0)
    assert _row(Timed("a", ms, ms, 1.0))["note"] is None
    assert _row(Timed("a", ms, idle, 1.0, ending="broken at frame 7"))["note"] == "broken at frame 7; timed under load"
