"""A scene simulated several times, changed in what should not matter."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.metrics.l2 import frame_l2
from garmentbench.metrics.spread import spread
from garmentbench.scenes.material import Settings
from garmentbench.scenes.presets import preset
from garmentbench.scenes.scene import Motion, Scene
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.simulation import simulate as module
from garmentbench.simulation.ensemble import FIRST, PUSH, WAVELENGTH, Push, members, summary
from garmentbench.simulation.outfit import Outfit
from garmentbench.simulation.simulate import simulate

SMOKE = preset("smoke")
SCENE = Scene("short", "tshirt", "base", Motion("armspace-90"), "test", frames=6)
INNER = 'garment = "dress"\nbody = "slim"\nmotion = "armspace-90"\nsplit = "test"\nframes = 6\n'


@pytest.fixture(scope="module")
def ensemble():
    return simulate(SCENE, SMOKE, runs=4)


@pytest.fixture(scope="module")
def layers(tmp_path_factory):
    """The over-skirt on the dress."""
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "inner.toml").write_text(INNER)
    (folder / "outer.toml").write_text(INNER.replace("dress", "over_skirt") + 'worn_over = "inner.toml"\n')
    return load_scene(str(folder / "outer.toml"))


def test_four_runs_are_the_first_two_pushed_and_a_finer_one_and_further_ones_are_pushed_otherwise():
    assert [m.name for m in members(4)] == ["first", "pushed_warm_up", "pushed_frame_0", "finer"]
    assert members(1) == (FIRST,) and len(members(3)) == 3
    further = members(7)[4:]
    assert [(m.name, m.seed) for m in further] == [("pushed_warm_up", 1), ("pushed_frame_0", 1), ("pushed_warm_up", 2)]


def test_a_finer_run_has_twice_the_substeps_and_queries():
    settings = members(4)[3].settings(Settings(queries=6, substep_factor=3))
    assert settings == Settings(queries=12, substep_factor=6)
    assert all(m.settings(Settings()) == Settings() for m in members(3))


def test_the_first_run_is_as_it_is_alone(ensemble):
    alone = simulate(SCENE, SMOKE)
    assert alone.runs is None and "ensemble" not in alone.info
    assert np.array_equal(alone.garment, ensemble.garment)


def test_runs_differ_and_are_told(ensemble):
    assert ensemble.runs.shape == (3, *ensemble.garment.shape) and ensemble.runs.dtype == np.float32
    told = ensemble.info["runs"]
    assert [run["name"] for run in told] == ["pushed_warm_up", "pushed_frame_0", "finer"]
    assert all(run["status"] == "ok" and run["first_bad_frame"] is None for run in told)
    first = ensemble.info["simulation"]["substeps"]
    assert [run["substeps"] == first for run in told[:2]] == [True, True] and told[2]["substeps"] >= 2 * first
    assert all(1e-5 < spread([ensemble.garment, run]) < 1 for run in ensemble.runs)


def test_a_push_at_frame_0_moves_frame_0_by_a_millimetre_and_keeps_seams_closed(ensemble):
    pushed = ensemble.runs[1]
    moved = np.linalg.norm(pushed[0].astype(np.float64) - ensemble.garment[0], axis=1)
    np.testing.assert_allclose(moved, PUSH, rtol=1e-2)
    a, b = ensemble.template.garment.seams.T
    assert np.array_equal(pushed[:, a], pushed[:, b])


def test_what_the_runs_say_is_kept(ensemble):
    said = ensemble.info["ensemble"]
    assert said["spread_cm"] == ensemble.spread_cm == spread([ensemble.garment, *ensemble.runs])
    assert said["finer_cm"] == pytest.approx(frame_l2(ensemble.runs[2], ensemble.garment).mean())
    pushed = [frame_l2(run, ensemble.garment) for run in ensemble.runs[:2]]
    assert said["pushed_cm"] == pytest.approx(np.mean(pushed))
    last = [one[-2:].mean() for one in pushed]  # a fifth of 6 frames is 2 of them
    assert said["push_growth"] == pytest.approx(np.mean(last) / 0.1)
    assert said["chaotic"] == (said["push_growth"] > 1)


def test_pushed_particles_go_the_same_way_next_to_each_other_and_pinned_ones_nowhere():
    x = np.random.default_rng(0).uniform(-1, 1, (500, 3))
    pinned = np.arange(500) < 20
    ways = Push(0, PUSH, 3).offsets(x, pinned)
    np.testing.assert_allclose(np.linalg.norm(ways, axis=1), np.where(pinned, 0, PUSH))
    near = x + 0.01 * np.random.default_rng(1).normal(size=x.shape)
    other = Push(0, PUSH, 3).offsets(near, pinned)
    strain = np.linalg.norm(ways - other, axis=1) / np.linalg.norm(x - near, axis=1)
    assert strain.max() < 2 * np.pi * PUSH / WAVELENGTH * 1.001
    assert not np.allclose(ways, Push(0, PUSH, 4).offsets(x, pinned), atol=1e-4)


def test_a_run_that_breaks_stays_and_is_told(monkeypatch):
    class Breaking(Outfit):
        def simulate(self, frames, device, member=FIRST, step=lambda: None):
            worn = super().simulate(frames, device, member, step)
            if member.name == "pushed_warm_up":
                bad = self.animation.warm_up + 3
                worn[-1].run.positions[bad:] = np.inf
                worn[-1].run.first_bad_frame = bad
            return worn

    monkeypatch.setattr(module, "Outfit", Breaking)
    sequence = simulate(SCENE, SMOKE, runs=3)
    broken, whole = sequence.runs
    assert np.isfinite(broken[:3]).all() and np.isnan(broken[3:]).all() and np.isfinite(whole).all()
    told = sequence.info["runs"][0]
    assert (told["status"], told["first_bad_frame"]) == ("unstable", 3)
    said = sequence.info["ensemble"]
    assert said["spread_cm"] == spread([sequence.garment, whole]) and said["finer_cm"] is None
    assert said["push_growth"] > 0


def test_nothing_is_said_where_no_run_is_left(ensemble):
    lost = replace(ensemble, runs=np.full_like(ensemble.runs, np.nan))
    assert set(summary(lost).values()) == {None}


def test_all_layers_are_changed_together(layers):
    sequence = simulate(layers, SMOKE, runs=4)
    outfit = Outfit.of(layers, SMOKE)
    first = outfit.simulate(6, "cpu")[0].run.positions[-1]
    for member, positions in zip(members(4)[1:], sequence.runs, strict=True):
        inner, outer = outfit.simulate(6, "cpu", member)
        assert np.array_equal(outer.run.positions[outfit.animation.warm_up :].astype(np.float32), positions)
        assert not np.array_equal(inner.run.positions[-1], first)
    told = sequence.info["simulation"], sequence.info["simulation"]["beneath"]
    assert [worn.run.substeps >= 2 * t["substeps"] for worn, t in zip((outer, inner), told, strict=True)] == [True] * 2
