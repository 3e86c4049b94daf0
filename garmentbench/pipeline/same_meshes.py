"""Do sequences have the same garment and body meshes? A trained method predicts no other garment than its own."""

from typing import Any

from garmentbench.errors import UserError
from garmentbench.sequence import Sequence
from garmentbench.storage.fingerprint import content_hash
from garmentbench.storage.runs import Run


class OtherGarmentError(UserError):
    """A method would have to predict another garment than the one it was trained on."""


def garment_mesh(sequence: Sequence) -> dict[str, Any]:
    """Which garment mesh a sequence has: name, number of vertices, and a hash of the faces."""
    garment = sequence.template.garment
    return {
        "name": garment.name,
        "vertices": len(garment.rest),
        "faces": content_hash(garment.faces),
    }


def require_garment(trained: Run, garment: dict[str, Any], scene: str, sequence: Sequence) -> None:
    """Raises `OtherGarmentError` where a method would have to predict another garment than it was trained on."""
    found = garment_mesh(sequence)
    if (found["vertices"], found["faces"]) != (garment["vertices"], garment["faces"]):
        raise OtherGarmentError(
            f"{trained.identity['method']} was trained on {', '.join(trained.identity['train_scenes'])} "
            f"({garment['name']}, {garment['vertices']} vertices), but {scene} has another garment "
            f"({found['name']}, {found['vertices']} vertices)"
        )


def require_same_meshes(first: str, one: Sequence, second: str, other: Sequence) -> None:
    """Raises `UserError` where two training sequences have different garment or body meshes."""

    def body_mesh(sequence: Sequence) -> dict[str, Any]:
        body = sequence.template.body
        if body is None:
            return {"name": "none", "vertices": 0, "faces": ""}
        return {"name": body.kind, "vertices": len(body.rest), "faces": content_hash(body.faces)}

    for part, mesh, same in (
        ("garment", garment_mesh, ("vertices", "faces")),
        ("body", body_mesh, ("name", "vertices", "faces")),
    ):
        mine, theirs = mesh(one), mesh(other)
        if any(mine[key] != theirs[key] for key in same):
            raise UserError(
                f"train: the {part} of {first} ({mine['name']}, {mine['vertices']} vertices) is not that of {second} "
                f"({theirs['name']}, {theirs['vertices']} vertices); give training scenes that share the meshes"
            )
