"""What settings are chosen on, and that the choice follows it."""

from dataclasses import replace

import numpy as np

from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.methods.baselines.held_out import folds, kind
from garmentbench.methods.baselines.static_ridge import fit_static


def test_of_one_kind_the_end_is_held_out_of_several_each_kind():
    assert folds(["walk", "walk"], [100, 40]) == [[75, 30]]
    assert folds(["walk", "run", "walk"], [100, 40, 60]) == [[0, 40, 0], [100, 0, 60]]


def test_a_kind_is_a_motion_or_a_clip():
    sequence = tiny_sequence(4)
    assert kind(sequence) == ""
    named = [{"name": "strut"}, {"name": "clip", "file": "a.npz"}, {"name": "clip", "file": "b.npz"}, "imported"]
    found = [kind(replace(sequence, info={"motion": motion})) for motion in named]
    assert len(set(found)) == 4
    assert kind(replace(sequence, info={"motion": {"name": "strut", "start": 3.0, "file": None}})) == found[0]


def test_the_ridge_is_chosen_on_another_kind_of_motion():
    """An input that tells the codes of one kind, and misleads on the other: the end of the same recording likes it."""
    rng = np.random.default_rng(0)

    def recording(sign):
        both = rng.normal(size=(200, 2))
        return both[:, :1] + 0.3 * sign * both[:, 1:], both

    pair = [recording(1.0), recording(-1.0)]
    one_kind, two_kinds = (np.abs(fit_static(pair, kinds)[:2, 0]).sum() for kinds in (["a", "a"], ["a", "b"]))
    alone = np.abs(fit_static(pair[:1], ["a"])[:2, 0]).sum()
    assert two_kinds <= one_kind < alone
