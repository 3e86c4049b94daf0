"""Data cards: one fixed form, the same from a file and from results.csv, flaws by what was measured."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from garmentbench import sequence_file
from garmentbench.cli import main
from garmentbench.evals.data import card_files, card_rows, cards_in, data_table
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.report.card import FACTS, card_of, read_card
from garmentbench.report.card_text import flaws, markdown
from garmentbench.report.lines import COLUMNS, read_results

HEADINGS = [
    "What",
    "Counts",
    "Cost to make",
    "Spread",
    "Penetration",
    "Self-intersection",
    "Strain",
    "Known flaws",
    "How to evaluate on it",
]
SIMULATED = {
    "scene": "tshirt-armspace-90",
    "split": "test",
    "preset": "smoke",
    "motion": {"name": "armspace-90", "speed": 1.0},
    "simulation": {
        "ms_per_frame": 60.0,
        "substeps": 120,
        "strain_mean": 0.6,
        "strain_p99_max": 4.0,
        "status": "ok",
        "first_bad_frame": None,
        "settings": {"self_contact": True},
    },
    "runs": [{"name": name, "status": "ok"} for name in ("pushed_warm_up", "pushed_frame_0", "finer")],
    "ensemble": {"spread_cm": 0.25, "pushed_cm": 0.3, "finer_cm": 0.1, "push_growth": 3.5, "chaotic": True},
    "scores": {
        "interpenetration": 0.2,
        "interpenetration_strict": 0.05,
        "depth_p95": 0.4,
        "self_intersection": 0.0,
        "crossing_faces_max": 0.0,
    },
}


def sequence(**changes):
    """A tiny simulated sequence; `simulation__status="unstable"` changes one entry of its info."""
    info = json.loads(json.dumps(SIMULATED))
    for key, value in changes.items():
        part, *rest = key.split("__")
        if rest:
            info[part] |= {rest[0]: value}
        else:
            info[part] = value
    return replace(tiny_sequence(20), info=info)


def headings(text: str) -> list[str]:
    return [line[3:] for line in text.splitlines() if line.startswith("## ")]


def lines_of(text: str) -> dict[str, str]:
    """What stands beside each label."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("| ")
    ]
    return {row[0]: row[1] for row in rows}


def test_a_card_says_what_was_measured():
    text = markdown(card_of(sequence()))
    tiny, found = tiny_sequence(20).template, lines_of(text)
    assert headings(text) == HEADINGS
    assert text.startswith("# Data card: tshirt-armspace-90 (smoke)\n")
    assert found["frames"] == "20" and found["garment vertices"] == str(len(tiny.garment.rest))
    assert found["simulator, a frame [ms]"] == "60" and "1.2 seconds for all frames" in text  # 20 x 60 ms = 1.2 s
    assert (
        found["two runs are apart [cm]"] == "0.25"
        and found["runs"] == "4"
        and found["strict, by signed distance [%]"] == "0.05"
    )
    assert found["self-contact is simulated"] == "yes"
    assert "`garmentbench evaluate METHOD --train-scene TRAINING --scene tshirt-armspace-90 --preset smoke`" in text
    assert "another run of the simulator errs by 0.25 cm" in text


@pytest.mark.parametrize(
    ("changes", "flaw"),
    [
        ({"scores__interpenetration_strict": 0.11}, "0.11 % of the garment's vertices lie inside the body"),
        ({"ensemble__spread_cm": 1.3}, "Two runs of it are 1.3 cm apart, more than 1 cm."),
        ({"simulation__strain_p99_max": 12.0}, "strained by more than 12 %"),
        ({"scores__self_intersection": 0.5}, "0.5 % of the faces pass through another"),
        (
            {"simulation__status": "unstable", "simulation__first_bad_frame": 7},
            "The simulation is unstable from frame 7 on.",
        ),
        ({"simulation__settings": {"self_contact": False}}, "self-contact is off"),
        ({"ensemble": {}}, "Not measured: spread."),
        ({"runs": [{"name": "finer", "status": "unstable"}]}, "1 of its further runs broke."),
        ({"ensemble": {}, "scores": {}}, "Not measured: spread and self-intersection."),
        ({"simulation": {}}, "How it was made is not known."),
    ],
)
def test_flaws_follow_from_what_was_measured(changes, flaw):
    assert flaws(card_of(sequence())) == []
    found = flaws(card_of(sequence(**changes)))
    assert any(flaw in line for line in found)
    assert f"- {next(line for line in found if flaw in line)}\n" in markdown(card_of(sequence(**changes)))


