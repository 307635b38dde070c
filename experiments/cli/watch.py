"""`swamp-rl watch`: online fault detection on a live or recorded stream."""

import json
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from swamp_rl.counted import counted


def watch(
    link: Annotated[
        str | None,
        typer.Option("--link", help="A vehicle's address, as `swamp-rl vehicle --address` takes it."),
    ] = None,
    mcap: Annotated[Path | None, typer.Option("--mcap", help="A recorded run, as an MCAP file.")] = None,
    boat: Annotated[
        str | None,
        typer.Option("--boat", help="Boat to predict with; by default the MCAP file's, or else swamp."),
    ] = None,
    topic: Annotated[str | None, typer.Option(help="Topic of an MCAP file with several.")] = None,
    seconds: Annotated[
        float | None, typer.Option(min=1.0, max=1e7, help="Length of the stream to process (s).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object a line.")] = False,
) -> None:
    """Detect and isolate faults of a boat under way: thrusters, sensors, current."""
    from dataclasses import asdict

    from swamp_rl.boat import load_boat
    from swamp_rl.errors import UserError
    from swamp_rl.link import samples
    from swamp_rl.monitor import Monitor
    from swamp_rl.runs.mcap_files import boat_of_mcap

    if (link is None) == (mcap is None):
        raise UserError("name what to watch: either --link ADDRESS or --mcap FILE")
    if mcap is not None and mcap.suffix.lower() != ".mcap":
        raise UserError(f"{mcap}: is no .mcap file; `swamp-rl runs export --to mcap` writes one of a run")
    own = boat_of_mcap(mcap) if mcap and not boat else None
    known = own or load_boat(boat or "swamp")
    monitor = Monitor(known)
    last, count, printed = 0.0, 0, False
    with suppress(KeyboardInterrupt):  # how one stops watching
        for sample in samples(str(link or mcap), known, topic):
            notices = monitor.feed(sample)
            last, count = sample.time, count + 1
            if monitor.watching and not printed and not as_json:
                typer.echo(f"{last:.1f} s: noise and innovation statistics estimated; monitoring")
                printed = True
            for notice in notices:
                typer.echo(json.dumps(asdict(notice), allow_nan=False) if as_json else notice.text)
            if seconds is not None and last >= seconds:
                break
    if not monitor.watching:
        raise UserError(
            f"{link or mcap}: {last:.0f} s processed; the first 30 s calibrate the noise, and monitoring "
            "begins then: give a longer run"
        )
    if not as_json:
        typer.echo(f"{last:.1f} s, {counted(count, 'sample')}, notices: {monitor.notices}")
