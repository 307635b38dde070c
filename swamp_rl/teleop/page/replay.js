// A stored run, shown again in the same views.

const bar = document.getElementById("replay");
const slider = document.getElementById("replay-time");

export class Replay {
  constructor() {
    this.run = null;
    document.getElementById("replay-close").addEventListener("click", () => this.close());
    slider.addEventListener("input", () => { this.clock = Number(slider.value); this.paused = true; });
    slider.addEventListener("change", () => { this.paused = false; });
    addEventListener("keydown", (event) => { if (event.code === "Escape") this.close(); });
  }

  async open(name) {
    const answer = await fetch(`runs/${encodeURIComponent(name)}`);
    if (!answer.ok) return;
    this.run = await answer.json();
    const { about, columns, difference } = this.run;
    this.start = columns.time[0];
    this.length = columns.time.at(-1) - this.start;
    this.clock = 0;
    this.paused = false;
    slider.max = this.length;
    document.getElementById("replay-name").textContent = `${about.nickname ?? name}, ${Number(about.seconds ?? this.length).toFixed(1)} s, ${about.level ?? ""}`;
    document.getElementById("replay-exact").textContent = difference === null ? "a vehicle at a link" : difference === 0
      ? "✓ sailed again: exactly the same" : `sailed again: differs by ${difference.toExponential(1)}`;
    bar.hidden = false;
    document.body.dataset.replay = name;
  }

  close() {
    this.run = null;
    bar.hidden = true;
    delete document.body.dataset.replay;
  }

  // The boat at the replay's clock and the trail up to it.
  look(elapsed, gates) {
    if (!this.paused) this.clock = Math.min(this.clock + elapsed, this.length);
    slider.value = this.clock;
    const { about, columns: c, azimuth, throttle, levers, wind, current } = this.run;
    const time = this.start + this.clock;
    const at = Math.min(this.clock / (this.length / (c.time.length - 1)), c.time.length - 1);
    const [i, j] = [Math.floor(at), Math.min(Math.floor(at) + 1, c.time.length - 1)];
    const mix = (column) => column[i] + (at - i) * (column[j] - column[i]);
    const turn = c.heading[j] - c.heading[i];
    const heading = c.heading[i] + (at - i) * Math.atan2(Math.sin(turn), Math.cos(turn));
    const passed = gates.filter((gate) => passedBy(gate, c, j)).length;
    const boat = {
      phase: "replay", time, north: mix(c.north), east: mix(c.east), heading, u: mix(c.surge), v: mix(c.sway),
      azimuth: azimuth.map((column) => column[i] ?? 0), throttle: throttle.map((column) => column[i] ?? 0), levers: levers.map((column) => column[i] ?? 0),
      wind: wind[0].length ? [wind[0][i] * Math.cos(wind[1][i]), wind[0][i] * Math.sin(wind[1][i])] : [0, 0], current, known: wind[0].length > 0, passed,
      runTime: Math.max(0, time - (about.gates?.[0] ?? time)),
    };
    const trail = c.time.slice(0, i + 1).map((time, k) => ({ time, north: c.north[k], east: c.east[k], heading: c.heading[k], speed: Math.hypot(c.surge[k], c.sway[k]) }));
    return { boat, trail: [...trail, { ...boat, speed: Math.hypot(boat.u, boat.v) }] };
  }
}

// Whether rows up to the last cross the gate's line in its direction, between the buoys.
function passedBy(gate, c, last) {
  const [cos, sin] = [Math.cos(gate.heading), Math.sin(gate.heading)];
  const along = (k) => (c.north[k] - gate.centre[0]) * cos + (c.east[k] - gate.centre[1]) * sin;
  const across = (k) => Math.abs((c.east[k] - gate.centre[1]) * cos - (c.north[k] - gate.centre[0]) * sin);
  const half = Math.hypot(gate.buoys[0][0] - gate.buoys[1][0], gate.buoys[0][1] - gate.buoys[1][1]) / 2;
  for (let k = 1; k <= last; k++) if (along(k - 1) < 0 && along(k) >= 0 && across(k) < half) return true;
  return false;
}