def test_the_form_is_the_same_for_a_sequence_of_which_nothing_is_known():
    bare = replace(tiny_sequence(20, kind="object"), info={})
    text = markdown(card_of(bare))
    assert headings(text) == HEADINGS
    assert lines_of(text).keys() == lines_of(markdown(card_of(sequence()))).keys()
    found = lines_of(text)
    assert found["strict, by signed distance [%]"] == "–" and found["substeps a frame"] == "not measured"
    assert "There is no human body" in text and "What it cost is not known." in text


def test_a_card_of_an_imported_sequence_tells_what_was_settled():
    info = {"scene": "mine", "split": "train", "motion": "walk", "imported": {"said": ["unit: cm"]}}
    text = markdown(card_of(replace(tiny_sequence(20), info=info)))
    assert "- unit: cm\n" in text and "| origin | imported |" in text
    assert "`garmentbench train METHOD --scene mine.h5`" in text


def test_a_card_from_results_is_the_card_from_the_file(tmp_path):
    sequence_file.save(sequence(), tmp_path / "a.h5")
    train = sequence(scene="b", split="train", ensemble={}, scores={"interpenetration_strict": 0.05})
    cards = [read_card(tmp_path / "a.h5"), card_of(train)]
    assert cards[0] == card_of(sequence())
    write(tmp_path / "results.csv", [vars(row) for card in cards for row in card_rows(card)])
    back = cards_in(read_results(tmp_path / "results.csv"))
    assert [card.scene for card in back] == ["b", "tshirt-armspace-90"]  # training data first
    assert [markdown(card) for card in back] == [markdown(card) for card in reversed(cards)]
    files = card_files(back)
    assert list(files) == ["cards/b.md", "cards/tshirt-armspace-90.md"]
    assert files["cards/b.md"].startswith(b"<!-- AUTOGENERATED.")
    table = data_table(back)
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["b", "train", "20", str(len(train.template.garment.rest)), "60.0", "–", "0.05", "–", "–", "–", "–", "1"],
        [
            "tshirt-armspace-90",
            "test",
            "20",
            str(len(train.template.garment.rest)),
            "60.0",
            "0.25",
            "0.05",
            "–",
            "–",
            "0.00",
            "chaotic",
            "0",
        ],
    ]


def write(path: Path, rows: list[dict]) -> None:
    import pandas

    pandas.DataFrame(rows, columns=COLUMNS).to_csv(path, index=False, float_format="%.6g")


def test_facts_have_names_of_their_own():
    assert len({fact.name for fact in FACTS}) == len(FACTS)


def test_the_command_prints_it_or_writes_it(tmp_path, capsys):
    sequence_file.save(sequence(), tmp_path / "a.h5")
    assert main(["card", str(tmp_path / "a.h5")]) == 0
    printed = capsys.readouterr().out
    assert printed == markdown(card_of(sequence()))
    assert main(["card", str(tmp_path / "a.h5"), "--out", str(tmp_path / "card.md")]) == 0
    assert (tmp_path / "card.md").read_text() == printed
    assert main(["card", str(tmp_path / "none.h5")]) == 1


def test_a_spread_that_could_not_be_measured_is_unknown():
    none = dict.fromkeys(("spread_cm", "pushed_cm", "finer_cm", "push_growth", "chaotic"))
    card = card_of(sequence(ensemble=none))
    assert "spread" not in card.numbers and "Not measured: spread." in flaws(card)
    assert "unknown beside every error" in markdown(
        card
    ) and "Whether the cloth forgets a push is not known" in markdown(card)


@pytest.mark.parametrize(
    ("growth", "says"),
    [(0.2, "**contracting**: a push of 1 mm is 0.2 mm"), (14.4, "**chaotic**: a push of 1 mm is 14 mm")],
)
def test_a_card_says_whether_the_scene_is_contracting_or_chaotic(growth, says):
    assert says in markdown(card_of(sequence(ensemble__push_growth=growth)))


def test_one_run_is_no_flaw_of_what_is_trained_on():
    train = sequence(split="train", ensemble={}, runs=[])
    assert not any("Not measured" in flaw for flaw in flaws(card_of(train)))
