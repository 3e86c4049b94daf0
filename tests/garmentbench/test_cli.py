"""The command line as it is typed.

Names, exit codes, one-line messages, and what is left behind when things go wrong.
"""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import h5py
import pytest

from garmentbench import __version__, paths, sequence_file
from garmentbench.cli import main, parse
from garmentbench.commands import COMMANDS
from garmentbench.errors import UsageError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.reference import IDENTITY, reference_identity
from garmentbench.scenes.presets import preset
from garmentbench.scenes.wardrobe import load_scene
from garmentbench.storage.runs import RunStore

SCENE = 'garment = "tshirt"\nbody = "base"\nmotion = "armspace-75"\nsplit = "train"\nframes = 20\n'


@pytest.fixture
def tiny(home, monkeypatch):
    """A scene whose sequence is there already, a tiny one, and methods that are wrong. The scene's path."""
    (home / "tiny.toml").write_text(SCENE)
    scene = load_scene(str(home / "tiny.toml"))
    sequence = tiny_sequence(20)
    info = {**sequence.info, IDENTITY: reference_identity(scene, preset("smoke"))}
    sequence_file.save(replace(sequence, info=info), paths.sequence_path("smoke", "tiny"))
    monkeypatch.syspath_prepend(Path(__file__).parent)
    return str(home / "tiny.toml")


def typed(capsys, *arguments: str) -> tuple[int, str, list[str]]:
    """Exit code, output and lines of complaint of a command."""
    code = main(arguments)
    out, err = capsys.readouterr()
    return code, out, err.splitlines()


def evaluate(method: str, scene: str) -> tuple[str, ...]:
    scenes = ("--train-scene", scene, "--scene", scene)
    return ("evaluate", f"foreign_methods:{method}", *scenes, "--preset", "smoke", "--frames", "20")


def process(home: Path, *arguments: str, before: str = "") -> subprocess.Popen:
    """The command line in a process of its own, its data in `home`; `before` is run first."""
    code = (
        f"import sys\n{before}\nfrom garmentbench.cli import main\n"
        f"sys.exit(main({['--home', str(home), *arguments]!r}))"
    )
    env = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1] / "helpers"), str(paths.PACKAGE.parent)]),
        "OMP_NUM_THREADS": "1",
    }
    return subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env
    )


@pytest.mark.parametrize(
    "arguments, said",
    [
        (
            ("import-motion", "a.bvh", "--map", "A=pelvis", "--map", "B=neck"),
            "--map is given 2 times; .* as in --map A B",
        ),
        (("import-motion", "a.bvh", "--fps=30", "--fps", "25"), "--fps is given 2 times; wanted once$"),
    ],
)
def test_an_option_that_is_given_twice_is_not_half_dropped(arguments, said):
    with pytest.raises(UsageError, match=said):
        parse(list(arguments))


def test_an_option_for_several_times_may_be_given_several_times():
    assert parse(["train", "hold", "--scene", "a", "--scene", "b"]).scene == ("a", "b")


def test_help_lists_all_commands_and_loads_nothing_heavy():
    code = (
        "import sys\nfrom garmentbench.cli import main\ntry: main(['--help'])\nexcept SystemExit: print(*sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=paths.PACKAGE.parent, check=True
    )
    assert all(name in done.stdout for name in COMMANDS)
    loaded = set(done.stdout[done.stdout.rindex("╯") :].split())
    assert not {"torch", "numpy", "warp", "rerun", "h5py", "matplotlib", "pandas"} & loaded
    assert len(loaded) < 350, "--help is to take less than 0.3 s"


def test_version(capsys):
    assert typed(capsys, "--version") == (0, f"garmentbench {__version__}\n", [])


def test_it_is_a_module_too(home):
    command = [sys.executable, "-m", "garmentbench", "--version"]
    env = os.environ | {"PYTHONPATH": str(paths.PACKAGE.parent)}
    done = subprocess.run(command, capture_output=True, text=True, cwd=home, env=env, check=True)
    assert done.stdout == f"garmentbench {__version__}\n"


@pytest.mark.parametrize("place", ["before", "after", "with =", "in the environment"])
def test_the_home_folder_is_the_user_s_choice(home, capsys, monkeypatch, place):
    words = {
        "before": ("--home", "there", "runs"),
        "after": ("runs", "--home", "there"),
        "with =": ("runs", "--home=there"),
    }
    if place == "in the environment":
        monkeypatch.setenv(paths.HOME_VARIABLE, str(home / "there"))
    code, out, _ = typed(capsys, *words.get(place, ("runs",)))
    assert code == 0 and out == f"no runs in {home / 'there' / 'runs'} yet\n"
    monkeypatch.delenv(paths.HOME_VARIABLE, raising=False)
    assert typed(capsys, "runs")[1] == f"no runs in {home / 'runs'} yet\n"


