"""Data cards in results.csv and from it: rows of experiment "data", a table of all sequences, a file each."""

from typing import TYPE_CHECKING

from garmentbench.report.card import FACTS, Card
from garmentbench.report.card_text import flaws, markdown
from garmentbench.report.cells import ABSENT, number
from garmentbench.report.lines import REFERENCE
from garmentbench.report.table import NOTICE, Cell, Table

if TYPE_CHECKING:
    import pandas

DATA = "data"
FOLDER = "cards"
_COLUMNS = (  # of the table: a fact, its title, whether it is a whole number
    ("frames", "frames", True),
    ("garment_vertices", "garment vertices", True),
    ("ms_per_frame", "cost [ms a frame]", False),
    ("uncertainty", "uncertainty [cm]", False),
    ("interpenetration_strict", "inside, strict [%]", False),
    ("self_intersection", "crossing faces [%]", False),
)


def card_rows(card: Card) -> list[dict]:
    """A card as rows of results.csv: one a fact that was measured."""
    about = {"experiment": DATA, "method": REFERENCE, "variant": "full", "seed": 0, "status": card.status}
    about |= {key: getattr(card, key) for key in ("preset", "scene", "split", "garment", "motion", "body")}
    units = {fact.name: fact.unit or "1" for fact in FACTS}
    return [about | {"metric": name, "value": value, "unit": units[name]} for name, value in card.numbers.items()]


def cards_in(results: "pandas.DataFrame") -> list[Card]:
    """The cards of results.csv, training data first, by name."""
    rows = results[results.experiment == DATA]
    names = ("scene", "preset", "split", "garment", "motion", "body")
    cards = []
    for _, group in rows.groupby("scene", sort=True):
        first = group.iloc[0]
        numbers = dict(zip(group.metric, group.value.astype(float), strict=True))
        cards.append(Card(*(str(first[name]) for name in names), numbers, status=str(first.status)))
    return sorted(cards, key=lambda card: (card.split != "train", card.scene))


def card_files(cards: list[Card]) -> dict[str, bytes]:
    """The cards' files, by their paths in the report's folder."""
    return {f"{FOLDER}/{card.scene}.md": f"<!-- {NOTICE} -->\n\n{markdown(card)}".encode() for card in cards}


def data_table(cards: list[Card]) -> Table:
    """All sequences that the report is about, with what limits the trust in them."""
    rows = []
    for card in cards:
        values = [(card.numbers.get(name), whole) for name, _, whole in _COLUMNS]
        cells = [Cell(ABSENT if value is None else number(value, whole)) for value, whole in values]
        rows.append([Cell(card.scene), Cell(card.split), *cells, Cell(str(len(flaws(card))))])
    return Table(
        DATA,
        "Data",
        "The reference simulations behind everything above, each with a data card that says what it is, what it cost, how far it "
        "can be relied on, what is known to be wrong with it, and how to evaluate on it.",
        ["sequence", "split", *(title for _, title, _ in _COLUMNS), "known flaws"],
        rows,
        frozenset({0, 1}),
    )
