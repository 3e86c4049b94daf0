"""Which mesh of a file that holds several is the garment, and which the body."""

import re
from pathlib import Path

from garmentbench.importing.meshes.mesh_sequence import refusal
from garmentbench.scenes.roles import WORDS


def choose_part(path: Path, names: list[str], given: str, role: str) -> str:
    """The object or group of an OBJ file that is meant. It is asked for, since a garment may be of several.

    Raises `UserError` as `choose`.
    """
    if given in names:
        return given
    option = "--mesh" if role == "garment" else "--body-mesh"
    listed = ", ".join(n or "(without a name)" for n in names[:8]) + (" ..." if len(names) > 8 else "")
    if given:
        raise refusal(
            path, f"no object is called '{given}' (there are: {listed})", f"give one of these names ({option})"
        )
    found = f"holds {len(names)} objects ({listed}), wanted to know which is the {role}"
    raise refusal(path, found, f"name it, or some of them with commas, or all ({option} NAME)")


def choose(path: Path, names: list[str], prim: str, role: str) -> str | None:
    """The full name of the mesh that is meant.

    Args:
        path: The file.
        names: Full names of its meshes, e.g. "/world/shirt".
        prim: What the user says, a full name or the end of one; "" for nothing.
        role: "garment", "body", or "body if named so".

    Returns:
        The name; None where `role` is "body if named so" and no single mesh is named as a body.

    Raises:
        UserError: No mesh, or no single one, is meant.
    """
    option = "--mesh" if role == "garment" else "--body-mesh"
    listed = ", ".join(names[:8]) + (" ..." if len(names) > 8 else "")
    if not names:
        raise refusal(path, "has no polygon mesh, wanted one", "export the meshes with their faces and baked positions")
    if prim:
        meant = [n for n in names if ("/" + n.strip("/")).endswith("/" + prim.strip("/"))]
        if len(meant) != 1:
            found = f"{len(meant)} meshes are called '{prim}', wanted one (there are: {listed})"
            raise refusal(path, found, f"give the whole name ({option})")
        return meant[0]
    words = re.compile(WORDS[role.split()[0]], re.IGNORECASE)
    named = [n for n in names if words.search(n.rsplit("/", 1)[-1])]
    if len(named) == 1 and (len(names) > 1 or role != "body if named so"):
        return named[0]
    if role == "body if named so":
        return None
    if len(names) == 1:
        return names[0]
    raise refusal(
        path, f"holds {len(names)} meshes ({listed}), wanted to know which is the {role}", f"name it ({option})"
    )
