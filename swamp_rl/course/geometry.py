"""What a boat did on its way from one point to the next: passed a gate, touched a buoy, left the bounds.

The boat is taken at midship, its hull as a disc whose diameter is the breadth: alongside a buoy, where
boats touch them, that is exact.
"""

from swamp_rl.physics.compile import compiled


@compiled
def crosses_gate(
    north0: float,
    east0: float,
    north1: float,
    east1: float,
    gate_north: float,
    gate_east: float,
    gate_cos: float,
    gate_sin: float,
    half_width: float,
) -> bool:
    """Whether the straight way from point 0 to point 1 [m] passes between the buoys in the gate's direction.

    The line through the buoys belongs to the far side, so that a way in two pieces crosses once. The opposite
    direction is no crossing.
    """
    before = (north0 - gate_north) * gate_cos + (east0 - gate_east) * gate_sin
    after = (north1 - gate_north) * gate_cos + (east1 - gate_east) * gate_sin
    if not (before < 0.0 <= after):
        return False
    share = before / (before - after)
    north = north0 + share * (north1 - north0)
    east = east0 + share * (east1 - east0)
    across = (east - gate_east) * gate_cos - (north - gate_north) * gate_sin
    return abs(across) < half_width


@compiled
def squared_distance_to_way(
    north0: float, east0: float, north1: float, east1: float, north: float, east: float
) -> float:
    """Square of the least distance [m²] of a point from the straight way between points 0 and 1."""
    way_north, way_east = north1 - north0, east1 - east0
    length_squared = way_north * way_north + way_east * way_east
    share = 0.0
    if length_squared > 0.0:
        share = ((north - north0) * way_north + (east - east0) * way_east) / length_squared
        share = min(max(share, 0.0), 1.0)
    off_north, off_east = north0 + share * way_north - north, east0 + share * way_east - east
    return off_north * off_north + off_east * off_east


@compiled
def touches_buoy(
    north0: float,
    east0: float,
    north1: float,
    east1: float,
    buoy_north: float,
    buoy_east: float,
    reach: float,
) -> bool:
    """Whether the way from point 0 to point 1 comes within `reach` [m] of the buoy's centre.

    reach: the buoy's radius and half the boat's breadth.
    """
    distance_squared = squared_distance_to_way(north0, east0, north1, east1, buoy_north, buoy_east)
    return distance_squared < reach * reach


@compiled
def outside(
    north: float, east: float, south_edge: float, north_edge: float, west_edge: float, east_edge: float
) -> bool:
    """Whether the point [m] is beyond an edge of the bounds; a place that is not a number is."""
    return not (south_edge <= north <= north_edge and west_edge <= east <= east_edge)
