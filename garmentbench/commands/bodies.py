"""The command about bodies."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tyro.conf import Positional

from garmentbench.commands.table import print_table
from garmentbench.errors import UsageError


@dataclass(frozen=True)
class Bodies:
    """List the bodies, export one to model a garment on, or bake one of your own. Baking needs `pip install anny`.

    An exported body stands in its rest pose, in metres, z up, facing -y; garments are modelled on base, whichever body
    wears them later.

    Example: garmentbench bodies
    Example: garmentbench bodies export base body.obj
    Example: garmentbench bodies bake --name mine --gender 0.2 --weight 0.7

    Attributes:
        action: list, export or bake.
        export: With export: the body's name, and the file to write (.obj or .ply).
        size: With export: full (13,348 vertices) or small (5,414).
        name: With bake: what scenes will call it.
        gender: 0 male, 1 female.
        age: 0.667 is a young adult; 0.5 is a child.
        muscle: From 0 to 1, as the following; 0.5 is the mean.
        weight: 0.15 is slim, 0.9 heavy.
        height: 0.35 is 1.67 m, 0.5 is 1.84 m, 0.6 is 1.95 m.
        proportions: From uncommon to ideal.
    """

    action: Positional[Literal["list", "export", "bake"]] = "list"
    export: Positional[tuple[str, ...]] = ()
    size: Literal["full", "small"] = "full"
    name: str = ""
    gender: float = 0.5
    age: float = 0.667
    muscle: float = 0.5
    weight: float = 0.5
    height: float = 0.5
    proportions: float = 0.5

    def run(self) -> None:
        if self.export and self.action != "export":
            raise UsageError(
                f"bodies {self.action}: what to do with '{self.export[0]}'? See garmentbench bodies --help"
            )
        {"list": _list, "export": self._export, "bake": self._bake}[self.action]()

    def _export(self) -> None:
        from garmentbench.importing.meshes.exporting import export_body
        from garmentbench.scenes.bodies import load_body

        if len(self.export) != 2:
            raise UsageError("bodies export: which body, and where to? garmentbench bodies export base body.obj")
        name, path = self.export
        export_body(load_body(name, self.size), Path(path))
        print(f"{path}: the body {name} in its rest pose, metres, z up")

    def _bake(self) -> None:
        from garmentbench.scenes.anny_bodies import Phenotype, bake_body

        if not self.name:
            raise UsageError("bodies bake: what shall it be called? --name mine")
        shape = Phenotype(self.gender, self.age, self.muscle, self.weight, self.height, self.proportions)
        for path in bake_body(self.name, shape):
            print(path)
        print(f'a scene wears it with body = "{self.name}"')


def _list() -> None:
    import numpy as np
    from trimesh import Trimesh

    from garmentbench.scenes.bodies import body_names, load_body

    rows = []
    for name in body_names():
        body = load_body(name, "small").body
        litres = 1000 * Trimesh(body.rest, body.faces, process=False).volume
        rows.append({"body": name, "height [m]": float(np.ptp(body.rest[:, 2])), "volume [l]": float(litres)})
    print_table(rows)
