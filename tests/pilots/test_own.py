"""A researcher's own pilot, and a model of stable-baselines3, are trained and evaluated as the others are."""

import hashlib
import json
import re
import shutil
import sys
import zipfile
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import yaml
from stable_baselines3 import A2C, PPO, SAC, TD3
from swamp_rl.experiments.config.load import load_experiment
from swamp_rl.experiments.studies.run import run_experiment, train_experiment
from swamp_rl.experiments.studies.stored import evaluate_folders

from swamp_rl.errors import UserError
from swamp_rl.export import write_onnx
from swamp_rl.pilots import own
from swamp_rl.pilots.arguments import asked_pilot, opened
from swamp_rl.pilots.own import OwnPilot
from swamp_rl.pilots.settings import Settings
from swamp_rl.pilots.store import load_pilot, save_pilot
from tests.support.tiny_experiment import write_tiny

DOCUMENT = Path(__file__).parents[2] / "docs" / "tutorials" / "own_pilot_reward_course.md"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the document's `my_pilot.py`, on the path of a process that has named nothing."""
    found = re.search(r"```python\n(.*?)```", DOCUMENT.read_text(), re.DOTALL)
    assert found is not None
    (tmp_path / "my_pilot.py").write_text(found[1])
    monkeypatch.syspath_prepend(str(tmp_path))
    forget(monkeypatch)
    return tmp_path


