"""The data card of a sequence as Markdown, always in the same form; and its known flaws, by what was measured."""

import math

from garmentbench.evaluation.score import SHORT_HORIZON
from garmentbench.method import HISTORY
from garmentbench.metrics.push_growth import regime
from garmentbench.report.card import COST, FACTS, NEEDS_INSIDE, SECTIONS, SPREAD, YES_NO, Card, Fact

LIMITS = (  # what makes a flaw: a fact, the most it may be, and how it is said
    ("interpenetration_strict", 0.1, "{0:.2g} % of the garment's vertices lie inside the body, more than {1:g} %."),
    ("skin_frames", 2.0, "In {0:.0f} % of the frames skin is more than 0.5 mm through, more than {1:g} %."),
    ("spread", 1.0, "Two runs of it are {0:.2g} cm apart, more than {1:g} cm."),
    ("runs_broken", 0.0, "{0:.0f} of its further runs broke."),
    (
        "strain_p99_max",
        10.0,
        "In some frame 1 % of the edges are strained by more than {0:.0f} %, and {1:g} % is much for cloth.",
    ),
    ("self_intersection", 0.0, "{0:.2g} % of the faces pass through another."),
)
_NOTES = {
    SPREAD: "How far runs of the same scene are apart that differ by nothing that matters: mean distance over "
    "vertices and frames.",
}

_PURPOSE = {  # of a split
    "train": "- It is for training: an error on it is a training error.",
    "validation": "- It is for choosing settings, and is never reported as a test.",
    "test": "- It is for testing: nothing may be fitted or chosen on it.",
}


def markdown(card: Card) -> str:
    """The card as Markdown."""
    lines = [
        f"# Data card: {card.scene}" + (f" ({card.preset})" if card.preset else ""),
        "",
        "## What",
        "",
        *_what(card),
        "",
    ]
    for section in SECTIONS:
        lines += [f"## {section}", ""]
        lines += [_NOTES[section], ""] if section in _NOTES else []
        lines += ["| | |", "|---|---:|", *(_row(card, fact) for fact in FACTS if fact.section == section), ""]
        lines += [_whole_time(card), ""] if section == COST else []
        lines += [_regime(card), ""] if section == SPREAD else []
    lines += [
        "## Known flaws",
        "",
        *(f"- {flaw}" for flaw in flaws(card) or ["None of those that are looked for."]),
        "",
    ]
    return "\n".join([*lines, "## How to evaluate on it", "", *_how(card)]) + "\n"


def flaws(card: Card) -> list[str]:
    """What is known to be wrong with a sequence, from what was measured of it."""
    n, found = card.numbers, []
    if card.status not in ("", "ok"):
        found.append(f"The simulation is {card.status} from frame {n.get('first_bad_frame', math.nan):.0f} on.")
    found += filter(None, (flaw(name, n.get(name)) for name, *_ in LIMITS))
    if n.get("self_contact") == 0:
        found.append("The cloth does not touch itself: self-contact is off.")
    if not card.status:
        found.append("How it was made is not known.")
    unmeasured = [
        what
        for name, what in (("spread", "spread"), ("self_intersection", "self-intersection"))
        if name not in n and not (name == "spread" and card.split == "train")  # which is one run on purpose
    ]
    if unmeasured:
        found.append(f"Not measured: {' and '.join(unmeasured)}.")
    return found


def flaw(name: str, value: float | None) -> str | None:
    """How it is said that a measured value is more than it may be (`LIMITS`); None where it is not."""
    return next((t.format(value, limit) for n, limit, t in LIMITS if n == name and (value or 0.0) > limit), None)


def _what(card: Card) -> list[str]:
    names = (("garment", card.garment), ("body", card.body or "none"), ("motion", card.motion), ("split", card.split))
    rows = [f"| {name} | {value} |" for name, value in names]
    made = "simulated by the reference simulator" if card.status else "imported"
    rows += [f"| origin | {made} |", "| units | metres, seconds; z up, the body faces -y; float32 |"]
    return ["| | |", "|---|---|", *rows, *([""] if card.notes else []), *(f"- {note}" for note in card.notes)]


def _whole_time(card: Card) -> str:
    """What all frames cost, in words."""
    if "ms_per_frame" not in card.numbers:
        return "What it cost is not known."
    seconds = card.numbers["ms_per_frame"] * card.numbers["frames"] / 1e3
    time = f"{seconds:.2g} seconds" if seconds < 60 else f"{seconds / 60:.2g} minutes"
    return f"{time} for all frames, in one process; further runs are not counted."


def _regime(card: Card) -> str:
    """Is it contracting or chaotic, in words?"""
    growth = card.numbers.get("push_growth")
    if growth is None:
        return "Whether the cloth forgets a push is not known: no further run says so."
    what = {
        "contracting": "the cloth forgets where it was, and one run can stand for all",
        "chaotic": "no single run can be the truth, and errors are measured against all of them",
    }[regime(growth)]
    return f"The scene is **{regime(growth)}**: a push of 1 mm is {growth:.2g} mm in the last fifth of it; {what}."


def _row(card: Card, fact: Fact) -> str:
    unit = "" if fact.unit in ("", YES_NO) else f" [{fact.unit}]"
    return f"| {fact.label}{unit} | {_value(card, fact)} |"


def _value(card: Card, fact: Fact) -> str:
    value = card.numbers.get(fact.name)
    if fact.name == "depth_p95" and card.numbers.get("interpenetration_strict") == 0:
        return "–"  # the depth of none
    if value is None:
        applies = (
            not (fact.name in NEEDS_INSIDE and card.numbers.get("has_inside") == 0) and fact.name != "first_bad_frame"
        )
        return "not measured" if applies else "–"
    if fact.unit == YES_NO:
        return "yes" if value else "no"
    return f"{value:,.0f}" if value == round(value) else f"{value:.3g}"


def _how(card: Card) -> list[str]:
    n = card.numbers
    frames, spread = n["frames"], n.get("spread")
    preset = f" --preset {card.preset}" if card.preset else ""
    scene = card.scene if card.status else f"{card.scene}.h5"
    train = f"garmentbench train METHOD --scene {scene}{preset}"
    test = f"garmentbench evaluate METHOD --train-scene TRAINING --scene {scene}{preset}"
    horizons = f"{SHORT_HORIZON} and {frames:.0f}" if frames - HISTORY > SHORT_HORIZON else f"{frames:.0f}"
    lines = [
        f"`{train}`" if card.split == "train" else f"`{test}`",
        "",
        _PURPOSE.get(card.split, _PURPOSE["test"]),
        f"- A roll-out begins with the first {HISTORY} frames as they are and is free from then on; its error is "
        f"reported over {horizons} frames.",
        "- A method sees the body up to the present frame only.",
    ]
    lines.append(
        "- Say that its spread is unknown beside every error."
        if spread is None
        else f"- Report the spread beside every error: another run of the simulator errs by {spread:.2g} cm, and a "
        "difference below it means nothing."
    )
    if n.get("has_inside") == 0:
        lines.append("- There is no human body: interpenetration is not reported.")
    return lines
