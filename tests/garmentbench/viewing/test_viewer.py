"""A real viewer, without a window, opens a recording: no view reports an error, and something is drawn."""

import io
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request

import numpy as np
import pytest
from rerun.experimental import ViewerClient

from garmentbench.errors import UserError
from garmentbench.evaluation.rollout import ROLL_OUT, RollOut
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.paths import PACKAGE
from garmentbench.viewing.recording import write_recording
from garmentbench.viewing.viewer import open_viewer, viewer_program

SECONDS = 15.0


def free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


@pytest.fixture(scope="module")
def viewer():
    """A headless viewer; without a Vulkan driver it ends as soon as it has started."""
    os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")
    subprocess.run([viewer_program(), "analytics", "disable"], capture_output=True, check=False)
    try:
        client = ViewerClient.spawn(headless=True, port=free_port(), executable_path=viewer_program())
        time.sleep(1.0)
        client.get_state()
    except (RuntimeError, ConnectionError) as e:
        pytest.skip(f"no headless viewer starts here, as without a Vulkan driver (Debian: mesa-vulkan-drivers): {e}")
    yield client
    client.quit(timeout=2.0)


def wait_for(condition, what: str):
    """The first true value that `condition` gives."""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.2)
    pytest.fail(f"{what}: not within {SECONDS:g} s")


def picture(client: ViewerClient, view_id: str) -> np.ndarray:
    from matplotlib.image import imread

    return imread(io.BytesIO(client.take_screenshot(view_id)))[..., :3]


def test_the_viewer_opens_a_recording_on_its_blueprint(viewer, tmp_path):
    sequence = tiny_sequence(40)
    garment = sequence.garment + np.float32(0.01)
    roll_out = RollOut(ROLL_OUT, 3, garment, None, np.ones((40, 3)))
    write_recording(tmp_path / "recording.rrd", sequence, roll_out, "test")
    viewer.open(str(tmp_path / "recording.rrd"))
    views = wait_for(lambda: viewer.get_state().views, "the viewer lays out its views")
    assert {v.name for v in views} == {
        "reference (left), prediction (right)",
        "what is shown",
        "error [cm]",
        "interpenetration [%]",
        "time a frame [ms]",
    }
    viewer.set_time("frame", sequence=20)
    scene = next(v for v in views if v.view_class == "3D")

    def both_drawn() -> bool:
        red, _, blue = np.moveaxis(picture(viewer, scene.view_id), -1, 0)
        return (blue > red + 0.15).mean() > 0.01 and (
            red > blue + 0.15
        ).mean() > 0.01  # blue reference, pale prediction

    wait_for(both_drawn, "reference and prediction are drawn")
    assert [r for v in viewer.get_state().views for r in v.reports] == []


@pytest.fixture
def recording(tmp_path):
    sequence = tiny_sequence(8)
    roll_out = RollOut(ROLL_OUT, 3, sequence.garment, None, np.ones((8, 3)))
    write_recording(tmp_path / "recording.rrd", sequence, roll_out, "test")
    return tmp_path / "recording.rrd"


def test_without_a_display_the_user_is_told_where_the_file_is_and_how_to_see_it(recording, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(UserError, match=rf"{recording}: no display.*--web"):
        open_viewer(recording)


def test_a_browser_is_served_until_ctrl_c(recording):
    code = "from pathlib import Path; from garmentbench.viewing.viewer import serve_recording; "
    code += f"serve_recording(Path({str(recording)!r}))"
    env = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    process = subprocess.Popen([sys.executable, "-c", code], env=env, stdout=subprocess.PIPE, text=True)
    address = process.stdout.readline().split("?")[0]

    def answers() -> bool:
        try:
            return urllib.request.urlopen(address, timeout=2).status == 200
        except OSError:
            return False

    wait_for(answers, "the page is served")
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 0
    wait_for(lambda: not answers(), "the server ends with its command")
