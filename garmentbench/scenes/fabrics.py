"""Named fabrics, from measurements to what the simulator's cloth is made of.

The simulator's sheet is isotropic. A woven one is not: stiff along its threads, a hundred times softer on the bias,
where they only shear. What stands for it is fixed here, for all fabrics alike and before any drape was simulated:

- E t is that of the mean compliance over all directions (Reuss' mean): cloth is given loads, not strains. A sheet as
  stiff as threads in all directions would be paper: it could bend one way at a time only.
- Bending is the mean of the directions, at the curvature of folds: a KES test gives the rigidity without friction
  between the fibres, which a fold feels as a couple HB = 2HB / 2 (Grosberg 1966, M = HB + B k), so HB / k is added.
- A free strip of our triangles is softer than `bending` says, by 8/9 (flexural Poisson ratio -1/3).
"""

from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal

from msgspec import Meta

from garmentbench import paths
from garmentbench.errors import UsageError, unknown_name
from garmentbench.scenes.material import Number, Positive
from garmentbench.storage.typed_toml import read_toml, typed

FREE_STRIP = 8 / 9  # flexural rigidity of a free strip of equilateral triangles, over `Material.bending`
SPRINGS = 3.0  # `Material.stretch` over the E t of equilateral triangles
FOLD = 50.0  # [1/m] curvature of the folds of a drape test
Band = tuple[Number, Number]


@dataclass(frozen=True, kw_only=True)
class Fabric:
    """A fabric as it was measured.

    Attributes:
        about: Which cloth.
        density: [kg/m^2].
        tension: E t along warp and weft [N/m].
        shear: G t between them [N/m]; None for a sheet without threads, which is alike in all directions.
        bending: Flexural rigidity [N m] of strips: one value, or along warp and weft, or warp, bias and weft.
        hysteresis: 2HB of a KES bending test [N].
        friction: Coulomb's coefficient against skin [1].
        basis: What the numbers are: of one sample, the mean of many, or the middle of published ranges.
        source: Where they come from.
        drape: Band of the measured Cusick coefficient [%], and where that comes from.
    """

    about: str
    density: Positive
    tension: tuple[Positive, Positive]
    shear: Positive | None = None
    bending: Annotated[tuple[Positive, ...], Meta(min_length=1, max_length=3)]
    hysteresis: Number = 0.0
    friction: Number
    basis: Literal["one sample", "mean of many", "typical"]
    source: str
    drape: Band | None = None
    drape_source: str = ""

    @property
    def young(self) -> float:
        """E t of the isotropic sheet that stands for it [N/m].

        At an angle a to the warp 1/E = c^4/E1 + s^4/E2 + c^2 s^2/G, without Poisson's ratio, which is not measured; the
        mean over all angles is 3/8 (1/E1 + 1/E2) + 1/8 1/G.
        """
        warp, weft = self.tension
        return warp if self.shear is None else 8 / (3 / warp + 3 / weft + 1 / self.shear)

    @property
    def rigidity(self) -> float:
        """Flexural rigidity of a free strip [N m], mean of the directions, at the curvature of folds."""
        weights = (1, 2, 1) if len(self.bending) == 3 else (1,) * len(self.bending)
        mean = sum(w * b for w, b in zip(weights, self.bending, strict=True)) / sum(weights)
        return mean + self.hysteresis / 2 / FOLD

    @property
    def material(self) -> dict[str, float]:
        """The keys of `Material` that it decides."""
        return {
            "density": self.density,
            "stretch": SPRINGS * self.young,
            "bending": self.rigidity / FREE_STRIP,
            "friction": self.friction,
        }


@cache
def fabrics() -> dict[str, Fabric]:
    """All fabrics by name."""
    table = read_toml(paths.FABRICS)
    return {name: typed(entry, Fabric, f"{paths.FABRICS}: {name}") for name, entry in table.items()}


def fabric(name: str, where: str = "") -> Fabric:
    """The fabric of that name. Raises `UsageError` with the nearest names, in a line that begins with `where`."""
    if name not in fabrics():
        raise unknown_name("fabric", name, fabrics(), where)
    return fabrics()[name]


def resolved(material: Any, where: str) -> Any:
    """A material's table with its fabric's values in place of the fabric's name; keys beside it override those.

    What is no table is given back: `typed` complains of it. Raises `UsageError`, beginning with `where`.
    """
    if not isinstance(material, dict) or "fabric" not in material:
        return material
    name = material["fabric"]
    if not isinstance(name, str):
        raise UsageError(f"{where}material.fabric is {name!r}; wanted the name of a fabric, see `garmentbench fabrics`")
    return fabric(name, where).material | {key: value for key, value in material.items() if key != "fabric"}
