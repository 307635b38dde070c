"""Faults of a mapping name the option or the file that contains them."""

from pathlib import Path

import pytest

from swamp_rl.errors import UserError
from swamp_rl.logs.mapping import mapping_of


@pytest.mark.parametrize("function", ["rate", "turn_rate", "integral"])
def test_a_function_of_time_in_the_times_themselves_is_reported_with_the_option_or_the_file(
    tmp_path: Path, function: str
) -> None:
    file = tmp_path / "mapping.yaml"
    file.write_text(f"columns: {{x: n, gps.time: {function}(t)}}\n")
    for option, where in (
        (f"gps.time={function}(t)", "--map gps.time"),
        (str(file), f"{file}: columns.gps.time"),
    ):
        with pytest.raises(UserError, match=rf"{function}\(\) needs the times of the table") as error:
            mapping_of([option])
        assert str(error.value).startswith(f"{where}: expression ")


@pytest.mark.parametrize("pair", ["gps.course ~ (", "gps.course", "gps.course ~ ahrs.psi ~ 1"])
def test_a_malformed_clock_is_reported_with_the_option_or_the_file(tmp_path: Path, pair: str) -> None:
    file = tmp_path / "mapping.yaml"
    file.write_text(f"columns: {{x: n}}\nclock: ['{pair}']\n")
    for options, clock, where in ([], [pair], f"--clock {pair}: "), ([str(file)], [], f"{file}: clock: "):
        with pytest.raises(UserError) as error:
            mapping_of(options, clock=clock)
        assert str(error.value).startswith(where)
