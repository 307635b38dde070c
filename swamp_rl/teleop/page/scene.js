// What both views share.

export const WAKE_SECONDS = 11;
const NAMED = { green: "#37e07f", red: "#ff5a52" };

export const gateColour = (gate, index) => NAMED[gate.name] ?? ["#ffc23d", "#c58bff", "#6fe3ff"][index % 3];

// Outline of a double-ended hull: [across, aft] in metres.
export function hullOutline(length, width, across) {
  const [h, w] = [length / 2, width / 2];
  return [[0, -h], [w * 0.75, -h * 0.86], [w, -h * 0.5], [w, h * 0.5], [w * 0.75, h * 0.86], [0, h],
    [-w * 0.75, h * 0.86], [-w, h * 0.5], [-w, -h * 0.5], [-w * 0.75, -h * 0.86]].map(([x, y]) => [x + across, y]);
}

export const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
