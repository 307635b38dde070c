"""The course seen from above, as a picture."""

import math

import numpy as np
from numpy.typing import NDArray
from swamp_rl.envs.fleet import Fleet

from swamp_rl.course import Gate

HEIGHT = 480  # pixels
DPI = 100
HEADING = 0.06  # length of the line ahead of the boat, of the picture's height
ROUND = (1, 2, 5)  # and their tens: lengths of the scale bar [m]
COLOURS = {"green": "tab:green", "red": "tab:red"}  # of gates by name; others are orange


def top_view(fleet: Fleet, i: int) -> NDArray[np.uint8]:
    """Boat i among the buoys, north up, with a line along its heading; (H, W, 3).

    Each gate has a line between its buoys and an arrow in its direction; a bar shows the scale [m].
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle, Polygon

    bounds = fleet.course.bounds
    aspect = (bounds.east - bounds.west) / (bounds.north - bounds.south)
    figure = Figure(figsize=(HEIGHT * aspect / DPI, HEIGHT / DPI), dpi=DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), facecolor="aliceblue")
    axes.set(xlim=(bounds.west, bounds.east), ylim=(bounds.south, bounds.north))
    for gate in fleet.course.gates:
        colour = COLOURS.get(gate.name, "tab:orange")
        tail, head = _passage(gate)
        (north0, east0), (north1, east1) = ((buoy.north, buoy.east) for buoy in gate.buoys)
        axes.plot([east0, east1], [north0, north1], ":", color=colour)
        axes.annotate("", head, tail, arrowprops={"arrowstyle": "->", "color": colour})
        for buoy in gate.buoys:
            axes.add_patch(Circle((buoy.east, buoy.north), fleet.course.buoy_radius, color=colour))
    axes.add_patch(Polygon(_outline(fleet, i), color="tab:blue"))
    north, east, heading = fleet.pose[i]
    ahead = 0.5 * fleet.boat.length + HEADING * (bounds.north - bounds.south)
    axes.plot(
        [east, east + ahead * math.sin(heading)], [north, north + ahead * math.cos(heading)], color="tab:blue"
    )
    length = _bar(0.25 * (bounds.east - bounds.west))
    west, south = (low + 0.04 * (high - low) for low, high in (axes.get_xlim(), axes.get_ylim()))
    axes.plot([west, west + length], [south, south], "k", linewidth=2.0)
    axes.annotate(f"{length:g} m", (west, south), (0, 4), textcoords="offset points")
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _bar(most: float) -> float:
    """The longest round length [m] up to `most`."""
    tens = 10.0 ** math.floor(math.log10(most))
    return max(one * tens for one in ROUND if one * tens <= most)


def _passage(gate: Gate) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ends (east, north) of an arrow through the gate, a quarter of its width to either side."""
    north, east = 0.25 * gate.width * math.cos(gate.heading), 0.25 * gate.width * math.sin(gate.heading)
    centre = gate.centre
    return (centre.east - east, centre.north - north), (centre.east + east, centre.north + north)


def _outline(fleet: Fleet, i: int) -> NDArray[np.float64]:
    """Corners (5, 2) east, north of the boat, with a bow to tell it from the stern."""
    ahead, abeam = 0.5 * fleet.boat.length, 0.5 * fleet.boat.breadth
    forward = np.array([-ahead, 0.4 * ahead, ahead, 0.4 * ahead, -ahead])
    starboard = np.array([-abeam, -abeam, 0.0, abeam, abeam])
    north, east, heading = fleet.pose[i]
    cos, sin = math.cos(heading), math.sin(heading)
    return np.column_stack([east + forward * sin + starboard * cos, north + forward * cos - starboard * sin])
