"""What the thesis's own simulator gets wrong about SWAMP's sea trials, and which effects would mend it.

    python -m benchmarks.sea_trials

Fits every effect of the library to the published figures and writes docs/sea_trials.md.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, permutations
from pathlib import Path

import numpy as np
from swamp_rl.experiments.reports.experiment import table

from benchmarks.sea_trials_model import (
    ALL60,
    NOTHING,
    PUBLISHED,
    READ,
    Figure,
    Fitted,
    Model,
    Run,
    fitted,
    of_atom,
    predicted,
    sailed,
    speed,
    with_even_factor,
)
from swamp_rl.boat import Boat, load_boat
from swamp_rl.criticism.candidates import NUISANCE, Atom, Hypothesis, candidates, hull_nuisance
from swamp_rl.files import write_beside
from swamp_rl.simulator import parameters

ROOT = Path(__file__).resolve().parents[1]
BOAT = "swamp-light"
LONGEST = 120.0  # s
AHEAD = PUBLISHED[:4]
NOT_ASKED = ("thruster_failure", "channel_swap")  # would have been noticed on the day
EARTH = ("current", "drifting_current", "wind", "waves", "external_force")  # no courses are published
SHOWN = 12
SAILED = 7  # trials shown, the best first
PAIRED = 6  # of the best single effects, tried two by two
ENOUGH = 3.0  # standard errors that decide

TRIALS = (
    Figure("bollard pull, four thrusters at 30 %", Run(0, 0, (0.3,) * 4, 30.0), "pull", 0.0, 0.3),
    Figure("bollard pull, four thrusters at 60 %", Run(0, 0, ALL60, 30.0), "pull", 0.0, 0.3),
    Figure("straight, four thrusters at 30 %", Run(0, 0, (0.3,) * 4), "speed", 0.0, 0.03),
    Figure("straight, four thrusters at 45 %", Run(0, 0, (0.45,) * 4), "speed", 0.0, 0.03),
    Figure("straight, four thrusters at 80 %", Run(0, 0, (0.8,) * 4), "speed", 0.0, 0.03),
    Figure("straight at 60 %, then 10 s adrift", Run(0, 0, ALL60, 60.0, 10.0), "speed at the end", 0, 0.03),
    Figure("straight at 100 %, then 5 s adrift", Run(0, 0, (1,) * 4, 60.0, 5.0), "speed at the end", 0, 0.03),
    Figure("circle, 15 degrees, 60 %", Run(15, -15, ALL60), "yaw rate", 0.0, 0.5),
    Figure("circle, 45 degrees, 60 %", Run(45, -45, ALL60), "yaw rate", 0.0, 0.5),
    Figure("circle, 75 degrees, 60 %", Run(75, -75, ALL60), "yaw rate", 0.0, 0.5),
    Figure("circle, 30 degrees, 60 %", Run(30, -30, ALL60), "yaw rate", 0.0, 0.5),
    Figure("circle, 60 degrees, 60 %", Run(60, -60, ALL60), "yaw rate", 0.0, 0.5),
    Figure("circle, 30 degrees, 100 %", Run(30, -30, (1,) * 4), "speed", 0.0, 0.03),
    Figure("spin, 90 degrees, 60 %", Run(90, -90, ALL60), "yaw rate", 0.0, 0.5),
)


def atoms(boat: Boat) -> list[Atom]:
    """Effects that could stand behind steady figures: of forces and actuators, fixed to the boat."""
    hull = hull_nuisance()
    every = [*candidates(boat, LONGEST), *([hull] if hull else [])]
    return [
        atom
        for atom in every
        if atom.effect.acts_on != "sensor" and atom.specs and atom.effect.name not in (*NOT_ASKED, *EARTH)
    ]


def limit(size: int, count: int = len(PUBLISHED)) -> float:
    """chi2 of `count` figures that a right model with `size` free numbers stays below in 95 of 100 cases."""
    from scipy.stats import chi2

    return float(chi2.ppf(0.95, max(count - size, 1)))


def numbers(found: Fitted) -> str:
    """The fitted numbers by name."""
    named = zip(found.model.numbers, found.x, strict=True)
    return ", ".join(f"{name} {value:.3g}" for name, value in named) or "–"


def published_table(boat: Boat, models: Sequence[Fitted], figures: Sequence[Figure] = PUBLISHED) -> str:
    """Published figures beside what models make of them."""
    made = [predicted(boat, one.model.apply(boat, one.x), figures) for one in models]
    rows = []
    for i, figure in enumerate(figures):
        unit = READ[figure.what][0]
        cells = [f"{values[i]:.2f} ({(values[i] - figure.value) / figure.error:+.1f})" for values in made]
        given = f"{figure.value:g} ± {figure.error:g}"
        rows.append([figure.name, f"{figure.what} [{unit}]", figure.said, given, *cells])
    rows.append(["**chi2**", "", "", "", *(f"**{one.chi2:.1f}**" for one in models)])
    return table(["trial", "figure", "in the thesis", "taken as", *(one.model.name for one in models)], rows)


def ranking(found: Sequence[Fitted], count: int = len(PUBLISHED)) -> str:
    """Models by chi2 of `count` figures."""
    rows = []
    for one in found:
        enough = "yes" if one.chi2 < limit(len(one.x), count) else "no"
        rows.append([one.model.name, numbers(one), f"{one.chi2:.1f}", enough])
    return table(["model", "fitted numbers", f"chi2 of {count} figures", "fits"], rows)


def other_reading() -> list[Figure]:
    """The figures, if by tactical diameter the thesis means that of the steady circle."""
    return [
        replace(figure, what="steady diameter") if figure.what == "tactical diameter" else figure
        for figure in PUBLISHED
    ]


def pairs(boat: Boat, best: Sequence[Atom]) -> list[Fitted]:
    """Two effects at once, of the best single ones."""
    found = [fitted(boat, together(*two), PUBLISHED, wide=False) for two in combinations(best, 2)]
    return sorted(found, key=lambda made: made.chi2)


def together(*atoms: Atom) -> Model:
    """Several effects as one model."""
    hypothesis = Hypothesis(tuple(sorted(atoms, key=lambda atom: atom.label)))
    parts = [of_atom(atom) for atom in hypothesis.atoms]
    start, low, high, prior = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("start", "low", "high", "prior")
    )
    names = tuple(name for part in parts for name in part.numbers)
    return Model(
        hypothesis.label, names, start, low, high, lambda boat, x: hypothesis.records(boat, x[None]), prior
    )


def wrong_words(boat: Boat, figures: Sequence[Figure]) -> str:
    """Which figures the boat file meets within two standard deviations, and which way the others are off."""
    made = predicted(boat, parameters(boat), figures)
    met, off = [], []
    for figure, value in zip(figures, made, strict=True):
        away = (value - figure.value) / figure.error
        if abs(away) <= 2.0:
            met.append(f"{figure.what} of {figure.name}")
        else:
            off.append(f"{figure.what} of {figure.name} ({value / figure.value - 1.0:+.0%})")
    return f"Within two standard deviations: {'; '.join(met) or 'none'}. Beyond: {'; '.join(off) or 'none'}."


def share_words(boat: Boat) -> str:
    """How much the jet's share and the curve change with the throttle."""
    shares, curve = zip(*((ahead / own, factor) for _, ahead, own, factor in advance(boat)), strict=True)
    return (
        "Over these throttles the ratio, and with it the share that such a loss takes, lies between "
        f"{min(shares):.2f} and {max(shares):.2f}, while the curve goes from {curve[0]:.2f} to "
        f"{curve[-1]:.2f}."
    )


