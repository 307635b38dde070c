// What both views share.

const WAKE_SECONDS = 11, BAND_SECONDS = 1.1;
const NAMED = { green: "#37e07f", red: "#ff5a52" };

export const gateColour = (gate, index) => NAMED[gate.name] ?? ["#ffc23d", "#c58bff", "#6fe3ff"][index % 3];

// Outline of a double-ended hull: [across, aft] in metres.
export function hullOutline(length, width, across) {
  const [h, w] = [length / 2, width / 2];
  return [[0, -h], [w * 0.75, -h * 0.86], [w, -h * 0.5], [w, h * 0.5], [w * 0.75, h * 0.86], [0, h],
    [-w * 0.75, h * 0.86], [-w, h * 0.5], [-w, -h * 0.5], [-w * 0.75, -h * 0.86]].map(([x, y]) => [x + across, y]);
}

// The wake from the boat back, in bands of one paleness: a strip of foam behind each hull, as [north, east] around
// it. Few large pieces, since drawing them takes longest where no graphics card helps.
export function wakeBands(trail, boat) {
  const bands = [];
  for (let newest = trail.length - 1, oldest; newest > 0; newest = oldest) {
    const age = Math.max(0, boat.time - trail[newest].time);
    if (age > WAKE_SECONDS) break;
    for (oldest = newest - 1; oldest > 0 && boat.time - trail[oldest].time < age + BAND_SECONDS;) oldest--;
    const part = trail.slice(oldest, newest + 1);
    const strip = (side) => [...part.map((p) => foam(p, boat, side, -1)), ...part.map((p) => foam(p, boat, side, 1)).reverse()];
    const young = Math.max(0, 1 - (age + BAND_SECONDS / 2) / WAKE_SECONDS);
    bands.push({ strength: young * Math.min(1, part[0].speed), strips: [strip(-1), strip(1)] });
  }
  return bands;
}

// A point of the wake: of the port (-1) or starboard (1) hull's foam, its inner (-1) or outer (1) edge, carried
// along by the current since the boat was there.
function foam(p, boat, side, edge) {
  const age = Math.max(0, boat.time - p.time);
  const across = side * (0.38 + 0.13 * age + edge * (0.08 + 0.03 * age));
  return [p.north + boat.current[0] * age - across * Math.sin(p.heading), p.east + boat.current[1] * age + across * Math.cos(p.heading)];
}
