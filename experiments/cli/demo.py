"""`swamp-rl demo`: runs of people and pilots, shown side by side."""

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from swamp_rl.experiments.cli.outputs import refuse_suffix

from swamp_rl.clipped import printable
from swamp_rl.counted import counted
from swamp_rl.errors import UserError

if TYPE_CHECKING:
    from swamp_rl.demo.layout import Layout
    from swamp_rl.demo.scene import DemoScene


NOTHING_TO_DO = (
    "no display to open a window on; add --web (a browser on this machine), --save FILE.rrd, "
    "--video FILE.mp4 or --html FILE.html"
)


def demo(
    sources: Annotated[
        list[str] | None,
        typer.Argument(
            help="Results folders, datasets, files of runs; pilots to run on the same course: a folder, "
            "line-of-sight, sb3:MODEL.zip, onnx:PILOT.onnx or MODULE:CLASS[=FOLDER]. By default the pilots "
            "and the run that come with the package."
        ),
    ] = None,
    runs: Annotated[
        list[str] | None,
        typer.Option(help="Runs to show by NAME or DRIVER/NAME, with * and ?; may be repeated."),
    ] = None,
    side_by_side: Annotated[
        bool, typer.Option("--side-by-side/--overlay", help="One chart for each driver, or one for all.")
    ] = False,
    align: Annotated[
        Literal["gate", "start"] | None,
        typer.Option(
            help="Event at which the runs are synchronised: the first gate, or the start. By default the "
            "start, where start and weather are the same."
        ),
    ] = None,
    web: Annotated[
        bool, typer.Option("--web", help="Serve rerun's viewer to a browser on this machine.")
    ] = False,
    port: Annotated[
        int | None, typer.Option(min=1, max=65535, help="Port of --web; any free one by default.")
    ] = None,
    save: Annotated[Path | None, typer.Option(help="Write a rerun recording, FILE.rrd.")] = None,
    video: Annotated[Path | None, typer.Option(help="Write a video, FILE.mp4 or FILE.gif.")] = None,
    speed: Annotated[float, typer.Option(help="Playback rate of the video.")] = 4.0,
    html: Annotated[Path | None, typer.Option(help="Write a self-contained page, FILE.html.")] = None,
) -> None:
    """Show runs of people, scripts and pilots: in rerun, as a video, or as a page."""
    from swamp_rl.experiments.artifacts.demo_runs import read_shown, refuse_missing

    from swamp_rl.demo.viewer import free_port, has_display

    window = not (web or save or video or html)
    refuse_suffix("--save", save, ".rrd")
    refuse_suffix("--video", video, ".mp4", ".gif")
    refuse_suffix("--html", html, ".html")
    if video:
        from swamp_rl.demo.video import refuse_speed

        refuse_speed(speed)
    refuse_missing(sources or [])
    if window and not has_display():
        raise UserError(NOTHING_TO_DO)
    port = free_port(port) if web else port
    scene = read_shown(sources or [], runs or [], align)
    typer.echo(printable(f"{counted(len(scene.shown), 'run')}: {scene.about}"))
    layout: Layout = "side-by-side" if side_by_side else "overlay"
    _write(scene, layout, save, html, video, speed)
    if web or window:
        _show(scene, layout, window, port)


def _write(
    scene: "DemoScene",
    layout: "Layout",
    save: Path | None,
    html: Path | None,
    video: Path | None,
    speed: float,
) -> None:
    """The files that are asked for."""
    if video:
        from swamp_rl.demo.video import frame_count, write_video

        frame_count(video, scene, speed)
    if save:
        from swamp_rl.demo.recording import write_recording

        write_recording(save, scene, layout)
        typer.echo(f"{save}: open it with rerun {save}")
    if html:
        from swamp_rl.demo.page import write_page

        write_page(html, scene, layout)
        typer.echo(f"{html}: open it in any browser")
    if video:
        frames = write_video(video, scene, layout, speed)
        typer.echo(f"{video}: {frames} frames")


def _show(scene: "DemoScene", layout: "Layout", window: bool, port: int | None) -> None:
    """A window of rerun's viewer, or its page for a browser."""
    import tempfile

    from swamp_rl.demo.recording import write_recording
    from swamp_rl.demo.viewer import open_viewer, serve

    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "demo.rrd"
        write_recording(recording, scene, layout)
        if window:
            open_viewer(recording)
        else:
            with suppress(KeyboardInterrupt):  # how the page is ended
                serve(recording, port, lambda where: typer.echo(f"{where}\nCtrl-C ends it"))