def advance(boat: Boat) -> list[tuple[float, float, float, float]]:
    """Throttle, speed [m/s], the jets' own speed [m/s] and the curve's factor in steady straight runs."""
    record, found = parameters(boat), []
    for throttle in (0.3, 0.45, 0.6, 0.8, 1.0):
        run = Run(0, 0, (throttle,) * 4)
        ahead = speed(sailed(boat, record, run), boat, record, run)
        jet = boat.thrusters[0]
        pull = jet.thrust_quadratic * throttle**2
        own = np.sqrt(pull / (boat.water_density * jet.nozzle_area))
        low, high = record["deduction_factor_low"][0], record["deduction_factor_high"][0]
        curve = low + (throttle - 0.3) / 0.7 * (high - low)
        found.append((throttle, float(ahead), float(own), float(curve)))
    return found


def advance_table(boat: Boat) -> str:
    """How fast the water passes the jets in steady straight runs, over the jets' own speed."""
    rows = [
        [f"{100 * throttle:.0f} %", f"{ahead:.2f}", f"{own:.2f}", f"{ahead / own:.2f}", f"{curve:.2f}"]
        for throttle, ahead, own, curve in advance(boat)
    ]
    head = ["throttle", "speed V_a, m/s", "jet V_o, m/s", "V_a / V_o", "(1 - t) of figure 7.56"]
    return table(head, rows)


