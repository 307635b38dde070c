// Numbers that can be read from three metres, and a rose with wind and current.

import { arrow } from "./chart.js";

const text = (id, value) => { const element = document.getElementById(id); if (element.textContent !== value) element.textContent = value; };

export function showDials(boat, runTime) {
  text("speed", Math.hypot(boat.u, boat.v).toFixed(1));
  text("heading", String(((Math.round((boat.heading * 180) / Math.PI) % 360) + 360) % 360).padStart(3, "0"));
  text("clock", runTime.toFixed(1));
}

export function showLevers(throttle, angle) {
  move("left-lever", 0, throttle);
  move("right-lever", angle / 2, 0);
}

function move(id, across, up) {
  const lever = document.getElementById(id);
  const knob = lever.firstElementChild;
  const [w, h] = [lever.clientWidth - knob.clientWidth - 6, lever.clientHeight - knob.clientHeight - 6];
  knob.style.transform = `translate(${across * w}px, ${-up * h}px)`;
}

export function showWeather(canvas, boat) {
  const shown = [boat.known, ...boat.wind.concat(boat.current).map((value) => value.toFixed(2))].join();
  if (canvas.dataset.shown === shown && canvas.width === Math.round(canvas.clientWidth * Math.min(devicePixelRatio || 1, 2))) return;
  canvas.dataset.shown = shown;
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const [w, h] = [canvas.clientWidth, canvas.clientHeight];
  if (!w) return;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  const c = canvas.getContext("2d");
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, w, h);
  const small = h < 80;
  const r = Math.min(h * 0.46, w * (small ? 0.2 : 0.23));
  const [x, y] = [r + 4, h / 2];
  c.strokeStyle = "rgba(255,255,255,.4)";
  c.lineWidth = 2;
  c.beginPath(); c.arc(x, y, r, 0, 7); c.stroke();
  c.fillStyle = "#fff";
  c.font = `700 ${small ? 12 : 13}px system-ui, sans-serif`;
  c.textAlign = "center";
  c.textBaseline = "middle";
  c.fillText("N", x, y - r + (small ? 8 : 10));
  const wind = Math.hypot(...boat.wind);
  const current = Math.hypot(...boat.current);
  c.lineWidth = small ? 2.5 : 4;
  if (wind > 0.05) pointer(c, x, y, Math.atan2(-boat.wind[1], -boat.wind[0]), r * 0.8, "#ffffff");
  if (current > 0.005) pointer(c, x, y, Math.atan2(boat.current[1], boat.current[0]), r * 0.55, "#6fe3ff");
  c.textAlign = "left";
  const left = x + r + (small ? 6 : 12);
  // Never under 12 px: a word that is too long is drawn narrower.
  const size = Math.max(small ? 12 : 14.2, Math.min(20, h / 4.6, (w - left) / 6));
  const line = (words, value, colour, place) => {
    c.fillStyle = colour;
    c.font = `500 ${size * (small ? 1 : 0.85)}px system-ui, sans-serif`;
    c.fillText(words, left, y + place * size * 1.17 - size * 0.55, w - left);
    c.font = `700 ${size * 1.15}px system-ui, sans-serif`;
    c.fillText(!boat.known ? "unknown" : small ? value : `${value} m/s`, left, y + place * size * 1.17 + size * 0.5, w - left);
  };
  line("wind", wind.toFixed(1), "#ffffff", -1);
  line("current", current.toFixed(2), "#6fe3ff", 1);
}

function pointer(c, x, y, heading, length, colour) {
  c.strokeStyle = colour;
  arrow(c, x - Math.sin(heading) * length, y + Math.cos(heading) * length, heading, 2 * length, length * 0.4);
}
