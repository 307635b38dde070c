"""The panel that each verb stands in on the help page, and an example of its use."""

import typer
from typer.models import CommandInfo, TyperInfo

LEARN, CRITICISE, SAIL, DESIGN = "Learn", "Criticise", "Sail", "Design"
DATA, TOOLS = "Data", "Tools"

PANELS = {
    "run": LEARN,
    "train": LEARN,
    "evaluate": LEARN,
    "compare": LEARN,
    "sweep": LEARN,
    "export": LEARN,
    "diagnose": CRITICISE,
    "fleet": CRITICISE,
    "disturbances": CRITICISE,
    "identify": CRITICISE,
    "simulate": CRITICISE,
    "watch": CRITICISE,
    "record": SAIL,
    "record-scripted": SAIL,
    "trial": SAIL,
    "mission": SAIL,
    "vehicle": SAIL,
    "helm": SAIL,
    "follow": SAIL,
    "follow-vehicle": SAIL,
    "hold": SAIL,
    "capability": SAIL,
    "demo": SAIL,
    "design": DESIGN,
    "runs": DATA,
    "boat": TOOLS,
    "effects": TOOLS,
    "boats": TOOLS,
    "courses": TOOLS,
    "pilots": TOOLS,
    "bench": TOOLS,
}
EXAMPLES = {
    "run": "run camogli --set evaluation.episodes=50",
    "train": "train camogli --only reservoir",
    "evaluate": "evaluate results/camogli --level severe --episodes 100",
    "compare": "compare results/camogli results/severe",
    "sweep": "sweep reservoir_grid",
    "export": "export results/camogli/pilots/reservoir",
    "diagnose": "diagnose runs --boat swamp --out diagnosis",
    "fleet": "fleet boats/*/* --out fleet --workers 4",
    "disturbances": "disturbances diagnosis/diagnosis.json --out found.yaml",
    "simulate": "simulate --commands runs/run-0001.csv --boat swamp --out simulated.csv",
    "record": "record --out runs --disturbances standard",
    "record-scripted": "record-scripted --out runs --count 10",
    "mission": "mission survey --out survey",
    "watch": "watch --mcap exported/run-001.mcap",
    "vehicle": "vehicle swamp --log vehicle.log",
    "helm": "helm line-of-sight --link 127.0.0.0/24 --log helm_runs",
    "follow": "follow eight --out eight",
    "follow-vehicle": "follow-vehicle runs/run-0001.csv --behind 5 --out behind",
    "hold": "hold --current 0.2 --wind 4 --out station",
    "capability": "capability swamp --out capability",
    "demo": "demo --web",
    "effects": "effects thruster_gain",
    "boats": "boats swamp",
    "courses": "courses camogli",
    "boat new": "boat new skiff --kind outboard --length 4 --breadth 1.6 --mass 300 --thrust 400",
    "boat check": "boat check swamp --out swamp_check",
    "pilots": "pilots reservoir",
    "bench": "bench --out bench.json",
    "runs check": "runs check runs",
    "runs show": "runs show runs",
    "runs doctor": "runs doctor runs",
    "runs import": "runs import log.csv --from csv --out runs --boat swamp",
    "runs export": "runs export runs --to minari --out exported",
    "design pump-jet": "design pump-jet swamp_pump_jet --out pump_jet",
    "design hull": "design hull swamp_hull --out hull",
    "design match": "design match typhoon_match --out match",
    "identify boat": "identify boat runs --boat swamp --out identified.yaml",
    "identify waypoint-square": "identify waypoint-square typhoon --out square",
    "identify yaw-model": "identify yaw-model runs",
    "identify elementary": "identify elementary runs",
    "identify thrust-deduction": "identify thrust-deduction runs",
    "trial turning-circle": "trial turning-circle --angle 35 --throttle 0.6 --out circle",
    "trial zig-zag": "trial zig-zag --angle 20 --throttle 0.6 --out zig_zag",
    "trial spiral": "trial spiral --angle 20 --throttle 0.6 --out spiral",
    "trial reverse-spiral": "trial reverse-spiral --angle 20 --throttle 0.6 --out reverse_spiral",
    "trial pull-out": "trial pull-out --angle 20 --throttle 0.6 --out pull_out",
    "trial stopping": "trial stopping --throttle 0.6 --out stopping",
    "trial straight": "trial straight --throttle 0.3 --throttle 0.6 --out straight",
    "trial plan": "trial plan imo --out imo",
    "trial analyse": "trial analyse circle",
    "trial commands": "trial commands diagnosis/next_trial.csv --boat swamp --out sailed",
    "trial bollard": "trial bollard --boat swamp --out bollard",
    "trial towed": "trial towed --speed 1 --throttle 0.7 --out towed",
}


def add_help(app: typer.Typer, above: str = "") -> None:
    """Set the panel and the example of every verb of `app` and of the groups in it; `above`: their names."""
    verbs: list[CommandInfo | TyperInfo] = [*app.registered_commands, *app.registered_groups]
    for verb in verbs:
        name = f"{above} {verb_name(verb)}".strip()
        if not above and name in PANELS:
            verb.rich_help_panel = PANELS[name]
        if name in EXAMPLES:
            verb.epilog = f"Example: swamp-rl {EXAMPLES[name]}"
        if isinstance(verb, TyperInfo) and verb.typer_instance:
            add_help(verb.typer_instance, name)


def verb_name(verb: CommandInfo | TyperInfo) -> str:
    """The name on the command line."""
    if verb.name or isinstance(verb, TyperInfo) or verb.callback is None:
        return str(verb.name)
    return verb.callback.__name__.replace("_", "-")
