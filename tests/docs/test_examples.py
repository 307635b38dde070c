"""Every script of examples/ runs by itself from another folder and prints what its docstring says."""

import ast
import re
from pathlib import Path

import pytest

from tests.support import forks
from tests.support.pages import ROOT, environment

pytestmark = forks.GROUP
SAYS = {  # what is printed when it worked
    "batch_of_boats": r"million boat-steps per second\nsuccess: \d+ of \d+ episodes",
    "cloning_and_evaluation": r"cloning, calm: (9\d|100)%.*\n.*\nreport: results/example_clone/report.md",
    "gymnasium_loop": r"seed 0: success after .*(\n.*){3}\nseed 4: ",
    "hidden_effect": r"verdict: cause\n  thruster_gain bp: gain 0\.700 ",
    "onnx_export": r"greatest difference: \de-\d\d(\n.*)*\nsuccess after ",
    "own_pilot": r"pursuit \{'calm': '(9\d|100)%'",
    "reservoir_from_runs": r"learns from 10 successful runs.*\nreservoir: ([6-9]\d|100)% of 100 episodes",
    "sb3_ppo": r"example_ppo: ([5-9]\d|100)% of 50 episodes",
    "turning_circle": r"steady_diameter: 9\.\d+ m(\n.*)*\nwrote turning_circle.png",
    "yaw_model": r"k_r: -\d.*\nc_ru: \d.*\n(.*\n)*b_r: 1\.\d\d N m/rad",
}
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))


def test_there_are_ten_and_all_are_tested() -> None:
    assert [script.stem for script in SCRIPTS] == sorted(SAYS)
    assert len(SCRIPTS) == 10


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_is_short_and_says_what_it_prints(script: Path) -> None:
    source = script.read_text(encoding="utf-8")
    assert 20 <= len(source.splitlines()) <= 80
    assert re.search(r"\b(Prints|prints)\b", ast.get_docstring(ast.parse(source)) or "")


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_runs(script: Path, tmp_path: Path) -> None:
    done = forks.run(forks.SCRIPT, [str(script)], tmp_path, environment())
    assert done.returncode == 0, done.stderr
    assert re.search(SAYS[script.stem], done.stdout), done.stdout
