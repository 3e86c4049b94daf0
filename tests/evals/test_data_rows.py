"""Every sequence that an evaluation made has its card in results.csv, once."""

from dataclasses import replace

import pandas

from garmentbench import sequence_file
from garmentbench.evals.data import CARDS, cards_in
from garmentbench.evals.run import merged, write_results
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.reference import SequenceFile
from garmentbench.report.lines import read_results
from garmentbench.scenes.presets import preset
from garmentbench.storage.jobs import Failure

SMOKE = preset("smoke")


def test_cards_reach_results_and_stay_when_other_experiments_are_made_again(tmp_path):
    results = {("train", "x"): "train-1", ("sequence", "broken"): Failure("simulate broken", "no")}
    for name, split in (("a", "train"), ("b", "test")):
        info = {
            "scene": name,
            "split": split,
            "preset": "smoke",
            "motion": "walk",
            "simulation": {"status": "ok", "substeps": 88},
        }
        sequence_file.save(replace(tiny_sequence(20), info=info), tmp_path / f"{name}.h5")
        results["sequence", name] = tmp_path / f"{name}.h5"
    scenes = [SequenceFile(tmp_path / f"{name}.h5") for name in ("broken", "a", "b")]
    rows = CARDS.beside(scenes, SMOKE).rows(results)
    path = tmp_path / "results.csv"
    write_results(path, rows)
    again = merged(path, CARDS.beside(scenes[2:], SMOKE).rows(results))
    assert len(again) == len(rows)
    write_results(path, again)
    cards = cards_in(read_results(path))
    assert [(card.scene, card.split, card.status, card.numbers["substeps"]) for card in cards] == [
        ("a", "train", "ok", 88.0),
        ("b", "test", "ok", 88.0),
    ]
    assert (pandas.read_csv(path).experiment == "data").all()
