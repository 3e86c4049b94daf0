"""Launches that are recorded once and replayed: a frame has some 160, and to put each of them together in Python takes
longer than many of them run."""

from collections.abc import Callable

import warp as wp


class Recorded:
    """A stretch of launches, the same whenever it is called: on the same arrays, with the same numbers.

    Args:
        launches: Launches them. A mesh must not be refitted among them: on a CPU that is not recorded.
        device: Warp device.
    """

    def __init__(self, launches: Callable[[], None], device: str) -> None:
        self.launches, self.device = launches, device
        self._loaded, self._graph = False, None

    def __call__(self) -> None:
        """Run them."""
        if not self._loaded:  # the first time, which loads the modules: that can't be done while recording
            self.launches()
            self._loaded = True
            return
        if self._graph is None:
            with wp.ScopedCapture(self.device) as capture:
                self.launches()
            self._graph = capture.graph
        wp.capture_launch(self._graph)
