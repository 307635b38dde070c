"""A film of the scene, MP4 or GIF, drawn without a screen."""

import math
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swamp_rl.demo.card import CARD
from swamp_rl.demo.clock import Array, poses_at, values_at
from swamp_rl.demo.colours import Colour, fractions
from swamp_rl.demo.labels import apart
from swamp_rl.demo.layout import Layout
from swamp_rl.demo.overlays import end_card, weather
from swamp_rl.demo.scene import DemoScene, Shown, gate_colour
from swamp_rl.demo.series import CURRENT, WIND, series_of
from swamp_rl.demo.shapes import corners
from swamp_rl.errors import UserError
from swamp_rl.extras import missing
from swamp_rl.figure_style import styled
from swamp_rl.files import write_beside
from swamp_rl.workers.signals import held

SIZES = {".mp4": (1280, 720, 25.0), ".gif": (800, 450, 12.5)}
"""Width and height [pixels], frames in a second."""
MOST_FRAMES = 10_000
DPI = 100
WATER = "#eaf3f9"
NAME_AT = np.array([18.0, -18.0])  # pixels from a boat to the lower left corner of its name


def refuse_speed(speed: float) -> None:
    """UserError for a playback rate that is none."""
    if not 0.0 < speed < math.inf:
        raise UserError(f"--speed {speed:g}: give a number above 0")


def frame_count(path: Path, scene: DemoScene, speed: float) -> int:
    """Frames of the film without its ending; UserError for a speed that is none or gives too many."""
    refuse_speed(speed)
    frames = math.ceil(min(scene.end / speed * SIZES[path.suffix.lower()][2], 1e9)) + 1
    if frames > MOST_FRAMES:
        raise UserError(f"--speed {speed:g}: would give {frames} frames, at most {MOST_FRAMES}; give more")
    return frames


def write_video(path: Path | str, scene: DemoScene, layout: Layout = "overlay", speed: float = 4.0) -> int:
    """Write the film and return its number of frames; `speed`: seconds of the scene in one of the film.

    UserError as `frame_count`, where the file cannot be written, or where imageio-ffmpeg is missing.
    """
    path = Path(path)
    width, height, rate = SIZES[path.suffix.lower()]
    frames = frame_count(path, scene, speed)
    ending = round(CARD * rate)
    times = np.minimum(np.arange(frames) * speed / rate, scene.end)
    pictures = _pictures(scene, layout, times, ending, (width, height))
    with write_beside(path) as part:
        if path.suffix.lower() == ".gif":
            _write_gif(part, pictures, rate)
        else:
            _write_mp4(part, pictures, (width, height), rate)
    return frames + ending


def _write_gif(path: Path, pictures: Iterator[NDArray[np.uint8]], rate: float) -> None:
    from PIL import Image

    # A palette for all from the first picture: colours then stay the same from one to the next.
    first = Image.fromarray(next(pictures)).quantize(128, dither=Image.Dither.NONE)
    rest = (Image.fromarray(one).quantize(palette=first, dither=Image.Dither.NONE) for one in pictures)
    first.save(path, save_all=True, append_images=rest, duration=round(1000.0 / rate), loop=0)


def _write_mp4(path: Path, pictures: Iterator[NDArray[np.uint8]], size: tuple[int, int], rate: float) -> None:
    try:
        from imageio_ffmpeg import write_frames
    except ImportError as error:
        raise missing("an MP4 needs imageio-ffmpeg", "video", "end the name in .gif") from error
    film = write_frames(str(path), size, fps=rate, codec="libx264", quality=8, macro_block_size=2)
    try:
        for number, picture in enumerate(pictures):
            with held():  # of no picture, or of half of one, ffmpeg would complain
                if number == 0:
                    film.send(None)  # starts ffmpeg
                film.send(np.ascontiguousarray(picture))
    except BaseException:
        with suppress(RuntimeError):  # so that ffmpeg ends
            film.throw(RuntimeError())
        raise
    film.close()


