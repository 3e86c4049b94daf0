"""The methods, by the names that the tables use. A method's module is imported only when it is asked for."""

import importlib
from importlib.metadata import entry_points

from garmentbench.errors import FOREIGN, UsageError, described_import, unknown_name

METHODS = {
    "skinning": "garmentbench.methods.baselines.skinning:Skinning",
    "hold": "garmentbench.methods.baselines.hold:Hold",
    "constant_velocity": "garmentbench.methods.baselines.constant_velocity:ConstantVelocity",
    "nearest": "garmentbench.methods.baselines.nearest:Nearest",
    "linear_subspace": "garmentbench.methods.baselines.linear_subspace:LinearSubspace",
    "static_ridge": "garmentbench.methods.baselines.static_ridge:StaticRidge",
    "subspace_network": "garmentbench.methods.baselines.subspace_network:SubspaceNetwork",
    "linear_memory": "garmentbench.methods.baselines.linear_memory:LinearMemory",
    "pose_gru": "garmentbench.methods.baselines.pose_gru:PoseGru",
    "tuned": "garmentbench.methods.tuned:Tuned",
    "motion_guided": "garmentbench.methods.motion_guided:MotionGuided",
}
ENTRY_POINTS = "garmentbench.methods"  # the group by which an installed package offers its methods


def method_names() -> dict[str, str]:
    """Names of all methods and their "module:Class", those of installed packages among them."""
    return {e.name: e.value for e in entry_points(group=ENTRY_POINTS)} | METHODS


def load_method(name: str) -> type:
    """The class of a method by its name, or by "module:Class".

    Raises `UsageError`, with the nearest name, for an unknown one, and for what can't be imported.
    """
    known = method_names()
    target = name if ":" in name else known.get(name)
    if target is None:
        raise unknown_name("method", name, list(known))
    module, _, attribute = target.partition(":")
    if not module or not attribute:
        raise UsageError(f"method '{name}': wanted a method's name or \"module:Class\"")
    try:
        imported = importlib.import_module(module)
    except FOREIGN as e:  # a module may be anybody's, and raise anything
        if isinstance(e, ModuleNotFoundError) and f"{module}.".startswith(f"{e.name}."):  # it, not one that it imports
            top = module.partition(".")[0]
            do = f"install the package that has it, or run in the folder of {top}.py"
            raise UsageError(f"method '{name}': no module named '{e.name}'; {do}") from e
        raise UsageError(f"method '{name}': {described_import(e, module)}; mend it") from e
    try:
        return getattr(imported, attribute)
    except AttributeError as e:
        raise UsageError(f"method '{name}': {e}; wanted \"module:Class\"") from e