def separation(boat: Boat, truth: Fitted, rival: Fitted, known: Sequence[Figure], trial: Figure) -> float:
    """Standard errors between two models in a trial, the rival refitted to what is known and the trial."""
    value = float(predicted(boat, truth.model.apply(boat, truth.x), [trial])[0])
    figures = [*known, replace(trial, value=value)]
    again = fitted(boat, replace(rival.model, start=rival.x), figures, wide=False)
    return float(np.sqrt(max(again.chi2 - rival.chi2, 0.0)))


def trial_table(boat: Boat, rivals: Sequence[Fitted], known: Sequence[Figure]) -> tuple[str, str]:
    """Least separation of any two rivals, whichever is right, trial by trial; and the best trial's name."""
    rows, least = [], []
    for trial in TRIALS:
        least.append(min(separation(boat, a, b, known, trial) for a, b in permutations(rivals, 2)))
        values = [predicted(boat, one.model.apply(boat, one.x), [trial])[0] for one in rivals]
        measured = f"{trial.what} ± {trial.error:g} {READ[trial.what][0]}"
        rows.append([trial.name, measured, *(f"{value:.2f}" for value in values), f"{least[-1]:.1f}"])
    order = np.argsort(-np.array(least), kind="stable")
    head = ["trial", "measured", *(one.model.name for one in rivals), "least separation"]
    best = TRIALS[int(order[0])].name
    decides = "decides" if max(least) >= ENOUGH else "would need to be repeated to decide"
    return table(head, [rows[i] for i in order[:SAILED]]), f"**{best}** {decides} ({max(least):.1f})"


def explained(single: Sequence[Fitted]) -> str:
    """How many single effects fit every figure."""
    fits = [one.model.name for one in single if one.chi2 < limit(len(one.x))]
    if fits:
        return f"{len(fits)} of {len(single)} single effects fit all of them: {', '.join(fits)}."
    nearest = single[0]
    return (
        f"**None of {len(single)} single effects fits all of them**; the nearest, `{nearest.model.name}`, "
        f"leaves a chi2 of {nearest.chi2:.0f}."
    )


def straight_models(boat: Boat, every: Sequence[Atom]) -> list[Fitted]:
    """An even (1 - t) with nothing and with each effect that acts alike on both sides, on straight runs."""
    alike = [atom for atom in every if not atom.selectors and atom.effect.name != NUISANCE]
    models = [with_even_factor(None, "even (1 - t)")]
    models += [with_even_factor(of_atom(atom), f"even (1 - t) + {atom.label}") for atom in alike]
    return sorted((fitted(boat, model, AHEAD) for model in models), key=lambda one: one.chi2)


