"""The sizes at which everything can be run: of the meshes, of the network, and the presets, which are pairs of them."""

from dataclasses import dataclass

from garmentbench.errors import unknown_name


@dataclass(frozen=True)
class MeshSize:
    """A size of garment and body.

    Attributes:
        name: "smoke", "laptop", "desktop" or "paper"; baked garments are in files `<garment>-<size>.npz`.
        body_size: Which baked body: "small" (5,414 vertices) or "full" (13,348).
        frame_limit: No sequence is longer than this, in frames; None for as long as its scene says.
    """

    name: str
    body_size: str
    frame_limit: int | None = None

    def limited(self, frames: int) -> int:
        """That many frames, at most the limit."""
        return min(frames, self.frame_limit or frames)


@dataclass(frozen=True)
class Preset:
    """A mesh size and a network size.

    Attributes:
        name: "smoke", "laptop", "desktop" or "paper"; of a mixed one "<mesh>+<model>".
        mesh: The meshes that are simulated, on which methods are trained and tested.
        model: Name of the size of the methods' networks and of their training.
    """

    name: str
    mesh: MeshSize
    model: str

    @property
    def needs_cuda(self) -> bool:
        """Is it hopeless without a CUDA device?"""
        return "paper" in (self.mesh.name, self.model)


MESH_SIZES = {
    size.name: size
    for size in (
        MeshSize("smoke", "small", frame_limit=40),
        MeshSize("laptop", "small"),
        MeshSize("desktop", "full"),
        MeshSize("paper", "full"),
    )
}
PRESETS = {name: Preset(name, mesh, name) for name, mesh in MESH_SIZES.items()}


def preset(name: str, mesh: str | None = None, model: str | None = None) -> Preset:
    """The preset of that name, with another mesh size or network size where one is given.

    >>> preset("laptop", mesh="smoke").name
    'smoke+laptop'

    Raises `UsageError` with the nearest name.
    """
    for kind, given in (("preset", name), ("mesh size", mesh), ("network size", model)):
        if given is not None and given not in PRESETS:
            raise unknown_name(kind, given, list(PRESETS))
    size, network = MESH_SIZES[mesh or name], model or name
    return Preset(size.name if size.name == network else f"{size.name}+{network}", size, network)
