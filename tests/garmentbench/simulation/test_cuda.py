"""One code for CPU and CUDA: it compiles for CUDA everywhere, and gives the same where there is a device."""

import importlib

import numpy as np
import pytest
import warp as wp

from garmentbench.scenes.presets import preset
from garmentbench.scenes.scene import Motion, Scene
from garmentbench.simulation.simulate import simulate

ARCHITECTURE = 90  # of Hopper


CONTACTS = [f"contacts.{name}" for name in ("candidates", "sides", "listing", "samples")]


@pytest.mark.parametrize("name", ["integrate", "damping", "contact", "xpbd", *CONTACTS])
def test_compiles_for_cuda_without_a_device(name, tmp_path):
    wp.init()
    if ARCHITECTURE not in wp.get_cuda_supported_archs():
        pytest.skip("this build of Warp has no CUDA compiler")
    module = importlib.import_module(f"garmentbench.simulation.{name}")
    binaries = wp.compile_aot_module(module, arch=ARCHITECTURE, module_dir=tmp_path)
    assert binaries and all(path.stat().st_size > 0 for path in binaries)


def test_cuda_agrees_with_the_cpu():
    wp.init()
    if not wp.is_cuda_available():
        pytest.skip("no CUDA device")
    scene, smoke = Scene("short", "tshirt", "base", Motion("armspace-90"), "test", frames=6), preset("smoke")
    on_cpu, on_cuda = simulate(scene, smoke), simulate(scene, smoke, "cuda:0")
    assert np.linalg.norm(on_cpu.garment - on_cuda.garment, axis=-1).mean() < 1e-3
