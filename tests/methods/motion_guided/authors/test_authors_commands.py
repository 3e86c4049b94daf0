"""The authors' data and checkpoints through the command line, from their files to the metrics."""

import numpy as np
import pytest
import torch
from authors_example import Z_UP, write_release
from authors_networks import Change, Decoder, Encoder, Relative

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.evaluation.rollout import RollOut
from garmentbench.storage.runs import RunStore


@pytest.fixture
def home(tmp_path, monkeypatch):
    """Data and two checkpoints, and an empty place for runs."""
    monkeypatch.chdir(tmp_path)
    write_release(tmp_path / "walk_75", Z_UP, frames=8)
    torch.manual_seed(0)
    static = {
        "itter": 1,
        "Relative_encoder": Relative(12, 4).state_dict(),
        "Pred_encoder": Encoder(4, 8, 4, 6).state_dict(),
        "Pre_decoder": Decoder(8, 4, 6, 5).state_dict(),
        "skinRadius": torch.full((3,), 0.05),
    }
    torch.save(static, tmp_path / "static.ckp")
    dynamic = {
        "itter": 1,
        "Dynamic_ForceEncoder": Change(12, 4).state_dict(),
        "Dynamic_Encoder": Encoder(8, 8, 4, 6).state_dict(),
    }
    torch.save(dynamic, tmp_path / "dynamic.ckp")
    return tmp_path


def test_from_released_files_to_metrics(home, capsys):
    assert main(["import-authors", "walk_75", "--out", "walk.h5", "--split", "test"]) == 0
    out = capsys.readouterr().out
    assert "unit: m (told by the body's height)" in out and "frame rate: 30 a second (no file says it)" in out
    sequence = sequence_file.load(home / "walk.h5")
    assert (len(sequence), sequence.info["split"], sequence.template.garment.name) == (8, "test", "tshirt")
    assert main(["import-authors-model", "walk_75", "static.ckp", "dynamic.ckp"]) == 0
    out = capsys.readouterr().out
    assert "networks: maps of 8 pixels, width 4, latent codes of 6, 12 seeds" in out
    run = RunStore().list({"kind": "train"})[0]
    assert f"{run.id}: " in out and run.identity["variant"] == "authors"
    assert main(["evaluate", run.id, "--scene", "walk.h5"]) == 0
    assert "rollout_l2" in capsys.readouterr().out
    evaluated = RunStore().list({"kind": "evaluate"})[0]
    roll = RollOut.load(evaluated.folder / "rollout.h5")
    # Networks of random numbers make no cloth, but they run to the end.
    assert evaluated.results["status"] in ("ok", "broken") and np.isfinite(roll.garment).all()
    assert (roll.garment[3:] != sequence.garment[3:]).any()


def test_the_same_files_are_the_same_run(home, capsys):
    for _ in range(2):
        assert main(["import-authors-model", "walk_75", "static.ckp", "dynamic.ckp"]) == 0
    assert len(RunStore().list({"kind": "train"})) == 1


def test_a_run_that_is_not_there_is_named(home, capsys):
    assert main(["evaluate", "train-00ff", "--scene", "walk_75"]) == 2
    assert main(["import-authors-model", "walk_75", "dynamic.ckp", "static.ckp"]) == 1
    assert "lacks Relative_encoder" in capsys.readouterr().err
