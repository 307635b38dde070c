"""The catalogue of effects, from `swamp_rl.effects.LIBRARY`."""

import math

from docs.generate.markdown import table
from swamp_rl.effects import LIBRARY, Effect, Parameter
from swamp_rl.effects.curve import COEFFICIENTS, COMPONENTS, COVARIATES
from swamp_rl.physics.force_curve import KNOTS

ACTS_ON = {
    "force": "Forces on the boat",
    "actuator": "Actuators",
    "sensor": "Sensors",
    "command": "Commands",
}
COMBINED = {
    "add": "their values add up",
    "multiply": "their values multiply",
    "replace": "the last one holds",
}


CURVE = f"""`component`: {", ".join(COMPONENTS)}. `covariate`: {", ".join(COVARIATES)} (SI, rad).
`thruster` names one, of a thrust, an azimuth or a throttle. `knots`: 2 to {KNOTS} values of the variable;
`values`: the force [N] or moment [N m] at each, linear between them and zero outside. With `formula`
({", ".join(COEFFICIENTS)}) `knots` are the two ends of its
range and `values` its coefficients. `standard_errors`, of the values, may be left out and does not act.
"""


def effects() -> str:
    """A section for each effect, in groups by what it acts on."""
    parts = []
    for acts_on, title in ACTS_ON.items():
        parts.append(f"## {title}\n")
        parts += [_effect(effect) for effect in LIBRARY.values() if effect.acts_on == acts_on]
    return "\n".join(parts)


def _effect(effect: Effect) -> str:
    lines = [f"### {effect.name}\n", f"{effect.description[0].upper()}{effect.description[1:]}.\n"]
    if effect.swaps:
        lines.append("`thruster` names two thrusters. There are no other parameters.\n")
    elif effect.thruster:
        others = " There are no other parameters." if effect.reverses else ""
        lines.append(f"`thruster` names one thruster, or `all`.{others}\n")
    if effect.curve:
        lines.append(CURVE)
    if effect.parameters:
        head = ["parameter", "unit", "neutral value", "allowed", "required"]
        lines.append(table(head, [_row(parameter) for parameter in effect.parameters]))
    several = f"Several of it: {COMBINED[effect.combine]}."
    lines.append(f"{several}{_in_a_diagnosis(effect)} Source: {effect.source}.\n")
    return "\n".join(lines)


def _in_a_diagnosis(effect: Effect) -> str:
    scope = getattr(effect, "scope", "boat")
    differs = scope != "boat" and getattr(effect, "begin", None)
    return f" In a diagnosis it may differ from {scope} to {scope}." if differs else ""


def _row(parameter: Parameter) -> list[str]:
    neutral = "of the boat file" if parameter.neutral is None else f"{parameter.neutral:g}"
    limit = f" ({parameter.limit})" if parameter.limit else ""
    required = "yes" if parameter.required else "no"
    return [f"`{parameter.name}`", parameter.unit, neutral, _bounds(parameter) + limit, required]


def _bounds(parameter: Parameter) -> str:
    low = f"{'>' if parameter.above_low else '≥'} {parameter.low:.6g}" if parameter.low > -math.inf else ""
    high = f"≤ {parameter.high:.6g}" if parameter.high < math.inf else ""
    return ", ".join(filter(None, (low, high))).replace("-", "−") or "any finite number"
