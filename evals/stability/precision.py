"""Networks in another precision than the one they were trained in.

bfloat16 is torch's automatic mixed precision: products in bfloat16, sums that need it in float32. float64 is all of it:
weights, buffers and whatever is computed from them.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import torch
from torch import Tensor, nn
from torch.overrides import TorchFunctionMode

from garmentbench.evals.stability.course import Precision


def has_network(method: Any) -> bool:
    """Does a trained method compute anything with a network of torch's?"""
    found: list[nn.Module] = []

    def note(module: nn.Module) -> nn.Module:
        found.append(module)
        return module

    _through(method, note, lambda tensor: tensor, set())
    return any(True for module in found for _ in module.parameters())


@contextmanager
def computing(method: Any, precision: Precision | None) -> Iterator[None]:
    """Inside, a trained method's networks compute in this precision; with float64 they do from then on."""
    if precision == "bfloat16":
        device = "cuda" if torch.cuda.is_available() else "cpu"
        with torch.autocast(device, torch.bfloat16), _OneType():
            yield
    elif precision == "float64":
        _through(method, lambda module: module.double(), _doubled, set())
        with _OneType():
            yield
    else:
        yield


class _OneType(TorchFunctionMode):
    """Floating-point numbers of different types meet in the wider one, or in that of what is changed in place: a
    method's inputs are float32 whatever its weights are. NumPy knows no bfloat16."""

    def __torch_function__(
        self, func: Callable, types: Any, args: tuple = (), kwargs: dict[str, Any] | None = None
    ) -> Any:
        kwargs, name = kwargs or {}, getattr(func, "__name__", "")
        kinds = [t.dtype for t in _tensors([*args, *kwargs.values()]) if t.dtype.is_floating_point]
        if name == "numpy" and kinds == [torch.bfloat16]:
            return func(args[0].float(), *args[1:], **kwargs)
        if len(set(kinds)) > 1 and name != "to":
            in_place = name.endswith("_") and not name.endswith("__")
            kind = args[0].dtype if in_place else max(kinds, key=lambda k: torch.finfo(k).bits)
            args = _as(kind, args)
            kwargs = {key: _as(kind, value) for key, value in kwargs.items()}
        return func(*args, **kwargs)


def _tensors(values: list | tuple) -> Iterator[Tensor]:
    for value in values:
        if isinstance(value, Tensor):
            yield value
        elif isinstance(value, list | tuple):
            yield from _tensors(value)


def _as(kind: torch.dtype, value: Any) -> Any:
    if isinstance(value, Tensor):
        return value.to(kind) if value.dtype.is_floating_point else value
    if type(value) in (list, tuple):
        return type(value)(_as(kind, v) for v in value)
    return value


def _doubled(tensor: Tensor) -> Tensor:
    return tensor.double() if tensor.dtype.is_floating_point else tensor


def _through(
    thing: Any, module: Callable[[nn.Module], nn.Module], tensor: Callable[[Tensor], Tensor], seen: set[int]
) -> Any:
    """What a thing becomes where everything in it, however deep, that is a module or a tensor is changed by these."""
    if isinstance(thing, Tensor):
        return tensor(thing)
    if id(thing) in seen:
        return thing
    seen.add(id(thing))
    if isinstance(thing, nn.Module):
        return module(thing)
    if isinstance(thing, list):
        return [_through(value, module, tensor, seen) for value in thing]
    if type(thing) is tuple:
        return tuple(_through(value, module, tensor, seen) for value in thing)
    if type(thing).__module__.startswith("garmentbench.") and hasattr(thing, "__dict__"):
        for name, value in vars(thing).items():
            changed = _through(value, module, tensor, seen)
            if changed is not value:
                object.__setattr__(thing, name, changed)  # some are frozen
    return thing
