"""Design of a pump-jet, of a hull, and of propellers that fit a hull, from files with their provenance."""

from swamp_rl.design.hull_lines import HullDesign, load_hull
from swamp_rl.design.hydrostatics import Hydrostatics, draught_of, hydrostatics
from swamp_rl.design.matching import BestRange, Match, MatchDesign, best_ranges, load_match, matches
from swamp_rl.design.pump_jet import PumpJet, PumpJetDesign, design_pump_jet, load_pump_jet, running_at
from swamp_rl.design.stability import Stability, stability

__all__ = [
    "BestRange",
    "HullDesign",
    "Hydrostatics",
    "Match",
    "MatchDesign",
    "PumpJet",
    "PumpJetDesign",
    "Stability",
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
