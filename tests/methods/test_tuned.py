"""The tuned method: it keeps the contract, puts cloth outside, and each variant takes one part away."""

from dataclasses import replace

import numpy as np
import pytest

from garmentbench.evaluation.check_method import parametrize_with_checks
from garmentbench.evaluation.rollout import roll_out
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.geometry.mesh import vertex_normals
from garmentbench.geometry.nearest import plane_distances
from garmentbench.method import BodyFrame, History
from garmentbench.methods.baselines import rollouts
from garmentbench.methods.tuned import VARIANTS, Config, Tuned, config_for
from garmentbench.pipeline.train import training_run

SMALL = replace(config_for("smoke"), seeds=20, codes=8, body_codes=16, unroll=8)
TINY = replace(SMALL, training=replace(SMALL.training, steps=5))


def fitted(config=TINY, sequence=None, seed=0) -> Tuned:
    return Tuned.fit((sequence or tiny_sequence(60),), config, training_run(None, seed))


@parametrize_with_checks([(Tuned, TINY)])
def test_it_keeps_the_contract(method, check):
    check(method)


def test_what_it_gives_is_outside_and_what_was_inside_is_kept(tmp_path):
    fitted().save(tmp_path)
    method, sequence = Tuned.load(tmp_path), tiny_sequence(8, phase=1.0)
    method.garment.mean[:] *= 0
    method.garment.mean[0::3] = -0.6 * sequence.template.garment.rest[:, 0]  # a garment that is far too narrow
    method.garment.mean[1::3] = -0.6 * sequence.template.garment.rest[:, 1]
    state = method.begin(sequence.template, History.before(sequence, 3))
    garment, state = method.step(state, BodyFrame(sequence.body_positions[3]))
    before, after = (_share_inside(g, sequence, 3) for g in (state.before_collision, garment))
    assert before > 0.5 and after < 0.02
    method.push_out = False
    alone, without = method.step(
        method.begin(sequence.template, History.before(sequence, 3)), BodyFrame(sequence.body_positions[3])
    )
    np.testing.assert_array_equal(alone, state.before_collision)
    assert without.before_collision is None


def _share_inside(garment, sequence, t: int) -> float:
    body = sequence.body_positions[t]
    normals = vertex_normals(body, sequence.template.required_body.faces)
    return float((plane_distances(garment, body, normals) < 0).mean())


@pytest.mark.parametrize(("kind", "outside"), [("human", True), ("garment", True), ("object", False), (None, False)])
def test_cloth_is_put_outside_where_there_is_an_inside(kind, outside):
    sequence = tiny_sequence(60, kind=kind)
    for config, wanted in ((TINY, outside), (VARIANTS["no_push_out"](TINY), False)):
        state = fitted(config, sequence).begin(sequence.template, History.before(sequence, 3))
        assert (state.outside is not None) == wanted


def test_an_object_is_seen_with_an_offset_of_its_own(monkeypatch):
    seen, fit_net = [], rollouts.fit_net

    def noting(kind, recordings, config, *rest):
        seen.append(config.offset)
        return fit_net(kind, recordings, config, *rest)

    monkeypatch.setattr(rollouts, "fit_net", noting)
    for kind in ("human", "object"):
        fitted(TINY, tiny_sequence(60, kind=kind))
    assert seen == [Config().offset, Config().object_offset] and seen[0] < seen[1]


@pytest.mark.parametrize("variant", [v for v in VARIANTS if v != "full"])
def test_each_variant_takes_one_part_away(variant):
    full = config_for("laptop")
    changed = {name for name, value in vars(VARIANTS[variant](full)).items() if value != getattr(full, name)}
    parts = {"no_push_out": {"push_out"}, "no_turns": {"turns"}, "no_offset": {"offset", "object_offset"}}
    parts |= {"no_noise": {"noise"}, "one_step": {"unroll"}, "narrow": {"width"}, "short": {"training"}}
    assert changed == parts[variant]
    fitted(replace(VARIANTS[variant](TINY), training=replace(TINY.training, steps=2)))


def test_whether_it_puts_cloth_outside_is_saved(tmp_path):
    sequence = tiny_sequence(20, phase=1.0)
    for config in (TINY, replace(TINY, push_out=False)):
        method = fitted(config)
        method.save(tmp_path)
        again = Tuned.load(tmp_path)
        assert again.push_out == config.push_out
        one, other = (roll_out(m, sequence).garment for m in (method, again))
        np.testing.assert_array_equal(one, other)
