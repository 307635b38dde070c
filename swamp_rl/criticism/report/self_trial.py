"""The self-trial of a diagnosis: one sentence, and its section of the report."""

import html

from swamp_rl.criticism.report.words import readable
from swamp_rl.criticism.result import Diagnosis

COUNTS = {1: "once", 2: "twice"}


def times(count: int) -> str:
    """`once`, `twice`, `3 times`."""
    return COUNTS.get(count, f"{count} times")


def self_trial_sentence(found: Diagnosis) -> str:
    """How often twins of the answer are diagnosed alike; empty where there was no self-trial."""
    trial = found.self_trial
    if trial is None:
        return ""
    if trial.omitted is not None:
        return f"No self-trial: {trial.omitted[0].lower()}{trial.omitted[1:]}"
    own = "diagnosed as nothing wrong" if found.verdict == "nothing_wrong" else "named"
    others = [f"{times(count)} {_said(label)} instead" for label, count in trial.confused_with.items()]
    return f"{'; '.join([f'Self-trial: {own} {trial.named} of {trial.of} times', *others])}."


def _said(label: str) -> str:
    return "nothing" if label == "nothing" else label if label == "unexplained" else readable(label)


def self_trial_section(found: Diagnosis) -> str:
    """The section of the page; empty where there was no self-trial."""
    said = self_trial_sentence(found)
    if not said or found.self_trial is None:
        return ""
    how = (
        "by a search of its own"
        if found.self_trial.method == "search"
        else "by the criterion of this answer and of its competitors, linearised about fits without noise"
    )
    note = (
        ""
        if found.self_trial.omitted
        else "<p>Twins are runs simulated from this answer with the same commands, lengths, sampling and "
        f"estimated noise. Each was diagnosed from the boat file again, {how}. The rate is that at which an "
        "answer of this size would be found again, if it is true.</p>"
    )
    return f"<h2>Self-trial</h2><p><b>{html.escape(said)}</b></p>{note}"
