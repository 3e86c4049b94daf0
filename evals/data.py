"""Data cards of all sequences that were used: rows of results.csv, a table of them, a file each."""

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from garmentbench.evals.experiment import Companion, Work
from garmentbench.evaluation.results import Row
from garmentbench.metrics.push_growth import regime
from garmentbench.reference import Source
from garmentbench.report.card import FACTS, Card, read_card
from garmentbench.report.card_text import flaws, markdown
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.lines import REFERENCE, Frame
from garmentbench.report.table import NOTICE, Cell, Table
from garmentbench.scenes.presets import Preset
from garmentbench.storage.jobs import Failure

if TYPE_CHECKING:
    from garmentbench.report.lines import Results
    from garmentbench.report.page import Section

DATA = "data"
FOLDER = "cards"
_COLUMNS = (  # of the table: a fact, its title, whether it is a whole number
    ("frames", "frames", True),
    ("garment_vertices", "garment vertices", True),
    ("ms_per_frame", "cost [ms a frame]", False),
    ("spread", "spread [cm]", False),
    ("interpenetration_strict", "inside, strict [%]", False),
    ("faces_inside", "faces inside [%]", False),
    ("skin_frames", "frames with skin through [%]", False),
    ("self_intersection", "crossing faces [%]", False),
)


class Cards(Companion):
    """A card of each sequence that the experiments beside it have."""

    def beside(self, sources: Iterable[Source], preset: Preset) -> Work:
        names = [source.name for source in sources]

        def rows(results: dict) -> list[Row]:
            made = [path for name in names if not isinstance(path := results["sequence", name], Failure)]
            return [row for path in made for row in card_rows(read_card(path))]

        return Work({}, rows)

    def sections(self, results: "Results") -> "list[Section]":
        from garmentbench.report.page import Section

        cards = cards_in(results.table)
        return [Section(data_table(cards, self.title), files=card_files(cards))]


CARDS = Cards(name=DATA, table=DATA, title="Data")


def card_rows(card: Card) -> list[Row]:
    """A card as rows of results.csv: one a fact that was measured."""
    names = {key: getattr(card, key) for key in ("preset", "scene", "split", "garment", "motion", "body")}
    columns = Row(experiment=DATA, method=REFERENCE, variant="full", status=card.status, **names)
    units = {fact.name: fact.unit or "1" for fact in FACTS}
    return [replace(columns, metric=name, value=value, unit=units[name]) for name, value in card.numbers.items()]


def cards_in(results: Frame) -> list[Card]:
    """The cards of results.csv, training data first, by name."""
    rows = results[results.experiment == DATA]
    names = ("scene", "preset", "split", "garment", "motion", "body")
    cards = []
    for _, group in rows.groupby("scene", sort=True):
        first = group.iloc[0]
        numbers = dict(zip(group.metric, group.value.astype(float), strict=True))
        about: dict[str, Any] = {name: str(first[name]) for name in names}
        cards.append(Card(**about, numbers=numbers, status=str(first.status)))
    return sorted(cards, key=lambda card: (card.split != "train", card.scene))


def card_files(cards: list[Card]) -> dict[str, bytes]:
    """The cards' files, by their paths in the report's folder."""
    return {f"{FOLDER}/{card.scene}.md": f"<!-- {NOTICE} -->\n\n{markdown(card)}".encode() for card in cards}


def data_table(cards: list[Card], title: str = "Data") -> Table:
    """All sequences that the report is about, with what limits the trust in them."""
    rows = []
    for card in cards:
        values = [(card.numbers.get(name), whole) for name, _, whole in _COLUMNS]
        cells = [Cell(ABSENT if value is None else number(value, whole)) for value, whole in values]
        cells.append(Cell(regime(card.numbers["push_growth"]) if "push_growth" in card.numbers else ABSENT))
        rows.append([Cell(card.scene), Cell(card.split), *cells, Cell(str(len(flaws(card))))])
    return Table(
        DATA,
        title,
        "The reference simulations behind everything above, each with a data card that says what it is, what it cost, "
        "how far it can be relied on, what is known to be wrong with it, and how to evaluate on it. Spread: how far "
        "two runs of a test scene are apart. A push of 1 mm is forgotten where cloth is contracting, and grows where "
        "it is chaotic.",
        ["sequence", "split", *(title for _, title, _ in _COLUMNS), "a push", "known flaws"],
        rows,
        frozenset({0, 1, 2 + len(_COLUMNS)}),
    )
