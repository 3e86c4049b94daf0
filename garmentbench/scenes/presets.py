"""The three sizes at which everything can be run."""

from dataclasses import dataclass

from garmentbench.errors import unknown_name


@dataclass(frozen=True)
class Preset:
    """One size.

    Attributes:
        name: "smoke", "laptop" or "paper"; also the size of the baked garment and of the method's networks.
        body_size: Which baked body: "small" (about 3,500 vertices) or "full" (13,348).
        frame_limit: No sequence is longer than this, in frames; None for as long as its scene says.
        needs_cuda: Refuse to run without a CUDA device.
    """

    name: str
    body_size: str
    frame_limit: int | None = None
    needs_cuda: bool = False


PRESETS = {
    p.name: p
    for p in (
        Preset("smoke", body_size="small", frame_limit=40),
        Preset("laptop", body_size="small"),
        Preset("paper", body_size="full", needs_cuda=True),
    )
}


def preset(name: str) -> Preset:
    """The preset of that name. Raises `UsageError` with the nearest name."""
    if name not in PRESETS:
        raise unknown_name("preset", name, list(PRESETS))
    return PRESETS[name]
