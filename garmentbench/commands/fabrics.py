"""The command about fabrics."""

from dataclasses import dataclass

from garmentbench.commands.table import print_table


@dataclass(frozen=True)
class Fabrics:
    """List the fabrics that a garment's material may name, material = {fabric = "denim"}, and what they amount to.

    Where the numbers come from stands in datasets/fabrics.toml.

    Example: garmentbench fabrics
    """

    def run(self) -> None:
        from garmentbench.scenes.fabrics import fabrics

        rows = []
        for name, f in fabrics().items():
            drape = None if f.drape is None else "{:g} to {:g}".format(*f.drape)
            values = {"fabric": name, "g/m2": 1e3 * f.density, "E t [N/m]": f.young}
            values |= {"bending [uN m]": 1e6 * f.material["bending"], "friction": f.friction, "drape [%]": drape}
            rows.append(values | {"basis": f.basis, "about": f.about})
        print_table(rows)