def test_a_home_that_is_a_file_is_refused(home, capsys):
    (home / "file").write_text("")
    for words, complaint in (
        (("--home", "file"), "is a file; wanted a folder"),
        (("--home",), "--home: wanted a folder"),
    ):
        code, _, lines = typed(capsys, "runs", *words)
        assert code == 2 and len(lines) == 1 and complaint in lines[0]


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_each_command_shows_an_example(name, capsys):
    with pytest.raises(SystemExit) as end:
        main([name, "--help"])
    assert end.value.code == 0
    lines = capsys.readouterr().out.splitlines()
    examples = [line for line in lines if "Example: " in line]
    assert any(line.startswith(f"Example: garmentbench {name}") for line in examples)
    assert all(line.startswith("Example: ") and line.count("Example: ") == 1 for line in examples)


def test_the_help_of_all_says_one_sentence_a_command(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    out = capsys.readouterr().out
    assert out.count("Example: ") == 1 and "Attributes:" not in out and out.count("\n") < 4 * len(COMMANDS)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["simulat", "x"], "unknown command 'simulat': did you mean 'simulate'?"),
        (["frobnicate"], "unknown command 'frobnicate'; `garmentbench --help` lists all"),
        (["scenes", "nonsense"], "unknown scene 'nonsense'; `garmentbench scenes` lists all"),
        (
            ["simulate", "sheet-stick-a", "--nonsense", "1"],
            "unknown option '--nonsense': See garmentbench simulate --help",
        ),
        (["--nonsense"], "Expected one of {scenes"),
        (["simulate", "tshirt-armspce-90"], "unknown scene 'tshirt-armspce-90': did you mean 'tshirt-armspace-90'?"),
        (["simulate"], "which scene?"),
        (["simulate", "sheet-stick-a", "--prset", "smoke"], "unknown option '--prset': did you mean '--preset'?"),
        (["simulate", "sheet-stick-a", "--preset", "smok"], "unknown preset 'smok': did you mean 'smoke'?"),
        (["train", "skining", "--preset", "smoke"], "unknown method 'skining': did you mean 'skinning'?"),
        (
            ["train", "garmentbench.scenes.scene:Scene", "--preset", "smoke"],
            "garmentbench.scenes.scene:Scene: is no method: name: is missing",
        ),
        (["check-method", "no_such_package:Method"], "no module named 'no_such_package'"),
        (["train", "skinning", "--variant", "ful", "--preset", "smoke"], "did you mean 'full'?"),
        (["train", "skinning", "--device", "gpu"], "unknown device 'gpu'"),
        (["train", "skinning", "--frames", "3", "--preset", "smoke"], "3 frames asked for; wanted more than 3"),
        (["train", "skinning", "--seed", "two"], "Error parsing --seed"),
        (["train"], "Missing from garmentbench train"),
        (["evals", "baseline", "--preset", "smoke"], "did you mean 'baselines'?"),
        (["evals", "--seeds", "0"], "--seeds is 0; wanted at least 1"),
        (["runs", "method"], "'method' is no filter; wanted key=value"),
        (["runs", "kind=train", "extra=1", "--comp", "a"], "unknown option '--comp': did you mean '--compare'?"),
        (["view", "evaluate-00"], "unknown run 'evaluate-00'"),
        (["report", "smoke"], "smoke: no such file"),
        (["report", "a.toml", "b"], "report: what to do with 'b'?"),
    ],
)
def test_a_wrong_call_gives_one_line_with_the_nearest_name_and_exit_code_2(home, capsys, arguments, complaint):
    code, out, lines = typed(capsys, *arguments)
    assert code == 2 and len(lines) == 1 and complaint in lines[0] and lines[0].startswith("garmentbench: ")
    assert out == "" and not list(home.iterdir())


def test_the_paper_preset_asks_for_a_cuda_device(home, capsys, monkeypatch):
    monkeypatch.setattr("torch.cuda.is_available", lambda: False)
    for command in (["simulate", "sheet-stick-a"], ["train", "skinning"], ["evaluate", "skinning"], ["evals"]):
        code, _, lines = typed(capsys, *command, "--preset", "paper")
        assert code == 1 and len(lines) == 1
        assert "paper needs a CUDA device" in lines[0] and "--preset laptop needs none" in lines[0]


