"""State of charge: against a numerical integration, conservation of charge and energy, and its limits."""

import numpy as np
import pytest

from swamp_rl.boat import load_boat
from swamp_rl.boat.battery import Battery
from swamp_rl.energy import charge_at, current_at, discharge, stored_energy, voltage_at


@pytest.fixture(scope="module")
def battery() -> Battery:
    found = load_boat("swamp").battery
    assert found is not None
    return found


def powers(seed: int, rows: int = 400) -> np.ndarray:
    return np.random.default_rng(seed).uniform(90.0, 280.0, (rows, 2))


def test_charge_follows_a_fine_integration_of_power_over_voltage(battery: Battery) -> None:
    power, step, fine = powers(1), 10.0, 200
    found = discharge(battery, power, step)
    charge = np.ones(2)
    for row in power:
        for _ in range(fine):
            voltage = 32.0 + 8.0 * charge
            charge = charge - row / voltage * (step / fine) / 46800.0
    assert found.charge[-1] == pytest.approx(charge, abs=2e-6)


def test_energy_is_the_integral_of_power_and_of_voltage_times_current(battery: Battery) -> None:
    power, step = powers(2), 10.0
    found = discharge(battery, power, step)
    assert found.energy[-1] == pytest.approx(power.sum(axis=0) * step)
    middle = 0.5 * (found.voltage[:-1] + found.voltage[1:])  # exact: the voltage is linear in the charge
    assert (middle * found.current * step).sum(axis=0) == pytest.approx(found.energy[-1], rel=1e-9)


def test_the_charge_drawn_is_the_charge_lost(battery: Battery) -> None:
    found = discharge(battery, powers(3), 10.0)
    drawn = (found.current * 10.0).sum(axis=0)
    assert drawn == pytest.approx((1.0 - found.charge[-1]) * battery.capacity, rel=1e-9)


def test_charge_and_voltage_fall_and_the_current_rises_under_a_constant_power(battery: Battery) -> None:
    found = discharge(battery, np.full((300, 1), 250.0), 10.0)
    assert np.all(np.diff(found.charge, axis=0) < 0.0)
    assert np.all(np.diff(found.voltage, axis=0) < 0.0)
    assert np.all(np.diff(found.current, axis=0) > 0.0)
    ends = current_at(battery, np.array(250.0), found.charge[[0, -1], 0])
    assert ends[0] < found.current[0, 0] < found.current[-1, 0] < ends[1]


def test_energy_and_charge_are_each_others_inverse(battery: Battery) -> None:
    charge = np.linspace(0.0, 1.0, 101)
    assert charge_at(battery, stored_energy(battery, charge)) == pytest.approx(charge, abs=1e-12)
    flat = battery.model_copy(update={"voltage_empty": battery.voltage_full})
    assert charge_at(flat, stored_energy(flat, charge)) == pytest.approx(charge, abs=1e-12)


def test_an_empty_pack_stays_empty(battery: Battery) -> None:
    found = discharge(battery, np.full((10, 1), 250.0), 100.0, start=0.01)
    assert np.all(found.charge[-5:] == 0.0)
    assert np.all(found.current[-3:] == 0.0)
    assert voltage_at(battery, found.charge[-1]) == pytest.approx(32.0)


def test_a_mirrored_power_gives_mirrored_packs(battery: Battery) -> None:
    power = powers(4)
    one, other = discharge(battery, power, 1.0), discharge(battery, power[:, ::-1], 1.0)
    np.testing.assert_array_equal(one.charge, other.charge[:, ::-1])
