"""The film: as many frames as asked for, boats that move, and nothing half-written."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import psutil
import pytest

from swamp_rl.course import load_course
from swamp_rl.demo import video
from swamp_rl.demo.card import CARD
from swamp_rl.demo.layout import Layout
from swamp_rl.demo.scene import DemoScene, demo_scene
from swamp_rl.demo.video import SIZES, write_video
from swamp_rl.errors import UserError
from swamp_rl.runs import Run
from tests.support.runs import circling


def scene() -> DemoScene:
    runs = {"human": [Run("$a_b", circling())], "ppo": [Run("b", circling(start=1.0))]}
    return demo_scene("race $x_1", runs, load_course("camogli"), (1.24, 1.1))


@pytest.mark.parametrize("layout", ["overlay", "side-by-side"])
def test_a_gif_shows_the_boats_moving(tmp_path: Path, layout: Layout) -> None:
    from PIL import Image

    path = tmp_path / "a.gif"
    count = write_video(path, scene(), layout, speed=5.0)
    rate = SIZES[".gif"][2]
    moving = np.ceil(3.0 / 5.0 * rate) + 1
    assert count == moving + round(CARD * rate)
    with Image.open(path) as film:
        assert (film.n_frames, film.size) == (moving + 1, SIZES[".gif"][:2])  # the card is one picture
        first = np.asarray(film.convert("RGB"), float)
        film.seek(film.n_frames - 2)
        last = np.asarray(film.convert("RGB"), float)
        film.seek(film.n_frames - 1)
        assert film.info["duration"] == pytest.approx(1000.0 * CARD, rel=0.05)
        card = np.asarray(film.convert("RGB"), float)
    assert (np.abs(card - last).max(axis=2) > 60).mean() > 0.01
    left = slice(0, first.shape[1] * 55 // 100)
    assert (np.abs(first[:, left] - last[:, left]).max(axis=2) > 60).sum() > 50


def test_an_mp4_can_be_decoded_and_has_all_frames(tmp_path: Path) -> None:
    from imageio_ffmpeg import count_frames_and_secs, read_frames

    path = tmp_path / "a.mp4"
    count = write_video(path, scene(), speed=10.0)
    assert count_frames_and_secs(str(path))[0] == count
    found = read_frames(str(path))
    assert next(found)["size"] == SIZES[".mp4"][:2]
    found.close()


@pytest.mark.parametrize("drawn", [0, 1])
def test_a_film_that_is_interrupted_ends_its_encoder_without_a_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], drawn: int
) -> None:
    def pictures(*result: object) -> Iterator[np.ndarray]:
        for _ in range(drawn):
            yield np.zeros((*SIZES[".mp4"][1::-1], 3), np.uint8)
        raise KeyboardInterrupt

    monkeypatch.setattr(video, "_pictures", pictures)
    others = psutil.Process().children()
    with pytest.raises(KeyboardInterrupt):
        write_video(tmp_path / "a.mp4", scene(), speed=10.0)
    assert list(tmp_path.iterdir()) == []
    assert set(psutil.Process().children()) <= set(others)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), float("inf"), 1e-6])
def test_a_speed_that_gives_no_film_is_refused(tmp_path: Path, speed: float) -> None:
    with pytest.raises(UserError, match="--speed"):
        write_video(tmp_path / "a.gif", scene(), speed=speed)
    assert list(tmp_path.iterdir()) == []


def test_a_film_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError):
        write_video(tmp_path / "file" / "a.gif", scene(), speed=30.0)
    (tmp_path / "a.gif").mkdir()
    with pytest.raises(UserError):
        write_video(tmp_path / "a.gif", scene(), speed=30.0)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.gif", "file"]
