"""What rerun's viewer shows at first sight: chart, space, time series and the time at which to look."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from swamp_rl.demo.scene import DemoScene
from swamp_rl.demo.series import SPEED, Array

TIMELINE = "time"
RESULT = "result"
"""The entity of the text that tells who is shown and, at the end, what came of it."""
LEGEND = SPEED
"""The plot that bears the legend: every run has one."""
Layout = Literal["overlay", "side-by-side"]
FIELD, ASPECT, VIEWED = math.radians(55.0), 1.8, 0.9
"""Of the view in space: rerun's field of view from top to bottom, the least breadth over height that it is
made for, and the share of it that is used."""
ASIDE, DIP = math.radians(65.0), math.radians(32.0)
"""Where the camera looks: to the left of the longest way across all that is shown, and below the horizon."""


@dataclass
class Panel:
    """The entities of one plot, and the range of all their values with nought in it."""

    entities: list[str] = field(default_factory=list)
    low: float = 0.0
    high: float = 0.0

    def add(self, where: str, values: Array) -> None:
        """One more line."""
        self.entities.append(where)
        self.low = min(self.low, float(np.nanmin(values)))
        self.high = max(self.high, float(np.nanmax(values)))

    @property
    def range(self) -> tuple[float, float]:
        """With a margin on either side."""
        margin = 0.06 * (self.high - self.low) or 1.0
        return self.low - margin, self.high + margin


def entity(*parts: str) -> str:
    """The path of an entity, whatever characters its parts hold."""
    from rerun import new_entity_path

    return new_entity_path([part for part in parts if part])


def blueprint(scene: DemoScene, layout: Layout, panels: Mapping[str, Panel]) -> Any:
    """`panels` by their titles. Side by side, each driver has a chart of their own."""
    import rerun.blueprint as rrb

    groups = [None] if layout == "overlay" else scene.groups
    charts = [_chart(scene, group) for group in groups]
    plots = [
        rrb.TimeSeriesView(
            origin=entity("series", title),
            name=title,
            contents=[f"+ {where}" for where in panel.entities],
            axis_y=rrb.ScalarAxis(range=panel.range),
            plot_legend=rrb.PlotLegend(corner="RightBottom", visible=scene.few and title == LEGEND),
        )
        for title, panel in panels.items()
    ]
    chart = charts[0] if len(charts) == 1 else rrb.Grid(*charts)
    right = rrb.Vertical(
        _space(scene), rrb.Grid(*plots, grid_columns=2), row_shares=[4, 1.6 * ((len(plots) + 1) // 2)]
    )
    texts = rrb.TextDocumentView(origin=RESULT, name="weather, and at the end the result")
    left = rrb.Vertical(chart, texts, row_shares=[5.0, 2.3])
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[5, 6]),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed", loop_mode="all"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="collapsed"),
        auto_views=False,
        auto_layout=False,
    )


def _trails(scene: DemoScene, root: str) -> dict[Any, Any]:
    """Rerun takes a track's own range, so that boats show where they are and tracks where they have been."""
    import rerun.blueprint as rrb

    everything = rrb.VisibleTimeRange(
        TIMELINE, start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )
    growing = scene.fleets if scene.few else ()
    return {
        entity(root, "runs", *fleet.path, "track"): [rrb.VisibleTimeRanges([everything])] for fleet in growing
    }


def _chart(scene: DemoScene, group: str | None) -> Any:
    import rerun.blueprint as rrb

    south, north, west, east = scene.edges()
    where = "north is up" if scene.course is None else f"{scene.course.name}, north is up"
    shown = "chart/runs" if group is None else entity("chart", "runs", group)
    return rrb.Spatial2DView(
        origin="chart",
        contents=["+ /chart/course/**", f"+ {'' if shown.startswith('/') else '/'}{shown}/**"],
        name=f"{group or ' · '.join(scene.groups)}: {where}",
        background=(18, 34, 48),
        visual_bounds=rrb.VisualBounds2D(x_range=(west, east), y_range=(-north, -south)),
        overrides=_trails(scene, "chart"),
    )


def eye(scene: DemoScene) -> tuple[Array, Array]:
    """Where the camera is and what it looks at, (3,) east, north and up [m]; all tracks and buoys in view."""
    places = np.vstack([*(item.run.pose[:, :2] for item in scene.shown), scene.buoys])[:, ::-1]
    places = np.column_stack([places, np.zeros(len(places))])
    target, longest = places.mean(axis=0), np.linalg.svd(places - places.mean(axis=0))[2][0]
    looks = math.atan2(longest[0], longest[1]) - ASIDE
    ahead = np.array([math.sin(looks) * math.cos(DIP), math.cos(looks) * math.cos(DIP), -math.sin(DIP)])
    right = np.array([math.cos(looks), -math.sin(looks), 0.0])
    axes = np.stack([right, np.cross(right, ahead)])
    reach = VIEWED * math.tan(0.5 * FIELD) * np.array([ASPECT, 1.0])
    back = 0.0
    for _ in range(10):  # what is near looks larger, so the middle of the view is found step by step
        off = places - target
        back = float((np.abs(off @ axes.T) / reach - (off @ ahead)[:, None]).max()) + scene.length
        seen = off @ axes.T / (off @ ahead + back)[:, None]
        target = target + 0.5 * back * (seen.min(axis=0) + seen.max(axis=0)) @ axes
    return target - back * ahead, target


def _space(scene: DemoScene) -> Any:
    import rerun.blueprint as rrb

    position, target = eye(scene)
    return rrb.Spatial3DView(
        origin="space",
        name="from the side",
        background=(135, 170, 195),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(position=position, look_target=target, eye_up=(0.0, 0.0, 1.0)),
        overrides=_trails(scene, "space"),
    )