def test_scenes_lists_and_shows_what_is_left_out(capsys):
    code, out, _ = typed(capsys, "scenes")
    assert code == 0 and "tshirt-armspace-90" in out
    code, out, _ = typed(capsys, "scenes", "sheet-stick-a")
    assert (
        code == 0
        and "left out: part_radii: an object has no parts\n" in out
        and "left out: layers: one garment\n" in out
        and "needs: interaction_force, velocity, pins, self_contact" in out
    )


def test_methods_lists_methods_and_variants(capsys):
    code, out, _ = typed(capsys, "methods")
    assert code == 0 and "linear_subspace" in out and "no_virtual_sample" in out


def test_check_method_tells_what_to_mend(tiny, capsys):
    code, out, lines = typed(capsys, "check-method", "foreign_methods:Good")
    assert code == 0 and out.endswith("foreign_methods:Good: keeps the contract\n") and lines == []
    assert "human: output is finite: passed\n" in out
    code, out, lines = typed(capsys, "check-method", "foreign_methods:NaN")
    assert code == 1 and "at frame 7, 105 of 105 vertices are not finite" in out
    assert lines == ["garmentbench: foreign_methods:NaN: 4 of 50 checks failed, see above"]


def damaged(path: Path, how: str) -> None:
    """Spoil a good sequence file."""
    if how == "truncated":
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    elif how == "foreign":
        path.write_bytes(b"solid cube\n" * 20)
    elif how == "foreign HDF5":
        with h5py.File(path, "w") as file:
            file["x"] = [1]
    elif how == "newer":
        with h5py.File(path, "a") as file:
            file.attrs["schema"] = 99


@pytest.mark.parametrize(
    ("how", "complaint"),
    [
        ("truncated", "truncated"),
        ("foreign", "not an HDF5 file"),
        ("foreign HDF5", "not a garmentbench"),
        ("newer", "update garmentbench"),
        ("missing", "no such file"),
    ],
)
def test_check_says_what_is_wrong_with_a_file(home, capsys, how, complaint):
    path = home / "x.h5"
    if how != "missing":
        sequence_file.save(tiny_sequence(8), path)
        assert typed(capsys, "check", "x.h5")[0] == 0
        damaged(path, how)
    code, out, lines = typed(capsys, "check", "x.h5")
    assert code == 1 and complaint in out and "x.h5" in lines[0] and len(lines) == 1


def test_a_damaged_sequence_is_never_trained_on(tiny, home, capsys, monkeypatch):
    made = []
    monkeypatch.setattr(
        "garmentbench.reference._simulated", lambda scene, *_: made.append(scene.name) or tiny_sequence(20)
    )
    damaged(paths.sequence_path("smoke", "tiny"), "truncated")
    code, _, lines = typed(
        capsys, "train", "foreign_methods:Good", "--scene", tiny, "--preset", "smoke", "--frames", "10"
    )
    assert code == 0 and made == ["tiny"] and "made again now" in lines[0]
    assert len(sequence_file.load(paths.sequence_path("smoke", "tiny"))) == 20


@pytest.mark.parametrize(
    ("method", "status", "message"),
    [
        ("Raises", "failed", "ZeroDivisionError: seventh frame"),
        ("WrongShape", "failed", "shape"),
        ("NaN", "diverged", "not finite"),
    ],
)
def test_a_bad_method_keeps_its_rows_with_its_status(tiny, capsys, method, status, message):
    code, out, lines = typed(capsys, *evaluate(method, tiny))
    assert code == (1 if status == "failed" else 0) and status in out
    assert f"{status} at frame 7 of tiny" in lines[-1] and message in lines[-1]
    run = RunStore().list({"kind": "evaluate"})[0]
    assert run.results["status"] == status and run.results["first_bad_frame"] == 7 and message in run.results["message"]
    rows = {row["metric"]: row for row in run.results["rows"]}
    assert rows["rollout_l2"]["status"] == status and rows["stable_frames"]["first_bad_frame"] == 7


def test_a_good_method_is_trained_and_evaluated_once(tiny, capsys):
    assert typed(capsys, *evaluate("Good", tiny))[0] == 0
    runs = sorted(RunStore().list(), key=lambda r: r.kind, reverse=True)
    assert [r.kind for r in runs] == ["train", "evaluate"] and all(r.finished for r in runs)
    assert {"rollout.h5", "recording.rrd", "run.json"} <= {p.name for p in runs[1].folder.iterdir()}
    told = (paths.PACKAGE / "storage" / "README.md").read_text()
    assert all(f"`{file.name}" in told for run in runs for file in run.folder.iterdir())
    before = [(r.folder / "run.json").stat().st_mtime_ns for r in runs]
    assert typed(capsys, *evaluate("Good", tiny))[0] == 0
    assert [(r.folder / "run.json").stat().st_mtime_ns for r in runs] == before

    code, out, _ = typed(capsys, "runs", "kind=evaluate", "method=good")
    assert code == 0 and runs[1].id in out and runs[0].id not in out
    code, out, _ = typed(capsys, "runs", "--compare", runs[0].id, runs[1].id)
    assert code == 0 and "identity.trained" in out and "rollout_l2" in out
    assert typed(capsys, "view", runs[0].id)[0] == 2  # a training has no recording


