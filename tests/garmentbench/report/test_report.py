"""The whole report of a made-up preset."""

import html
import re
import shutil
from pathlib import Path

import pytest
from report_example import WALK, row, write_example, write_results

from garmentbench.errors import UserError
from garmentbench.report import make_report



def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("example")
    write_example(root)
    make_report("laptop", root / "reports", root / "runs")
    return root


@pytest.fixture
def folder(root):
    return root / "reports" / "laptop"


def test_it_is_remade_byte_for_byte_anywhere_from_results_and_runs_alone(root, folder, tmp_path):
    for name in ("plots/old.svg", "tables/old.md"):
        (tmp_path / "reports" / "laptop" / name).parent.mkdir(parents=True)
        (tmp_path / "reports" / "laptop" / name).write_text("of an earlier report")
    shutil.copy(folder / "results.csv", tmp_path / "reports" / "laptop" / "results.csv")
    shutil.copytree(root / "runs", tmp_path / "runs")
    make_report("laptop", tmp_path / "reports", tmp_path / "runs")
    first, second = contents(folder), contents(tmp_path / "reports" / "laptop")
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []
    assert sum(map(len, first.values())) < 6e6


def test_a_missing_run_is_named_and_the_report_stays_as_it_was(root, folder, tmp_path):
    shutil.copytree(root, tmp_path / "clone")
    clone = tmp_path / "clone"
    shutil.rmtree(clone / "runs" / "evaluate-hold")
    (clone / "runs" / "evaluate-full-1" / "report.npz").unlink()
    with pytest.raises(UserError, match=r"2 of the \d+ runs named in results.csv are missing, the first: evaluate-(hold|full-1)"):
        make_report("laptop", clone / "reports", clone / "runs")
    assert contents(clone / "reports" / "laptop") == contents(folder)


def test_without_results_it_says_what_to_do(tmp_path):
    with pytest.raises(UserError, match="no results yet; `make evals PRESET=smoke`"):
        make_report("smoke", tmp_path, tmp_path)
    (tmp_path / "smoke").mkdir()
    (tmp_path / "smoke" / "results.csv").write_text("preset,experiment\nsmoke,baselines\n")
    with pytest.raises(UserError, match="lacks the column 'scene'"):
        make_report("smoke", tmp_path, tmp_path)


def test_every_line_is_in_its_table_however_it_ended(folder):
    main = (folder / "tables" / "baselines-tshirt-armspace-90.md").read_text()
    names = [line.split("|")[1].strip() for line in main.splitlines() if line.startswith("|")]
    assert names[2:] == ["reference", "skinning", "hold", "constant velocity", "linear subspace", "motion-guided"]
    diverged = next(line for line in main.splitlines() if "constant velocity" in line)
    assert diverged.endswith("| diverged at frame 37 |") and diverged.count("| diverged |") >= 3
    ablations = (folder / "tables" / "ablations-tshirt-armspace-90.md").read_text()
    assert "| motion-guided, no collision | – |" in ablations and ablations.rstrip().endswith("| failed |")
    page = (folder / "index.html").read_text()
    assert "train: raised ValueError: &lt;bad&gt; &amp; (ugly)<" in page
    assert "3 of 105 vertices are not finite" in page