def document(boat: Boat) -> str:
    """The text of docs/sea_trials.md."""
    nominal = fitted(boat, NOTHING, PUBLISHED)
    every = atoms(boat)
    single = sorted((fitted(boat, of_atom(atom), PUBLISHED) for atom in every), key=lambda one: one.chi2)
    by_name = {atom.label: atom for atom in every}
    both = pairs(boat, [by_name[one.model.name] for one in single[:PAIRED]])
    fitting = sum(one.chi2 < limit(len(one.x)) for one in both)
    even = straight_models(boat, every)
    jet = next(one for one in even if one.model.name.endswith("advance_thrust_loss"))
    other = next(one for one in even if one is not jet)
    ahead = fitted(boat, NOTHING, AHEAD)
    curve_table, curve_trial = trial_table(boat, [ahead, jet], AHEAD)
    other_table, other_trial = trial_table(boat, [ahead, other], AHEAD)
    steady = other_reading()
    alike = [one for one in single if NUISANCE not in one.model.name][:3]  # it holds the others' coefficients
    circle_table, circle_trial = trial_table(boat, alike, PUBLISHED)
    again = sorted((fitted(boat, of_atom(atom), steady) for atom in every), key=lambda one: one.chi2)
    reread = [fitted(boat, NOTHING, steady), *again]
    return f"""# SWAMP's sea trials against the thesis's own simulator

Written by `python -m benchmarks.sea_trials`. The measured figures are those printed in the thesis (7.3.2,
7.3.5); the tracks themselves are not published. The words "almost" and "about" are taken as the numbers
below, with standard deviations that are ours. The boat file is `{BOAT}`, 48 kg as in the trials. It holds the
thesis's model and its (1 - t) curve, so the two runs that the curve came from are met by construction. In
brackets: standard deviations off. Circles: bow azimuths to one side, stern azimuths to the other, 60 %.

## What the simulator gets wrong

{published_table(boat, [nominal])}

{wrong_words(boat, PUBLISHED)}

## Which single effects explain both circles and the straight runs

Every effect of the library that is fixed to the boat and acts on forces, actuators or commands, on every
thruster, fitted to the {len(PUBLISHED)} figures. {explained(single)} "Fits" means a chi2 that a right model
stays below in 95 of 100 cases.

{ranking([nominal, *single[:SHOWN]])}

What the best three make of each figure:

{published_table(boat, single[:3])}

Two at once, of the best {PAIRED} single effects: {fitting} of {len(both)} pairs fit.

{ranking(both[:5])}

The thesis does not say how it took the tactical diameter. Read as the diameter of the steady circle:
{wrong_words(boat, steady)} {explained(again)}

{ranking(reread[:6])}

{published_table(boat, reread[:3], steady)}

## Is the (1 - t) curve of figure 7.56 the jet's loss with advance speed?

The jet of a pump gains less momentum the faster the water already comes at it: the thrust falls by the factor
1 - f V_a / V_o, V_o = √(T / (ρ A_n)). In steady straight runs this ratio hardly changes with the throttle,
since the speed and the jet both grow with it:

{advance_table(boat)}

{share_words(boat)}

On the four straight figures alone, an even (1 - t) of at most 1 (the bench's bollard pull) in place of the
curve, with one more effect of the library that acts alike on both sides:

{ranking([ahead, *even[:8]], len(AHEAD))}

{published_table(boat, [jet, other], AHEAD)}

{verdict_on_curve(jet, other)}

## Which trial would settle it

For each trial: what each model predicts, and the least separation of any two in standard errors, whichever is
right, the other refitted to the old figures and the new one together. The errors of the trials are those of
RTK positions, a compass and a spring balance (ours). {ENOUGH:g} standard errors decide.

The (1 - t) curve as it stands, or the jet's loss (known: the straight figures): {curve_trial}.

{curve_table}

The curve, or `{other.model.name}` (known: the straight figures): {other_trial}.

{other_table}

The three best single effects, but for `hull_coefficients`, which holds the others' numbers (known: all
figures): {circle_trial}.

{circle_table}
"""


def verdict_on_curve(jet: Fitted, other: Fitted) -> str:
    """In words, whether the jet's loss can stand in for the curve."""
    enough = limit(len(jet.x), len(AHEAD))
    if jet.chi2 < enough:
        return "The jet's loss with advance speed can stand in for the curve in straight running."
    rest = "can" if other.chi2 < limit(len(other.x), len(AHEAD)) else "cannot either"
    return (
        f"**No**: with its factor free, the jet's loss leaves a chi2 of {jet.chi2:.1f} of {len(AHEAD)} "
        f"figures, where a right model stays below {enough:.1f}. `{other.model.name}` {rest} stand in for "
        f"the curve ({other.chi2:.1f})."
    )


def main() -> None:
    """Write the document."""
    with write_beside(ROOT / "docs" / "sea_trials.md") as part:
        part.write_text(document(load_boat(BOAT)), encoding="utf-8")


if __name__ == "__main__":
    main()
