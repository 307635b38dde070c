"""The game: a boat waits at the start, is driven through the gates, and its run is kept or not."""

import math
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from swamp_rl.errors import UserError
from swamp_rl.link.stream import Sample
from swamp_rl.pilots.pilot import Pilot
from swamp_rl.simulator.state import NORTH, TIME, YAW_RATE
from swamp_rl.teleop.berth import Berth
from swamp_rl.teleop.craft import IDLE, Array, Craft, Instant, Levers
from swamp_rl.teleop.journal import Journal
from swamp_rl.teleop.lookout import Lookout
from swamp_rl.teleop.messages import Choose, Command, clean_nickname
from swamp_rl.teleop.recordings import Recordings
from swamp_rl.teleop.rows import columns_of, row_of

DEAD_MAN = 0.25  # s without a command, until the thrusters stop
READY, RUN, ENDED, SAVING = "ready", "run", "ended", "saving"
PERSON, PILOT = "person", "pilot"
LET_GO = "Let go of the throttle: then the levers are obeyed."
WATCHED = 4
"Lines of the lookout that are shown."


class Session:
    """One boat, one run at a time; every `now` is the server's clock [s].

    READY until the first thrust; RUN from then on, each step in a journal; ENDED at the last gate, or as a
    failure, until the run is accepted, discarded or tried again.
    """

    def __init__(
        self,
        berths: Mapping[str, Berth],
        seeds: np.random.Generator,
        pilots: Mapping[str, Pilot] | None = None,
        dead_man: float = DEAD_MAN,
        lookout: Lookout | None = None,
    ) -> None:
        """berths: the boats by name, the first one chosen; pilots: by name, likewise; lookout: watches the
        boat of a run."""
        self.lookout = lookout
        self.watched: deque[str] = deque(maxlen=WATCHED)
        "The lookout's last message on the run."
        self.berths, self._seeds, self._dead_man = dict(berths), seeds, dead_man
        self.pilots = dict(pilots or {})
        self.vessel, self.pilot = next(iter(berths)), next(iter(self.pilots), None)
        self.level, self.nickname = self.levels[0], "anonymous"
        senses = dict.fromkeys(name for pilot in self.pilots.values() for name in pilot.senses)
        self._senses = tuple(senses) or ("north", "east")
        self._crafts: dict[tuple[str, str], Craft] = {}
        self._opened: dict[str, Recordings] = {}
        self._open(self.vessel)
        self._heard = -math.inf
        self._asked, self._stern = IDLE, IDLE
        self._in_force: tuple[Levers, Levers] = (IDLE, IDLE)
        self.journal: Journal | None = None
        self._complaint: str | None = None
        self._refused = self._held = False
        self._troubled: Journal | None = None
        self.renew()

    def renew(self, seed: int | None = None) -> None:
        """Put the boat at a start: that of `seed`, or a new one."""
        self.boat = self._boat(self.vessel, self.level)
        # Above any seed of an evaluation, so that no pilot is tried on what it learned from.
        self.seed = int(self._seeds.integers(2**31, 2**32)) if seed is None else seed
        self.boat.begin(self.seed)
        self.phase, self.helm = READY, PERSON
        self.rows = self.kicks = self.corrections = 0
        self.drivers: set[str] = set()
        self.gates: list[float] = []
        self._last_driver: str | None = None
        self.listen()
        self.watched.clear()
        if self.pilot is not None:
            self.pilots[self.pilot].reset(1)
        self._decide()

    def warm(self) -> None:
        """Compile what would otherwise halt the first run and the first replay of each boat."""
        for vessel, berth in self.berths.items():
            self._boat(vessel, berth.levels[0]).warm(self.seed)
        self.renew(self.seed)

    def close(self) -> None:
        """Let go of the disk; a run under way stays there as unfinished, UserError if it cannot."""
        try:
            if self.journal is not None:
                self.journal.close()
        finally:
            for recordings in self.opened:
                recordings.close()
            if self.lookout is not None:
                self.lookout.close()

    @property
    def opened(self) -> list[Recordings]:
        """The datasets of the boats that were chosen so far."""
        return list(self._opened.values())

    @property
    def recordings(self) -> Recordings:
        """Those of the chosen boat."""
        return self._opened[self.vessel]

    @property
    def levels(self) -> tuple[str, ...]:
        """What the chosen boat can meet."""
        return self.berths[self.vessel].levels

    def _boat(self, vessel: str, level: str) -> Craft:
        if (vessel, level) not in self._crafts:
            self._crafts[vessel, level] = self.berths[vessel].make_craft(level, self._senses)
        return self._crafts[vessel, level]

    def _open(self, vessel: str) -> None:
        if vessel not in self._opened:
            self._opened[vessel] = self.berths[vessel].open_recordings()

    # --- what the person does ---

    def command(self, message: Command, now: float) -> None:
        """Move the levers; the first thrust begins the run."""
        self.advance(now)
        self._heard = now if message.live else -math.inf
        self._asked = (message.throttle, message.angle)
        self._stern = (message.stern_throttle, message.stern_azimuth) if self.boat.stern else IDLE
        thrust = message.throttle > 0.0 or self.helm == PILOT
        self._heed(now)
        if self.phase == READY and message.live and thrust and not self._refused and not self._held:
            self.phase = RUN
            self.boat.start(now)
        # A run that the disk refused is not begun again by a lever that was never let go.
        self._refused &= thrust
        self._heed(now)

    def lose(self) -> None:
        """Nobody is at the levers any more."""
        self._heard = -math.inf

    def change_helm(self, now: float) -> None:
        """Give the helm to the pilot, or back; UserError where there is none."""
        if self.pilot is None:
            raise UserError("no pilot is loaded; start the recorder with --pilot MODEL")
        self.advance(now)
        self.helm = PERSON if self.helm == PILOT else PILOT
        self._heed(now)

    def choose(self, message: Choose) -> None:
        """Nickname at any time; boat, level and pilot between runs. UserError for what is not offered."""
        if message.nickname is not None:
            self.nickname = clean_nickname(message.nickname)
        vessel, level, pilot = message.boat or self.vessel, message.level, message.pilot or self.pilot
        if (message.boat, message.level, message.pilot) == (None, None, None):
            return
        if self.phase != READY:
            raise UserError("boat, level and pilot are chosen before a run")
        if vessel not in self.berths:
            raise UserError("there is no such boat")
        levels = self.berths[vessel].levels
        if level is not None and level not in levels:
            raise UserError("there is no such level")
        if pilot is not None and pilot not in self.pilots:
            raise UserError("there is no such pilot")
        self._open(vessel)
        # Not every boat has the thrusters that a level disturbs.
        kept = self.level if self.level in levels else levels[0]
        self.vessel, self.level, self.pilot = vessel, level or kept, pilot
        self.renew()

    def drop(self, again: bool) -> None:
        """Discard the run, at any time; `again` tries the same start and weather once more."""
        if self.phase == SAVING:
            raise UserError("the run is being saved")
        if self.journal is not None:
            self.recordings.discard(self.journal)
            self.journal = None
        self.renew(self.seed if again else None)

    def abandon(self) -> None:
        """Leave a run under way on the disk as unfinished, unless it is being saved, and begin anew."""
        if self.phase == SAVING:
            return
        if self.journal is not None:
            with suppress(UserError):
                self.journal.close()
            self.journal = None
        self.renew()

    def accept(self) -> Callable[[], str]:
        """What saves the ended run and returns its name: slow, so for any thread; then call `accepted`."""
        if self.phase != ENDED or self.journal is None:
            raise UserError("there is no ended run to accept")
        self.phase = SAVING
        journal, about = self.journal, self.about()
        return lambda: self.recordings.accept(journal, about)

    def accepted(self) -> None:
        """The run is saved; on to the next."""
        self.journal = None
        self.renew()

    def not_accepted(self) -> None:
        """The run could not be saved; it may be tried again, or discarded."""
        self.phase = ENDED

    # --- what the clock does ---

    def advance(self, now: float) -> None:
        """Take the control steps that have ended by `now`, and have the levers obeyed in the present one."""
        while self.phase == RUN and (end := self.boat.step_end(now)) is not None:
            self._heed(end)
            try:
                self._end_step()
            except UserError as error:
                # A run that the disk cannot even begin would be driven for nothing.
                self._complaint = f"The run cannot be recorded: {error}"
                self.drop(again=True)
                self._refused = True
                break
        self._heed(now)
        if self.phase == RUN and self.boat.outcome is not None:  # within a step: a vehicle fell silent
            self._end_run()

    def listen(self) -> bool:
        """Take in the lookout's new messages; whether there is something new."""
        messages = self.lookout.messages() if self.lookout is not None else []
        self.watched.extend(messages)
        return bool(messages)

    def stopped(self, now: float) -> bool:
        """Whether the dead-man holds the thrusters."""
        return now - self._heard > self._dead_man

    def state(self, now: float) -> Array:
        """(S,) the boat at `now`, between two control steps too."""
        return self.boat.at(now)

    @property
    def trouble(self) -> str | None:
        """Why the levers are not obeyed, to the person who moves them."""
        return self.boat.trouble or (LET_GO if self._held or self._refused else None)

    @property
    def levers(self) -> Levers:
        """Throttle and angle in force; none where the boat cannot be driven."""
        return IDLE if self.boat.trouble else self._in_force[0]

    @property
    def outcome(self) -> str | None:
        """How the run ended; None while it has not."""
        return self.boat.outcome

    @property
    def run_time(self) -> float:
        """From the first gate on [s], 0 before; on a course of one gate from the first thrust on."""
        if len(self.boat.course.gates) == 1:
            return float(self.boat.now.state[TIME])
        return round(float(self.boat.now.state[TIME]) - self.gates[0], 6) if self.gates else 0.0

    def complaint(self) -> str | None:
        """What is wrong with the disk, each time once; also what it refuses after the run has ended."""
        journal = self.journal
        if journal is not None and journal.trouble is not None and journal is not self._troubled:
            self._complaint = f"The run is not on the disk, accepting it tries again: {journal.trouble}"
            self._troubled = journal
        last, self._complaint = self._complaint, None
        return last

    def _heed(self, now: float) -> None:
        # A boat that can obey again does so once both throttles were let go.
        thrust = self._asked[0] > 0.0 or self._stern[0] > 0.0
        self._held = bool(self.boat.trouble) or (self._held and thrust)
        if self.stopped(now) or self._held:
            self._in_force = (IDLE, IDLE)
        else:
            driven = self._decided if self.helm == PILOT and self.phase == RUN else self._asked
            self._in_force = (driven, self._stern)
        self.boat.heed(now, *self._in_force)

    def _end_step(self) -> None:
        before, after = self.boat.go_on()
        if self.journal is None:
            self.journal = self.recordings.begin(self._columns(), self.about())
            if self.lookout is not None:
                self.lookout.begin(self.boat.boat)
        self._note_driver()
        self._write(before)
        if after.passed > before.passed:
            self.gates += [float(after.state[TIME])] * (after.passed - before.passed)
            self.journal.describe(self.about())
        if self.boat.outcome is not None:
            self._end_run()
        else:
            self._decide()

    def _end_run(self) -> None:
        if self.journal is None:
            self.renew()
            return
        self._write(self.boat.now)
        self.journal.describe(self.about())
        self.phase = ENDED

    def _note_driver(self) -> None:
        self.drivers.add(self.helm)
        self.corrections += self._last_driver == PILOT and self.helm == PERSON
        self._last_driver = self.helm
        self.kicks += self._in_force[1][0] > 0.0

    def _write(self, instant: Instant) -> None:
        assert self.journal is not None
        if self.lookout is not None:
            motion = instant.state[NORTH : YAW_RATE + 1].copy()
            self.lookout.see(Sample(float(instant.state[TIME]), instant.commands, motion))
        pilot = None
        if self.pilot is not None:
            pilot = (float(self.helm == PILOT), *self._decided)
        weather = self.boat.weather(instant.state)
        self.journal.append(row_of(self.boat.boat, instant, weather, pilot))
        self.rows += 1

    def _decide(self) -> None:
        """Let the pilot, who watches even when it does not drive, decide on the step that begins."""
        self._decided: Levers = IDLE
        if self.pilot is not None:
            pilot = self.pilots[self.pilot]
            places = [self._senses.index(name) for name in pilot.senses]
            throttle, angle = pilot.act(self.boat.observation[None, places])[0]
            self._decided = float(np.clip(throttle, 0.0, 1.0)), float(np.clip(angle, -1.0, 1.0))

    def _columns(self) -> list[str]:
        return columns_of(self.boat.boat, self.boat.simulated, self.pilot is not None)

    def about(self) -> dict[str, Any]:
        """The run's description, as its entry in `dataset.yaml`."""
        drivers = "both" if len(self.drivers) > 1 else next(iter(self.drivers), self.helm)
        about: dict[str, Any] = {
            **self.boat.about(),
            "nickname": self.nickname,
            "level": self.level,
            "helm": drivers,
        }
        if self.gates:
            about["gates"] = list(self.gates)
        if self.outcome is not None:
            about |= {"outcome": self.outcome, "seconds": self.run_time}
        if self.kicks:
            about["kicked_steps"] = self.kicks
        if self.pilot is not None:
            about |= {"pilot": self.pilot, "corrections": self.corrections}
        return about