def test_the_main_table_by_hand(folder):
    """Seeds 0.60, 0.70, 0.65: mean 0.65, s = 0.05, 4.3027 s / sqrt(3) = 0.12; the paper's Table 3 beside it."""
    text = (folder / "tables" / "baselines-tshirt-armspace-90.md").read_text()
    lines = [[c.strip() for c in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("|")]
    header, reference, ours = lines[0], lines[2], lines[-1]
    at = header.index("rollout-1150 [cm]")
    assert ours[at] == "**0.65 ± 0.12**" and ours[at + 1] == "0.82" and header[at + 1] == "paper"
    assert reference[at] == "± 0.2"
    assert ours[header.index("inside [%]") + 1] == "0.01" and reference[header.index("inside [%]")] == "< 0.01"
    assert reference[header.index("time a frame [ms]")] == "60.0"


def test_what_a_scene_lacks_has_no_column(folder):
    stick = (folder / "tables" / "stick-sheet-stick-b.md").read_text()
    assert "inside" not in stick and "paper" not in stick and "rollout-1150" in stick


def test_training_lengths_stand_in_their_order_beside_table_4(folder):
    text = (folder / "tables" / "table4-tshirt-armspace-90.md").read_text()
    rows = [line for line in text.splitlines() if line.startswith("| motion-guided")]
    assert [r.split("|")[1].strip() for r in rows] == ["motion-guided, train 50", "motion-guided, train 150"]
    assert "| 1.84 |" in rows[0] and "| 0.84 |" in rows[1]


def test_the_stress_ladder_has_the_simulator_and_says_how_each_case_ended(folder):
    text = (folder / "tables" / "stability.md").read_text()
    assert "| no stress | reference (simulator) | ok |" in text
    assert "| stiff-100 | reference (simulator) | diverged at frame 11 |" in text
    skinning = next(line for line in text.splitlines() if "| stiff-100 | skinning | diverged at frame 60 | diverged |" in line)
    assert skinning.endswith("| 57 |")  # frames that were stable


def test_needs_in_one_line_a_part(folder):
    text = (folder / "tables" / "needs.md").read_text()
    assert "| sheet-stick-b | body sdf | – | – | 1,840,000 |" in text
    assert "| sheet-stick-b | collision stage | 21.5 | 1.25 | – |" in text


def test_the_three_forms_of_a_table_say_the_same(folder):
    for path in sorted((folder / "tables").glob("*.md")):
        text = path.read_text()
        rows = [re.split(r" \| ", line[2:-2].replace("**", "")) for line in text.splitlines() if line.startswith("| ")]
        wanted = [[c.strip() for c in row] for i, row in enumerate(rows) if i != 1]
        page = path.with_suffix(".html").read_text()
        cells = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", line) for line in re.findall(r"<tr>(.*?)</tr>", page, re.DOTALL)]
        assert [[html.unescape(re.sub("</?small>", "", c)) for c in row] for row in cells] == wanted
        body = re.search(r"\\toprule\n(.*)\\bottomrule", path.with_suffix(".tex").read_text(), re.DOTALL).group(1)
        tex = [line[:-3].split(" & ") for line in body.splitlines() if line.endswith(r"\\")]
        assert [[_plain(c) for c in row] for row in tex] == wanted
        for form in (".md", ".html", ".tex"):
            assert "AUTOGENERATED. Don't edit" in path.with_suffix(form).read_text().splitlines()[0]


def _plain(tex: str) -> str:
    for mark, text in ((r"\textbf{", ""), ("}", ""), (r"$\pm$", "±"), (r"$<$", "<"), ("--", "–"), ("$^2$", "²"), (r"$-$", "−")):
        tex = tex.replace(mark, text)
    return tex.replace("\\", "").strip()


def test_the_page_needs_no_network_and_its_links_lead_somewhere(folder):
    page = (folder / "index.html").read_text()
    links = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert len(links) > 20
    for link in links:
        assert not re.match(r"[a-z]+:|//", link)
        assert f'id="{link[1:]}"' in page if link.startswith("#") else (folder / link).is_file()
    assert "@import" not in page and "url(" not in page and "<script" not in page
    linked = {link for link in links if "/" in link}
    assert linked == {n for n in contents(folder) if n not in ("index.html", "results.csv")}


def test_a_preset_of_which_nothing_ran_still_has_a_report(tmp_path):
    rows = [row("baselines", WALK, "hold", "full", 0, "rollout_l2", None, float("nan"), "cm", status="failed", run="(no disk)")]
    write_results(tmp_path / "smoke" / "results.csv", rows)
    page = make_report("smoke", tmp_path, tmp_path / "runs").read_text()
    assert "no disk" in page and "failed" in page and "<img" not in page