def test_a_method_whose_training_raises(tiny, capsys):
    code, _, lines = typed(capsys, *evaluate("FitRaises", tiny))
    assert code == 1 and len(lines) == 1 and "fit raised ZeroDivisionError: no data (" in lines[0]
    assert "foreign_methods.py:" in lines[0]
    run = RunStore().list()[0]
    assert run.state == "failed" and run.failure in lines[0] and "Traceback" in (run.folder / "error.txt").read_text()


def test_ctrl_c_in_training_then_the_same_command(tiny, capsys):
    command = ("train", "foreign_methods:FitInterrupted", "--scene", tiny, "--preset", "smoke", "--frames", "20")
    code, _, lines = typed(capsys, *command)
    assert code == 130 and len(lines) == 1 and "the same command again" in lines[0]
    assert RunStore().list()[0].state == "interrupted"
    assert typed(capsys, *command)[0] == 0
    assert RunStore().list()[0].state == "finished"


def test_sigterm_is_taken_for_ctrl_c_while_a_command_runs_and_no_longer(monkeypatch, capsys):
    before = signal.getsignal(signal.SIGTERM)
    command = SimpleNamespace(run=lambda: os.kill(os.getpid(), signal.SIGTERM))
    monkeypatch.setattr("garmentbench.cli.parse", lambda arguments: command)
    assert main(["evals"]) == 130 and "the same command again" in capsys.readouterr().err
    assert signal.getsignal(signal.SIGTERM) is before


def test_more_frames_than_a_scene_has(tiny, capsys, monkeypatch):
    command = ("train", "foreign_methods:Good", "--scene", tiny, "--preset", "smoke", "--frames", "30")
    code, _, lines = typed(capsys, *command)
    assert code == 1 and "20 frames, 30 were asked for" in lines[0]


@pytest.mark.parametrize("limit", [100, 15_000])  # too small for the first file of a run; for the last
def test_a_disk_that_fills_leaves_no_result_that_looks_whole(tiny, home, capsys, limit):
    typed(capsys, *evaluate("Raises", tiny))  # compiles kernels, which this is not about
    full = process(
        home,
        *evaluate("Good", tiny),
        # A module compiled now would be cut off, and stay so.
        before="import resource; sys.dont_write_bytecode = True; "
        f"resource.setrlimit(resource.RLIMIT_FSIZE, 2 * ({limit},))",
    )
    err = full.communicate(timeout=60)[1].splitlines()
    assert full.returncode == 1 and "can't be written" in err[-1] and "same command again" in err[-1]
    assert not any("Traceback" in line for line in err) and not list(home.rglob("*.partial"))
    assert not RunStore().list({"kind": "evaluate", "class": "foreign_methods:Good", "state": "finished"})
    assert typed(capsys, *evaluate("Good", tiny))[0] == 0
    assert RunStore().list({"kind": "evaluate", "class": "foreign_methods:Good", "state": "finished"})


def test_ctrl_c_in_a_simulation_then_the_same_command(home):
    command = ("simulate", "sheet-stick-a", "--preset", "smoke", "--runs", "2")
    first = process(home, *command)
    lock = home / "sequences" / "smoke" / "sheet-stick-a.lock"
    end = time.monotonic() + 60
    while not (lock.is_file() and lock.read_text()):
        assert time.monotonic() < end and first.poll() is None
        time.sleep(0.02)
    first.send_signal(signal.SIGINT)
    _, err = first.communicate(timeout=60)
    assert first.returncode == 130 and "the same command again" in err and "Traceback" not in err
    assert not list(home.rglob("*.h5")) and not list(home.rglob("*.partial"))
    second = process(home, *command)
    out, err = second.communicate(timeout=120)
    assert second.returncode == 0, err
    path, spread = out.splitlines()[0].split(": ")
    sequence = sequence_file.load(Path(path))
    assert len(sequence) == 40 and len(sequence.runs) == 1
    assert spread.startswith(f"spread {sequence.spread_cm:.2g} cm, c")
