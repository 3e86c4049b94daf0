"""A trained method as a folder: what is read back predicts the same, and what is damaged is refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.errors import UserError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.pipeline.checkpoint import (
    CARD,
    CONFIG,
    NUMBERS,
    SMALL,
    is_checkpoint,
    read_checkpoint,
    write_checkpoint,
)
from garmentbench.pipeline.choice import choose_method
from garmentbench.pipeline.evaluate import evaluate
from garmentbench.pipeline.train import train
from garmentbench.reference import resolve_source
from garmentbench.scenes.presets import preset
from garmentbench.storage.runs import RunStore

METHODS = ("linear_subspace", "tuned", "motion_guided")  # .npz; .npz and text; .pt of nested tensors, .npz and text


@pytest.fixture
def source(home):
    sequence_file.save(tiny_sequence(40), home / "walk.h5")
    return resolve_source("walk.h5")


def trained(method, source):
    return train(choose_method(method, "full", preset("smoke")), [source], preset("smoke"), 40, 0, RunStore())


def errors(run):
    return [(row["metric"], row["value"]) for row in run.results["rows"] if row["unit"] != "ms"]


@pytest.mark.parametrize("method", METHODS)
def test_it_has_the_same_row_on_the_same_sequence(method, source, home):
    run = trained(method, source)
    write_checkpoint(run, home / "given")
    again = read_checkpoint(home / "given", RunStore())
    assert again.id != run.id and again.identity["train_scenes"] == ["walk"]
    assert sorted(p.name for p in (home / "given").iterdir()) == [CONFIG, NUMBERS]
    mine, theirs = (errors(evaluate(r, source, preset("smoke"), RunStore())) for r in (run, again))
    assert mine == theirs


def test_reading_twice_makes_one_run(source, home):
    write_checkpoint(trained("linear_subspace", source), home / "given")
    first, second = (read_checkpoint(home / "given", RunStore()) for _ in range(2))
    assert first.id == second.id and second.reused and not first.reused


def test_half_the_bits_move_large_arrays_by_a_two_thousandth_and_leave_small_ones(source, home):
    run = trained("linear_subspace", source)
    write_checkpoint(run, home / "whole")
    write_checkpoint(run, home / "half", half=True)
    sizes = [(home / name / NUMBERS).stat().st_size for name in ("whole", "half")]
    assert sizes[1] < 0.75 * sizes[0]
    file = "linear_subspace.npz"
    exact, rounded = (
        dict(np.load(folder / "method" / file))
        for folder in (run.folder, read_checkpoint(home / "half", RunStore()).folder)
    )
    assert exact.keys() == rounded.keys() and any(a.size >= SMALL for a in exact.values())
    for key, array in exact.items():
        assert rounded[key].dtype == array.dtype and rounded[key].shape == array.shape
        if array.size < SMALL or array.dtype.kind != "f":
            assert np.array_equal(rounded[key], array), key
        else:
            assert np.allclose(rounded[key], array, rtol=2**-11, atol=1e-7), key


def test_numbers_too_large_for_half_are_kept_whole(source, home):
    run = trained("linear_subspace", source)
    large = np.full(SMALL, 1e5, np.float32)
    np.savez(run.folder / "method" / "large.npz", large=large)
    write_checkpoint(run, home / "given", half=True)
    back = read_checkpoint(home / "given", RunStore())
    assert np.array_equal(np.load(back.folder / "method" / "large.npz")["large"], large)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
@pytest.mark.parametrize("name", [NUMBERS, CONFIG])
def test_a_file_cut_off_is_refused(name, share, source, home):
    write_checkpoint(trained("linear_subspace", source), home / "given")
    whole = (home / "given" / name).read_bytes()
    (home / "given" / name).write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(UserError, match=rf"{name}: (is not the file|can't be read)"):
        read_checkpoint(home / "given", RunStore())


def test_a_config_without_its_class_or_of_another_schema_is_refused(source, home):
    write_checkpoint(trained("skinning", source), home / "given")
    path = home / "given" / CONFIG
    config = json.loads(path.read_text())
    for changed, message in (
        ({"identity": {}}, "is no checkpoint's"),
        ({"schema": 99}, "schema 99, this garmentbench reads 1"),
        ({"files": {"../outside.json": "{}"}}, "lies outside of the folder"),
    ):
        path.write_text(json.dumps(config | changed))
        with pytest.raises(UserError, match=message):
            read_checkpoint(home / "given", RunStore())
    assert not list(Path(home).rglob("outside.json"))


def test_what_is_no_array_is_refused_by_its_name(source, home):
    run = trained("skinning", source)
    (run.folder / "method" / "thing.pkl").write_bytes(b"x")
    with pytest.raises(UserError, match=r"thing.pkl: can't go into a checkpoint; wanted .npz, .pt or text"):
        write_checkpoint(run, home / "given")
    assert not is_checkpoint(str(home / "given"))


def test_the_commands_as_typed(source, home, capsys):
    run = trained("linear_subspace", source)
    assert main(["checkpoint", run.id, "given", "--scene", "walk.h5", "--preset", "smoke"]) == 0
    card = (home / "given" / CARD).read_text()
    assert card.startswith("# linear_subspace (full)") and "| walk |" in card and "Trained on** walk" in card
    capsys.readouterr()
    assert main(["evaluate", "given", "--scene", "walk.h5", "--preset", "smoke"]) == 0
    assert "rollout_l2" in capsys.readouterr().out
    assert main(["evaluate", "nowhere", "--scene", "walk.h5", "--preset", "smoke"]) != 0
