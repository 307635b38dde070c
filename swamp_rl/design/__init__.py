"""Design of a pump-jet, of a hull, and of propellers that fit a hull, from files with their provenance."""

from swamp_rl.design.hull_lines import Condition, HullDesign, load_hull
from swamp_rl.design.hydrostatics import Hydrostatics, draught_of, hydrostatics
from swamp_rl.design.matching import BestRange, Match, MatchDesign, Pitch, best_ranges, load_match, matches
from swamp_rl.design.pump_jet import (
    Geometry,
    PumpJet,
    PumpJetDesign,
    Running,
    design_pump_jet,
    load_pump_jet,
    running_at,
)
from swamp_rl.design.stability import Stability, stability
from swamp_rl.design.velocity_triangles import Triangle

__all__ = [
    "BestRange",
    "Condition",
    "Geometry",
    "HullDesign",
    "Hydrostatics",
    "Match",
    "MatchDesign",
    "Pitch",
    "PumpJet",
    "PumpJetDesign",
    "Running",
    "Stability",
    "Triangle",
    "best_ranges",
    "design_pump_jet",
    "draught_of",
    "hydrostatics",
    "load_hull",
    "load_match",
    "load_pump_jet",
    "matches",
    "running_at",
    "stability",
]
