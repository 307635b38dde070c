"""Pages of the reference, written from the declarations in the code whenever the site is built."""

from collections.abc import Callable

from docs.generate.command_line import command_line
from docs.generate.effects import effects
from docs.generate.estimates import estimates
from docs.generate.examples import examples
from docs.generate.files import (
    boat_file,
    course_file,
    design_file,
    experiment_file,
    mission_file,
    path_file,
    plan_file,
    sweep_file,
    vehicle_file,
)
from docs.generate.interface import modules, public_names
from docs.generate.licences import licences

PARTS: dict[str, Callable[[], str]] = {
    "boat file": boat_file,
    "command line": command_line,
    "course file": course_file,
    "design file": design_file,
    "effects": effects,
    "estimates": estimates,
    "examples": examples,
    "experiment file": experiment_file,
    "licences": licences,
    "mission file": mission_file,
    "path file": path_file,
    "modules": modules,
    "public names": public_names,
    "sweep file": sweep_file,
    "trial plan": plan_file,
    "vehicle file": vehicle_file,
}
"""What stands in place of the line `<!-- generated: NAME -->` of a page."""