def _pictures(
    scene: DemoScene, layout: Layout, times: Array, ending: int, size: tuple[int, int]
) -> Iterator[NDArray[np.uint8]]:
    """(H, W, 3) at each time: what moves is drawn anew over a picture of all that stays.

    The last comes `ending` times more, with the end card over it.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    style: Any = {"font.size": 9.0 * min(1.0, size[1] / 600.0), "text.parse_math": False}
    with styled(style):
        figure = Figure(figsize=(size[0] / DPI, size[1] / DPI), dpi=DPI, facecolor="#fbfcfd")
        canvas = FigureCanvasAgg(figure)
        groups = [None] if layout == "overlay" else scene.groups
        grid = figure.add_gridspec(
            1, 2, width_ratios=(3, 2), left=0.015, right=0.985, top=0.84, bottom=0.06, wspace=0.12
        )
        charts = _charts(figure, grid[0], scene, groups)
        plots = _plots(figure, grid[1], scene)
        moving = [artist for axes, group in charts for artist in _fleet(axes, scene, group, times)]
        cursors = [axes.axvline(0.0, color="#17324a", lw=1.2, animated=True) for axes in plots]
        clock = figure.text(0.985, 0.955, "", ha="right", size="x-large", animated=True)
        figure.text(0.015, 0.955, scene.title, weight="bold", size="x-large", parse_math=False)
        figure.text(0.015, 0.91, scene.conditions.sentence, color="#546a7d", size="large", parse_math=False)
        card = end_card(figure, scene)
        _legend(figure, scene)
        canvas.draw()
        still = canvas.copy_from_bbox(figure.bbox)
        for i, time in enumerate(times):
            canvas.restore_region(still)
            for axes, artist, move in moving:
                move(i)
                axes.draw_artist(artist)
            for axes, cursor in zip(plots, cursors, strict=True):
                cursor.set_xdata([time, time])
                axes.draw_artist(cursor)
            clock.set_text(f"{time:.1f} s")
            figure.draw_artist(clock)
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()
        for artist in card:
            figure.draw_artist(artist)
        for _ in range(ending):
            yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _legend(figure: Any, scene: DemoScene) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for fleet in scene.fleets:
        alone = scene.called(fleet.shown[0]) if len(fleet.shown) == 1 else None
        label = alone or f"{len(fleet.shown)} {fleet.path[0]}"
        handles.append(Line2D([], [], color=fractions(fleet.colour), lw=4, label=label))
    columns = min(len(handles), 4)
    figure.legend(handles=handles, loc="upper center", ncols=columns, frameon=False, fontsize="small")


def _charts(figure: Any, place: Any, scene: DemoScene, groups: list[Any]) -> list[tuple[Any, str | None]]:
    """An empty chart of the course for each group."""
    from matplotlib.patches import Circle

    south, north, west, east = scene.edges()
    radius = max(scene.course.buoy_radius if scene.course else 0.0, 0.3 * scene.scale)
    columns = 1 if len(groups) == 1 else math.ceil(math.sqrt(len(groups) * 1.2))
    grid = place.subgridspec(math.ceil(len(groups) / columns), columns, wspace=0.04, hspace=0.14)
    found = []
    for i, group in enumerate(groups):
        axes = figure.add_subplot(grid[i // columns, i % columns], facecolor=WATER)
        box = axes.get_window_extent()
        spare = np.array([north - south, east - west]) / (box.height, box.width)
        more = 0.5 * (spare.max() / spare - 1.0) * (north - south, east - west)
        axes.set(xlim=(west - more[1], east + more[1]), ylim=(south - more[0], north + more[0]))
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
        if group is not None:
            axes.set_title(group, loc="left", parse_math=False)
        for gate in scene.course.gates if scene.course else ():
            colour, (port, starboard) = fractions(gate_colour(gate.name)), gate.buoys
            axes.plot([port.east, starboard.east], [port.north, starboard.north], ":", color=colour, lw=1.2)
            for buoy in gate.buoys:
                axes.add_patch(Circle((buoy.east, buoy.north), radius, color=colour))
            ahead = scene.scale * np.array([math.sin(gate.heading), math.cos(gate.heading)])
            centre = np.array([gate.centre.east, gate.centre.north])
            shape = {"arrowstyle": "->", "color": colour}
            axes.annotate("", centre + ahead, centre - ahead, arrowprops=shape)
        found.append((axes, group))
    return found


def _fleet(axes: Any, scene: DemoScene, group: str | None, times: Array) -> Iterator[tuple[Any, Any, Any]]:
    """Axes, artist and what brings it to the i-th time: of tracks, boats and names."""
    from matplotlib.collections import LineCollection, PolyCollection

    shown = [
        (fleet.colour, item) for fleet in scene.fleets for item in fleet.shown if group in (None, item.group)
    ]
    colours = [fractions(colour) for colour, _ in shown]
    for colour, item in shown:
        axes.plot(
            item.run.columns["east"],
            item.run.columns["north"],
            color=fractions(colour),
            lw=0.7,
            alpha=0.3,
            zorder=1,
        )
    poses = [poses_at(item, times) for _, item in shown]
    outlines = [corners(pose, scene.length, scene.breadth)[..., ::-1] for pose in poses]
    ways = [pose[:, 1::-1] for pose in poses]
    alpha = 0.95 if scene.few else 0.5
    tracks = LineCollection(
        [], colors=colours, linewidths=1.8 if scene.few else 0.9, alpha=alpha, animated=True
    )
    boats = PolyCollection([], facecolors=colours, edgecolors="white", linewidths=0.7, animated=True)
    for artist in (tracks, boats):
        axes.add_collection(artist, autolim=False)
    yield axes, tracks, lambda i: tracks.set_segments([way[: i + 1] for way in ways])
    yield axes, boats, lambda i: boats.set_verts([outline[i] for outline in outlines])
    yield from weather(axes, scene, [item for _, item in shown], times)
    if scene.few:
        yield from _names(axes, scene, [item for _, item in shown], colours, np.stack(ways, axis=1))


def _names(
    axes: Any, scene: DemoScene, shown: list[Shown], colours: list[Any], ways: Array
) -> Iterator[tuple[Any, Any, Any]]:
    """The boats' names at ways (T, N, 2), moved apart where boats meet."""
    from matplotlib.patheffects import withStroke
    from matplotlib.transforms import IdentityTransform

    edge = [withStroke(linewidth=2.5, foreground=WATER)]
    style = {
        "path_effects": edge,
        "transform": IdentityTransform(),
        "va": "bottom",
        "animated": True,
        "parse_math": False,
    }
    names = [
        axes.text(0, 0, scene.called(item), color=colour, weight="bold", **style)
        for item, colour in zip(shown, colours, strict=True)
    ]
    boxes = [name.get_window_extent() for name in names]
    sizes = np.array([[box.width, box.height] for box in boxes])

    def mover(number: int) -> Any:
        def move(i: int) -> None:
            places = apart(axes.transData.transform(ways[i]), sizes, NAME_AT)
            names[number].set_position(places[number])

        return move

    for number, name in enumerate(names):
        yield axes, name, mover(number)