def forget(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a new process: no class and no model has been named."""
    monkeypatch.setattr(own, "_named", {})
    monkeypatch.setattr(own, "_models", set())
    sys.modules.pop("my_pilot", None)


def experiment(folder: Path, **plan: Any) -> Path:
    """The tiny experiment with the scripted pilot and `mine`."""
    file = write_tiny(folder, "scripted")
    data = yaml.safe_load(file.read_text())
    data["pilots"]["mine"] = {"kind": "my_pilot:MyPilot", **plan}
    file.write_text(yaml.safe_dump(data))
    return file


def rates(folder: Path) -> dict[str, Any]:
    """What results.json tells of each pilot."""
    return json.loads((folder / "results.json").read_text())["pilots"]


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_the_documents_example_is_trained_and_evaluated_beside_the_others(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = run_experiment(experiment(place, takeover=1.0, options={"epochs": 30}), out=place / "out")
    assert set(rates(out)) == {"scripted", "mine"}
    assert "| mine |" in (out / "report.md").read_text()
    assert (out / "pilots" / "mine" / "curve.jsonl").read_text().count("loss") == 30

    forget(monkeypatch)
    for refused in (
        lambda: load_pilot(out / "pilots" / "mine"),
        lambda: evaluate_folders([out], {}, out=place / "no"),
        lambda: evaluate_folders([out / "pilots" / "mine"], {}, out=place / "no"),
        lambda: run_experiment(out, out=place / "no"),
    ):
        with pytest.raises(UserError, match="my_pilot:MyPilot"):
            refused()
        assert "my_pilot" not in sys.modules and not (place / "no").exists()
    beside = evaluate_folders([out / "pilots" / "scripted"], {"episodes": 2}, out=place / "beside")
    assert set(rates(beside)) == {"scripted"} and "my_pilot" not in sys.modules
    again = evaluate_folders([f"my_pilot:MyPilot={out}"], {"seed": 9}, out=place / "again")
    assert set(rates(again)) == {"scripted", "mine"}


def test_its_stored_copy_steers_as_it_did(place: Path) -> None:
    pilot = opened(asked_pilot("my_pilot:MyPilot"))
    save_pilot(pilot, place / "stored")
    seen = np.random.default_rng(0).normal(size=(4, 5))
    np.testing.assert_array_equal(load_pilot(place / "stored").act(seen), pilot.act(seen))


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        ("my_pilot:Nobody", {}, "Nobody"),
        ("no_such_module:MyPilot", {}, "no_such_module"),
        ("my_pilot:Options", {}, "has no train"),
        ("my_pilot:np", {}, "is not a class"),
        ("my_pilot:MyPilot", {"epoch": 3}, "epochs"),
        ("my_pilott", {}, "not a kind of pilot"),
    ],
)
def test_a_wrong_class_or_option_is_refused_by_key(
    place: Path, kind: str, options: dict[str, int], message: str
) -> None:
    with pytest.raises(UserError, match=rf"pilots\.mine\.(kind|options).*{message}"):
        load_experiment(experiment(place, kind=kind, options=options))


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_an_installed_packages_entry_point_is_a_kind_that_is_trained_stored_and_read_again(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    metadata = place / "their_package-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: their-package\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text(f"[{own.GROUP}]\nmine = my_pilot:MyPilot\n")
    assert "mine" in own.own_kinds()
    out = run_experiment(experiment(place, kind="mine", options={"epochs": 3}), out=place / "out")
    assert json.loads((out / "results.json").read_text())["pilots"]["mine"]["kind"] == "mine"

    forget(monkeypatch)  # installed, so that nobody has to name it
    assert load_pilot(out / "pilots" / "mine").kind == "mine"
    again = evaluate_folders([out / "pilots" / "mine"], {}, out=place / "again")
    assert rates(again)["mine"]["levels"] == rates(out)["mine"]["levels"]
    shutil.rmtree(metadata)
    forget(monkeypatch)
    with pytest.raises(UserError, match=r"kind 'mine' is none of"):
        load_pilot(out / "pilots" / "mine")


class Counting:
    """Steers by the number of decisions it has made for each boat."""

    senses = ("surge",)

    def reset(self, n: int) -> None:
        """All begin."""
        self.count = np.zeros(n)

    def reset_boats(self, mask: np.ndarray) -> None:
        """Some begin."""
        self.count[mask] = 0

    def act(self, observation: np.ndarray) -> np.ndarray:
        """Throttle 0.1 a decision."""
        self.count += 1
        return np.stack([0.1 * self.count, observation[:, 0]], axis=1)


def test_boats_that_have_ended_may_be_dropped_and_others_begin_anew_with_the_memory_of_each_kept() -> None:
    pilot = OwnPilot("a:B", Counting(), Settings())
    pilot.reset(3)
    pilot.act(np.zeros((3, 1)))
    pilot.keep(np.array([2, 1]))
    pilot.reset_boats(np.array([True, False]))
    np.testing.assert_allclose(pilot.act(np.array([[0.5], [-3.0]])), [[0.1, 0.5], [0.2, -1.0]])


BROKEN = {
    "def MyPilot(:": r"line 1: SyntaxError",
    "import math\nMyPilot = maths.pi": r"line 2: NameError: name 'maths' is not defined",
    "import torhc": r"line 1: ModuleNotFoundError: No module named 'torhc'; correct it",
    "class MyPlot: pass": r"has no 'MyPilot'; did you mean 'MyPlot'\? known here: MyPlot",
    "class MyPilot:\n    train = save = load = reset = act = lambda self: 0": r"save\(self\): is called",
}


@pytest.mark.parametrize("number", range(len(BROKEN)))
def test_what_is_wrong_in_the_users_own_module_is_reported_by_line(place: Path, number: int) -> None:
    text, message = list(BROKEN.items())[number]
    (place / f"broken_{number}.py").write_text(text)
    with pytest.raises(UserError, match=rf"pilots\.mine\.kind: broken_{number}:MyPilot.*{message}"):
        load_experiment(experiment(place, kind=f"broken_{number}:MyPilot"))


STILL = """
import numpy as np

class Still:
    senses, from_runs = ("surge",), False

    @classmethod
    def train(cls, training):
        {train}

    @classmethod
    def load(cls, folder, settings):
        return cls()

    def save(self, folder): ...

    def reset(self, boats): ...

    def act(self, observed):
        return np.zeros((len(observed), 2))
"""


@pytest.mark.parametrize("others", [[], ["scripted"]])
def test_a_class_that_ends_with_an_error_is_corrected_and_the_command_repeated(
    place: Path, monkeypatch: pytest.MonkeyPatch, others: list[str]
) -> None:
    file = experiment(place, kind="my_still:Still")
    data = yaml.safe_load(file.read_text())
    data["pilots"] = {name: data["pilots"][name] for name in (*others, "mine")}
    file.write_text(yaml.safe_dump(data, sort_keys=False))

    def train_as(line: str) -> None:
        forget(monkeypatch)
        sys.modules.pop("my_still", None)
        (place / "my_still.py").write_text(STILL.format(train=line))
        train_experiment(file, out=place / "out")

    with pytest.raises(ValueError, match="oops"):
        train_as("raise ValueError('oops')")
    assert (place / ".part-out" / "pilots" / "scripted").exists() == bool(others)
    assert (place / ".part-out").exists() == bool(others)
    train_as("return cls()")
    assert (place / "out" / "pilots" / "mine").is_dir()


def test_a_file_that_an_own_pilot_does_not_find_again_is_reported_with_its_class(place: Path) -> None:
    file = place / "my_pilot.py"
    file.write_text(file.read_text().replace('load(folder / "network.pt"', 'load(folder / "net.pt"'))
    save_pilot(opened(asked_pilot("my_pilot:MyPilot")), place / "stored")
    with pytest.raises(UserError, match=r"my_pilot:MyPilot\.load: net\.pt: .*save wrote network\.pt"):
        load_pilot(place / "stored")


def test_senses_of_a_class_that_there_are_not_are_refused_with_the_pilot_before_any_work(place: Path) -> None:
    file = place / "my_pilot.py"
    file.write_text(file.read_text().replace('"gate_cos"', '"gate_cosine"'))
    message = r"pilots\.mine\.kind: my_pilot:MyPilot\.senses: .*'gate_cosine'; did you mean 'gate_cos'"
    with pytest.raises(UserError, match=message):
        run_experiment(experiment(place), out=place / "out")
    assert not list(place.glob("*out*"))


def test_a_class_whose_train_returns_no_pilot_is_reported() -> None:
    with pytest.raises(UserError, match="a:B: made None, which has no reset, act; return a pilot"):
        OwnPilot("a:B", None, Settings())


@pytest.mark.parametrize(
    ("levers", "message"),
    [(np.zeros((3, 3)), "shape"), (np.full((3, 2), np.nan), "finite"), ([[1.0], [1.0, 0.0]], "no array")],
)
def test_levers_that_are_none_are_reported(levers: Any, message: str) -> None:
    steering = Counting()
    steering.act = lambda observation: levers  # type: ignore[method-assign]
    with pytest.raises(UserError, match=rf"a:B\.act: .*{message}"):
        OwnPilot("a:B", steering, Settings()).act(np.zeros((3, 1)))


def test_a_pilot_that_could_not_be_loaded_again_is_refused_at_saving(tmp_path: Path) -> None:
    stranger: Any = Counting()
    stranger.kind = "stranger"
    with pytest.raises(UserError, match="Counting"):
        save_pilot(stranger, tmp_path / "stored")
    stranger.kind = "cloning"
    with pytest.raises(UserError, match="Counting"):
        save_pilot(stranger, tmp_path / "stored")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_models_of_sb3_and_onnx_files_are_evaluated_in_the_same_table(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = PPO("MlpPolicy", gymnasium.make("swamp/Gates-v1"), n_steps=64, batch_size=64)
    model.learn(64)
    model.save(place / "learned.zip")
    run = run_experiment(write_tiny(place, "net"), out=place / "run")
    write_onnx(load_pilot(run / "pilots" / "net"), place / "exported.onnx")

    out = evaluate_folders(
        [run, f"sb3:{place}/learned.zip", f"onnx:{place}/exported.onnx"], {}, out=place / "out"
    )
    found = rates(out)
    assert set(found) == {"net", "learned", "exported"}
    exported, net = (found[name]["levels"]["calm"] for name in ("exported", "net"))
    assert exported["outcomes"] == net["outcomes"]
    assert exported["mean_return"] == pytest.approx(net["mean_return"], rel=1e-6)

    forget(monkeypatch)
    with pytest.raises(UserError, match=r"sb3:learned\.zip"):
        load_pilot(out / "pilots" / "learned")
    load_pilot(out / "pilots" / "exported")


@pytest.mark.slow
@pytest.mark.usefixtures("no_figures")
def test_models_of_the_same_name_are_all_evaluated_in_the_order_asked_by_the_name_of_their_folders(
    place: Path,
) -> None:
    for folder in ("first", "second"):
        (place / folder).mkdir()
        PPO("MlpPolicy", gymnasium.make("swamp/Gates-v1")).save(place / folder / "best_model.zip")
    named = [f"sb3:{place}/{folder}/best_model.zip" for folder in ("second", "first")]
    small = {"episodes": 1, "shown": 1}
    out = evaluate_folders(
        [*named, "line-of-sight", named[0]],
        small,
        ["data.record.good=1"],
        place / "out",
        str(write_tiny(place)),
    )
    assert list(rates(out)) == ["second-best_model", "first-best_model", "line-of-sight"]


@pytest.mark.usefixtures("no_figures")
def test_pilots_that_keep_no_experiment_are_evaluated_in_the_usual_one_and_reported_so(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(place)
    small = {"episodes": 1, "shown": 1, "levels": ["calm"]}
    out = evaluate_folders(["line-of-sight"], small, ["data.record={good: 1, failed: 0}"])
    kept = load_experiment(out)
    assert (kept.boat, kept.course, list(kept.pilots)) == ("swamp", "camogli", ["line-of-sight"])
    assert "those of the experiment camogli; --experiment names another" in capsys.readouterr().err


@pytest.mark.parametrize("algorithm", [PPO, A2C, SAC, TD3])
def test_a_model_of_sb3_gives_the_levers_that_its_library_predicts(
    place: Path, algorithm: type[PPO | A2C | SAC | TD3]
) -> None:
    model = algorithm("MlpPolicy", gymnasium.make("swamp/Gates-v1"))
    model.save(place / "model.zip")
    seen = np.random.default_rng(1).normal(size=(5, 12))
    expected, _ = model.predict(seen.astype(np.float32), deterministic=True)
    pilot = opened(asked_pilot(f"sb3:{place}/model.zip"))
    np.testing.assert_allclose(pilot.act(seen), expected, atol=1e-6)


def test_what_is_no_model_and_a_model_that_was_changed_are_refused(place: Path) -> None:
    (place / "model.zip").write_bytes(b"nothing")
    with pytest.raises(UserError, match="not a model of stable-baselines3"):
        opened(asked_pilot(f"sb3:{place}/model.zip"))
    with pytest.raises(UserError, match=r"nowhere\.zip: No such file"):
        asked_pilot("sb3:nowhere.zip")
    with pytest.raises(UserError, match=r"model: No such file or directory; name .*model\.zip"):
        asked_pilot(f"sb3:{place}/model")
    other = hashlib.sha256(b"another").hexdigest()
    with pytest.raises(UserError, match="is no longer the model"):
        own.model_file(str(place / "model.zip"), other)


@pytest.mark.parametrize("held", [{}, {"clip_range": 0.2}, {"gae_lambda": 1.0, "policy_class": "x"}, []])
def test_a_zip_that_no_algorithm_reads_is_reported_by_its_name_in_one_line(place: Path, held: object) -> None:
    with zipfile.ZipFile(place / "other.zip", "w") as archive:
        archive.writestr("data", json.dumps(held))
    with pytest.raises(UserError, match=r"other\.zip: (is a model of none of|could not be read)") as error:
        opened(asked_pilot(f"sb3:{place}/other.zip"))
    assert "\n" not in str(error.value)


def test_a_model_that_is_not_there_is_reported_before_anything_is_recorded(place: Path) -> None:
    (place / "mine.yaml").write_text(
        "{name: mine, boat: swamp, course: camogli, step: 0.1, data: {record: {good: 1}}, "
        "pilots: {exported: {kind: onnx, options: {file: nowhere.onnx}}}, "
        "evaluation: {levels: [calm], episodes: 1, seed: 1}}"
    )
    with pytest.raises(UserError, match=r"nowhere\.onnx: No such file"):
        train_experiment(place / "mine.yaml", out=place / "out")
    assert not list(place.glob("*out*"))


def test_a_model_that_observes_something_else_is_reported_before_anything_is_recorded(place: Path) -> None:
    senses = ["gate_ahead", "yaw_rate"]
    PPO("MlpPolicy", gymnasium.make("swamp/Gates-v1", observation=senses)).save(place / "two.zip")
    file = write_tiny(place, "scripted")
    data = yaml.safe_load(file.read_text())
    data["pilots"] = {"two": {"kind": "sb3", "options": {"file": str(place / "two.zip")}}}
    file.write_text(yaml.safe_dump(data))
    with pytest.raises(UserError, match=r"observes the shape \(2,\), not \(12,\); name what it observes"):
        train_experiment(file, out=place / "out")
    assert not list(place.glob("*out*"))
