"""A plain table on the terminal, whole lines also where there is no terminal."""

from typing import Any


def print_table(rows: list[dict[str, Any]]) -> None:
    """Print rows that have the same keys, which head the columns."""
    if not rows:
        return
    cells = [list(rows[0])] + [[_text(v) for v in row.values()] for row in rows]
    widths = [max(len(line[i]) for line in cells) for i in range(len(cells[0]))]
    for line in cells:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip())


def _text(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