def _plots(figure: Any, place: Any, scene: DemoScene) -> list[Any]:
    """The time series, whole from the start: a cursor moves over them."""
    lines: dict[str, list[tuple[Colour, Shown, Array]]] = {}
    for fleet in scene.fleets:
        for item in fleet.shown:
            for panel, found in series_of(item.run, scene.course).items():
                if panel not in (WIND, CURRENT):
                    lines.setdefault(panel, []).extend((fleet.colour, item, one) for one in found.values())
    grid = place.subgridspec(len(lines), 1, hspace=0.45)
    plots = []
    for i, (panel, drawn) in enumerate(lines.items()):
        axes = figure.add_subplot(grid[i], facecolor="none")
        for colour, item, values in drawn:
            at = item.start + item.run.time - item.run.time[0]
            style: dict[str, Any] = {"lw": 1.3, "alpha": 0.9} if scene.few else {"lw": 0.6, "alpha": 0.3}
            axes.plot(at, values_at(item, values, at), color=fractions(colour), **style)
        axes.set_title(
            panel if i else f"{panel} over time [s]", loc="left", size="medium", pad=3, parse_math=False
        )
        axes.set_xlim(0.0, scene.end)
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(labelbottom=i == len(lines) - 1)
        axes.margins(y=0.08)
        plots.append(axes)
    return plots
