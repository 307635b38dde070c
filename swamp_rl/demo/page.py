"""A page with an animated replay that needs no viewer, no network and no other file."""

import html
import json
from pathlib import Path
from typing import Any

import numpy as np

from swamp_rl.demo.card import HEAD, card
from swamp_rl.demo.clock import Array, poses_at, values_at
from swamp_rl.demo.colours import Colour
from swamp_rl.demo.layout import Layout
from swamp_rl.demo.scene import DemoScene, Fleet, Shown, gate_colour
from swamp_rl.demo.series import CURRENT, WIND, series_of
from swamp_rl.demo.shapes import OUTLINE
from swamp_rl.demo.weather import flows_of
from swamp_rl.files import write_text

TEMPLATE = Path(__file__).with_name("page.html")
STEP = 0.2
"""Between the places that the page holds [s]; it moves boats smoothly between them."""


def write_page(path: Path | str, scene: DemoScene, layout: Layout = "overlay") -> None:
    """Write the replay as one HTML file. UserError where it cannot be written."""
    write_text(path, page(scene, layout))


def page(scene: DemoScene, layout: Layout = "overlay") -> str:
    """The page's text. Names are data to it, never markup."""
    data = json.dumps(_data(scene, layout), ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    # Within a script element only these could end it or begin a comment.
    for mark in "<>&":
        data = data.replace(mark, f"\\u{ord(mark):04x}")
    before, after = TEMPLATE.read_text(encoding="utf-8").split("/*DATA*/")
    return before.replace("<!--TITLE-->", html.escape(scene.title)) + data + after


def _data(scene: DemoScene, layout: Layout) -> dict[str, Any]:
    return {
        "title": scene.title,
        "about": scene.about,
        "sideBySide": layout == "side-by-side",
        "few": scene.few,
        "same": scene.conditions.same,
        "card": {
            "head": HEAD,
            "lines": [{"colour": _css(line.colour), "cells": line.cells} for line in card(scene)],
        },
        "edges": [round(edge, 2) for edge in scene.edges()],
        "outline": np.round(OUTLINE * (scene.length, scene.breadth), 3).tolist(),
        "scale": scene.scale,
        "gates": _gates(scene),
        "end": round(scene.end, 2),
        "step": STEP,
        "groups": [
            {"name": group, "colour": next(_css(f.colour) for f in scene.fleets if f.path[0] == group)}
            for group in scene.groups
        ],
        "runs": [_run(scene, fleet, item) for fleet in scene.fleets for item in fleet.shown],
    }


def _css(colour: Colour) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)


def _gates(scene: DemoScene) -> list[dict[str, Any]]:
    if scene.course is None:
        return []
    return [
        {
            "name": gate.name,
            "colour": _css(gate_colour(gate.name)),
            "buoys": [[buoy.north, buoy.east] for buoy in gate.buoys],
            "centre": [gate.centre.north, gate.centre.east],
            "heading": gate.heading,
            "radius": max(scene.course.buoy_radius, 0.2 * scene.scale),
        }
        for gate in scene.course.gates
    ]


def _run(scene: DemoScene, fleet: Fleet, item: Shown) -> dict[str, Any]:
    times = item.start + np.arange(np.floor(item.run.duration / STEP + 1e-9) + 1.0) * STEP
    pose = poses_at(item, times)
    panels = {
        f"{panel} {line}".strip(): _numbers(values_at(item, values, times), 3)
        for panel, found in series_of(item.run, scene.course).items()
        for line, values in found.items()
        if panel not in (WIND, CURRENT)
    }
    return {
        "name": scene.called(item),
        "group": item.group,
        "colour": _css(fleet.colour),
        "outcome": item.run.meta.outcome,
        "start": round(item.start, 3),
        "north": _numbers(pose[:, 0], 2),
        "east": _numbers(pose[:, 1], 2),
        "heading": _numbers(pose[:, 2], 3),
        "panels": panels,
        "flows": {
            name: [_numbers(column, 2) for column in values_at(item, flow, times).T]
            for name, flow in flows_of(item.run).items()
            if scene.few
        },
    }


def _numbers(values: Array, digits: int) -> list[float | None]:
    """Rounded, as short as JSON has them; null where there is none."""
    short = [round(value, digits) for value in values.tolist()]
    return [None if value != value else int(value) if value == int(value) else value for value in short]
