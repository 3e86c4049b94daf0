"""garmentbench: how well, how fast and how stably a method predicts a garment's motion from the body's motion.

Every public name is importable from here, and is loaded when it is first asked for: `import garmentbench` loads
neither numpy nor torch.

    import garmentbench as gb

    size = gb.preset("smoke")
    test = gb.load_sequence(gb.make_reference(gb.load_scene("tshirt-armspace-90"), size).path)
    rows = gb.score(roll := gb.roll_out(method, test), None, test)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:  # what type checkers and editors see; `_HOME` is what runs, and a test keeps both the same
    from garmentbench.errors import UserError as UserError
    from garmentbench.evaluation.check_method import Report as Report
    from garmentbench.evaluation.check_method import check_method as check_method
    from garmentbench.evaluation.check_method import parametrize_with_checks as parametrize_with_checks
    from garmentbench.evaluation.rollout import RollOut as RollOut
    from garmentbench.evaluation.rollout import one_step as one_step
    from garmentbench.evaluation.rollout import roll_out as roll_out
    from garmentbench.evaluation.score import score as score
    from garmentbench.evaluation.toy import tiny_sequence as tiny_sequence
    from garmentbench.geometry.blend_skinning import Skin as Skin
    from garmentbench.geometry.blend_skinning import SkinOf as SkinOf
    from garmentbench.geometry.blend_skinning import lift as lift
    from garmentbench.geometry.blend_skinning import place as place
    from garmentbench.geometry.seed_features import seed_features as seed_features
    from garmentbench.method import BodyFrame as BodyFrame
    from garmentbench.method import FitRun as FitRun
    from garmentbench.method import History as History
    from garmentbench.method import Method as Method
    from garmentbench.method import span as span
    from garmentbench.metrics import METRICS as METRICS
    from garmentbench.metrics import Metric as Metric
    from garmentbench.pipeline.choice import MethodChoice as MethodChoice
    from garmentbench.pipeline.choice import choose_method as choose_method
    from garmentbench.pipeline.evaluate import evaluate as evaluate
    from garmentbench.pipeline.train import train as train
    from garmentbench.pipeline.train import training_run as training_run
    from garmentbench.reference import SequenceFile as SequenceFile
    from garmentbench.reference import make_reference as make_reference
    from garmentbench.scenes.presets import Preset as Preset
    from garmentbench.scenes.presets import preset as preset
    from garmentbench.scenes.scene import Scene as Scene
    from garmentbench.scenes.wardrobe import load_scene as load_scene
    from garmentbench.scenes.wardrobe import scene_names as scene_names
    from garmentbench.sequence import Body as Body
    from garmentbench.sequence import Garment as Garment
    from garmentbench.sequence import Sequence as Sequence
    from garmentbench.sequence import Template as Template
    from garmentbench.sequence_file import load as load_sequence  # noqa: F401
    from garmentbench.sequence_file import save as save_sequence  # noqa: F401
    from garmentbench.storage.runs import Run as Run
    from garmentbench.storage.runs import RunStore as RunStore

# The module of each public name, with its name there where that is another.
_HOME = {
    "UserError": "errors",
    "Report": "evaluation.check_method",
    "check_method": "evaluation.check_method",
    "parametrize_with_checks": "evaluation.check_method",
    "RollOut": "evaluation.rollout",
    "one_step": "evaluation.rollout",
    "roll_out": "evaluation.rollout",
    "score": "evaluation.score",
    "tiny_sequence": "evaluation.toy",
    "Skin": "geometry.blend_skinning",
    "SkinOf": "geometry.blend_skinning",
    "lift": "geometry.blend_skinning",
    "place": "geometry.blend_skinning",
    "seed_features": "geometry.seed_features",
    "BodyFrame": "method",
    "FitRun": "method",
    "History": "method",
    "Method": "method",
    "span": "method",
    "METRICS": "metrics",
    "Metric": "metrics",
    "MethodChoice": "pipeline.choice",
    "choose_method": "pipeline.choice",
    "evaluate": "pipeline.evaluate",
    "train": "pipeline.train",
    "training_run": "pipeline.train",
    "SequenceFile": "reference",
    "make_reference": "reference",
    "Preset": "scenes.presets",
    "preset": "scenes.presets",
    "Scene": "scenes.scene",
    "load_scene": "scenes.wardrobe",
    "scene_names": "scenes.wardrobe",
    "Body": "sequence",
    "Garment": "sequence",
    "Sequence": "sequence",
    "Template": "sequence",
    "load_sequence": "sequence_file:load",
    "save_sequence": "sequence_file:save",
    "Run": "storage.runs",
    "RunStore": "storage.runs",
}

__all__ = list(_HOME)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'garmentbench' has no attribute '{name}'")
    module, _, attribute = _HOME[name].partition(":")
    value = getattr(import_module(f"garmentbench.{module}"), attribute or name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
