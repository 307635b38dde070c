// The course from above, north up: a camera that keeps the boat and its next gate in sight.

import { gateColour, hullOutline, wakeBands } from "./scene.js";

const MARGIN = 4.5; // m around what must be seen
const CLOSEST = 58; // px per m
const STREAKS = 30;
const sea = document.createElement("canvas"); // a tile of it

export class Chart {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.camera = null;
    this.streaks = Array.from({ length: STREAKS }, () => ({ x: Math.random(), y: Math.random(), age: Math.random() }));
    drawSea();
  }

  // free: the part of the canvas that no panel covers, {left, top, right, bottom} in CSS pixels.
  draw(scene, boat, trail, free, elapsed) {
    const { context: c, canvas } = this;
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      this.camera = null;
    }
    this.aim(scene, boat, trail, free, elapsed);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.water(boat, width, height, elapsed);
    this.shore(scene);
    this.bounds(scene);
    this.current(boat, width, height);
    this.wake(boat, trail);
    scene.course.gates.forEach((gate, index) => this.gate(scene, gate, index, boat));
    this.boat(scene, boat);
    this.wind(boat, width, height, elapsed);
  }

  aim(scene, boat, trail, free, elapsed) {
    const { gates, bounds } = scene.course;
    const over = boat.phase === "ended" || boat.phase === "saving";
    const points = [[boat.north, boat.east]];
    if (over || boat.phase === "ready") gates.forEach((gate) => points.push(...gate.buoys));
    else points.push(...gates[Math.min(boat.passed, gates.length - 1)].buoys);
    if (boat.phase === "ready") points.push([bounds.south + 2.5, boat.east]);
    if (over) points.push(...trail.map((p) => [p.north, p.east]));
    const ends = (place) => [Math.min(...points.map((p) => p[place])) - MARGIN, Math.max(...points.map((p) => p[place])) + MARGIN];
    const [south, north] = ends(0);
    const [west, east] = ends(1);
    const [w, h] = [free.right - free.left, free.bottom - free.top];
    const scale = Math.min(w / (east - west), h / (north - south), CLOSEST);
    const goal = { north: (north + south) / 2, east: (east + west) / 2, scale, x: (free.left + free.right) / 2, y: (free.top + free.bottom) / 2 };
    // At once where the run ended: the choices appear over the last gate.
    const blend = this.camera ? 1 - Math.exp(-elapsed / (over ? 0.1 : 0.7)) : 1;
    this.camera ??= { ...goal };
    for (const key of Object.keys(goal)) this.camera[key] += blend * (goal[key] - this.camera[key]);
  }

  place(north, east) {
    const { camera } = this;
    return [camera.x + (east - camera.east) * camera.scale, camera.y - (north - camera.north) * camera.scale];
  }

  water(boat, width, height, elapsed) {
    const c = this.context;
    this.drift = this.drift ?? [0, 0];
    this.drift[0] += elapsed * (boat.current[0] - 0.04 * boat.wind[0]);
    this.drift[1] += elapsed * (boat.current[1] - 0.04 * boat.wind[1]);
    // Whole pixels, no scaling, nothing to see through: copying such a tile is cheap even without a graphics card.
    const size = sea.width;
    const [x, y] = this.place(this.drift[0], this.drift[1]).map((at) => Math.round(wrap(at, size)) - size);
    for (let left = x; left < width; left += size) {
      for (let top = y; top < height; top += size) c.drawImage(sea, left, top);
    }
  }

  // The pier lies beyond the southern edge, where no boat gets.
  shore(scene) {
    const c = this.context;
    const { south, west, east } = scene.course.bounds;
    const s = this.camera.scale;
    const box = (north, left, down, right) => {
      const [x, y] = this.place(north, left);
      return [x, y, (right - left) * s, (north - down) * s];
    };
    c.fillStyle = "#c9b48a";
    c.fillRect(...box(south - 6.2, west - 60, south - 60, east + 60));
    c.fillStyle = "rgba(255,255,255,.35)";
    c.fillRect(...box(south - 5.9, west - 60, south - 6.2, east + 60));
    const middle = 0;
    c.fillStyle = "rgba(0,25,35,.35)";
    c.fillRect(...box(south - 0.9, middle - 4.4, south - 7, middle + 5));
    c.fillStyle = "#8d8577";
    c.fillRect(...box(south - 0.6, middle - 4.8, south - 7, middle + 4.6));
    c.fillStyle = "#a79f90";
    c.fillRect(...box(south - 0.9, middle - 4.5, south - 7, middle + 4.3));
    c.strokeStyle = "rgba(60,52,40,.35)";
    c.lineWidth = 1;
    for (let plank = -4.5; plank < 4.3; plank += 0.55) {
      const [x, y, , h] = box(south - 0.9, middle + plank, south - 7, middle + plank);
      c.beginPath(); c.moveTo(x, y); c.lineTo(x, y + h); c.stroke();
    }
    for (const bollard of [-4.1, 3.9]) this.disc(south - 1.3, middle + bollard, 0.24, "#3c3a36");
    const [x, y, w, h] = box(south - 2.1, middle - 1.7, south - 5.3, middle + 1.7);
    c.fillStyle = "#f6f3ea"; c.fillRect(x, y, w, h);
    c.fillStyle = "#e2dccb";
    c.beginPath(); c.moveTo(x, y); c.lineTo(x + w / 2, y + h / 2); c.lineTo(x + w, y); c.fill();
    c.beginPath(); c.moveTo(x, y + h); c.lineTo(x + w / 2, y + h / 2); c.lineTo(x + w, y + h); c.fill();
    for (const [north, across, colour] of [[1.5, -2.6, "#e2574c"], [1.4, 2.4, "#f2c14e"], [1.8, 3.1, "#4d8fd9"], [1.7, -3.4, "#5bbf7b"]]) {
      this.disc(south - north, middle + across, 0.22, colour);
    }
  }

  bounds(scene) {
    const c = this.context;
    const { south, north, west, east } = scene.course.bounds;
    const [x, y] = this.place(north, west);
    c.setLineDash([10, 12]);
    c.lineWidth = 2;
    c.strokeStyle = "rgba(255,255,255,.35)";
    c.strokeRect(x, y, (east - west) * this.camera.scale, (north - south) * this.camera.scale);
    c.setLineDash([]);
  }

  current(boat, width, height) {
    const c = this.context;
    const speed = Math.hypot(...boat.current);
    if (speed < 0.01) return;
    const grid = 105 / this.camera.scale;
    const { camera } = this;
    const heading = Math.atan2(boat.current[1], boat.current[0]);
    const length = Math.max((0.5 + 4 * speed) * camera.scale * 0.6, 12);
    c.strokeStyle = "rgba(150,225,255,.42)";
    c.lineWidth = 2.5;
    c.beginPath();
    const reach = [height / camera.scale, width / camera.scale];
    const first = [Math.floor((camera.north - reach[0]) / grid), Math.floor((camera.east - reach[1]) / grid)];
    const shift = [wrap(this.drift[0], grid), wrap(this.drift[1], grid)];
    for (let i = first[0]; i <= first[0] + (2 * reach[0]) / grid; i++) {
      for (let j = first[1]; j <= first[1] + (2 * reach[1]) / grid; j++) {
        const [x, y] = this.place((i + (j % 2) / 2) * grid + shift[0], j * grid + shift[1]);
        if (x > -40 && y > -40 && x < width + 40 && y < height + 40) addArrow(c, x, y, heading, length, 6);
      }
    }
    c.stroke();
  }

  // Streaks that run with the wind.
  wind(boat, width, height, elapsed) {
    const speed = Math.hypot(...boat.wind);
    if (speed < 0.2) return;
    const c = this.context;
    const step = [-boat.wind[1] * 22 * elapsed, boat.wind[0] * 22 * elapsed];
    c.lineWidth = 1.5;
    for (const streak of this.streaks) {
      streak.age += elapsed / 1.6;
      if (streak.age > 1) Object.assign(streak, { x: Math.random(), y: Math.random(), age: 0 });
      streak.x += step[0] / width;
      streak.y += step[1] / height;
      const [x, y] = [streak.x * width, streak.y * height];
      c.strokeStyle = `rgba(255,255,255,${0.4 * Math.sin(Math.PI * streak.age)})`;
      c.beginPath(); c.moveTo(x, y); c.lineTo(x + boat.wind[1] * 9, y - boat.wind[0] * 9); c.stroke();
    }
  }

  wake(boat, trail) {
    const c = this.context;
    if (trail.length < 2) return;
    c.lineCap = "round";
    c.setLineDash([2, 7]);
    c.strokeStyle = "rgba(255,255,255,.75)";
    c.lineWidth = 2;
    c.beginPath();
    trail.forEach((p, index) => { const [x, y] = this.place(p.north, p.east); if (index) c.lineTo(x, y); else c.moveTo(x, y); });
    c.stroke();
    c.setLineDash([]);
    c.lineCap = "butt";
    for (const { strength, strips } of wakeBands(trail, boat)) {
      c.fillStyle = `rgba(235,250,255,${0.55 * strength})`;
      c.beginPath();
      for (const strip of strips) strip.forEach((p, index) => { const [x, y] = this.place(...p); if (index) c.lineTo(x, y); else c.moveTo(x, y); });
      c.fill();
    }
  }

  gate(scene, gate, index, boat) {
    const c = this.context;
    const s = this.camera.scale;
    const colour = gateColour(gate, index);
    const passed = boat.passed > index;
    const [a, b] = gate.buoys.map((buoy) => this.place(...buoy));
    c.globalAlpha = passed ? 0.55 : 1;
    c.strokeStyle = colour;
    c.lineWidth = boat.passed === index ? 4 : 2;
    c.setLineDash([6, 8]);
    c.beginPath(); c.moveTo(...a); c.lineTo(...b); c.stroke();
    c.setLineDash([]);
    if (boat.passed === index) {
      const [x, y] = this.place(gate.centre[0] - 0.9 * Math.cos(gate.heading), gate.centre[1] - 0.9 * Math.sin(gate.heading));
      c.strokeStyle = colour;
      c.lineWidth = Math.min(5, 0.25 * s);
      arrow(c, x, y, gate.heading, 1.9 * s, Math.min(13, 0.6 * s));
    }
    for (const buoy of gate.buoys) {
      this.disc(buoy[0] - 0.12, buoy[1] + 0.16, scene.course.buoy_radius * 1.5, "rgba(0,25,35,.35)");
      this.disc(...buoy, Math.max(scene.course.buoy_radius * 1.35, 7 / s), "#ffffff");
      this.disc(...buoy, Math.max(scene.course.buoy_radius, 5.4 / s), colour);
      this.disc(buoy[0] + 0.06, buoy[1] - 0.06, scene.course.buoy_radius * 0.3, "rgba(255,255,255,.75)");
    }
    c.globalAlpha = 1;
    c.font = "700 20px system-ui, sans-serif";
    c.textBaseline = "middle";
    c.lineWidth = 4;
    c.strokeStyle = "rgba(3,40,56,.75)";
    c.fillStyle = passed ? "#ffffff" : colour;
    const label = passed ? `${gate.name} ✓` : gate.name;
    const [x, y] = [Math.max(a[0], b[0]) + 16, (a[1] + b[1]) / 2];
    c.strokeText(label, x, y);
    c.fillText(label, x, y);
  }

  boat(scene, boat) {
    const c = this.context;
    const waiting = boat.phase === "ready";
    // From far above, the boat is drawn large enough to be found.
    const s = Math.max(this.camera.scale, 26);
    const { length, breadth, thrusters } = scene.boat;
    if (waiting) this.ring(boat);
    c.save();
    c.translate(...this.place(boat.north, boat.east));
    c.rotate(boat.heading);
    c.scale(s, s); // now x to starboard and y aft, in metres
    c.fillStyle = "rgba(0,25,35,.3)";
    c.beginPath(); c.ellipse(0.08, 0.1, breadth * 0.56, length * 0.56, 0, 0, 7); c.fill();
    thrusters.forEach((thruster, k) => this.jet(c, thruster, boat.azimuth[k], boat.throttle[k] / thruster.full));
    c.fillStyle = "#f7f7f2";
    c.strokeStyle = "#2b3b44";
    c.lineWidth = 0.025;
    for (const side of [-1, 1]) {
      const hull = hullOutline(length, 0.24, side * (breadth / 2 - 0.12));
      c.beginPath(); hull.forEach(([x, y]) => c.lineTo(x, y)); c.closePath(); c.fill(); c.stroke();
    }
    c.fillStyle = "#ff8a1f";
    c.beginPath(); c.roundRect(-breadth * 0.36, -length * 0.26, breadth * 0.72, length * 0.52, 0.07); c.fill(); c.stroke();
    c.fillStyle = "#27343b";
    c.beginPath(); c.roundRect(-0.13, -0.12, 0.26, 0.28, 0.04); c.fill();
    c.fillStyle = "#ffffff";
    c.beginPath(); c.moveTo(0, -length * 0.24); c.lineTo(0.1, -length * 0.13); c.lineTo(-0.1, -length * 0.13); c.fill();
    thrusters.forEach((thruster, k) => this.thrust(c, thruster, boat.azimuth[k], boat.throttle[k] / thruster.full));
    c.restore();
  }

  ring(boat) {
    const c = this.context;
    const beat = (performance.now() % 1600) / 1600;
    c.strokeStyle = `rgba(255,210,62,${1 - beat})`;
    c.lineWidth = 3;
    c.beginPath(); c.arc(...this.place(boat.north, boat.east), 22 + 26 * beat, 0, 7); c.stroke();
  }

  jet(c, thruster, azimuth, throttle) {
    if (Math.abs(throttle) < 0.02) return;
    c.save();
    c.translate(thruster.y, -thruster.x);
    c.rotate(azimuth + (throttle < 0 ? Math.PI : 0));
    const plume = c.createLinearGradient(0, 0, 0, 1.5 * Math.abs(throttle));
    plume.addColorStop(0, "rgba(255,255,255,.95)");
    plume.addColorStop(1, "rgba(190,240,255,0)");
    c.fillStyle = plume;
    c.beginPath(); c.moveTo(-0.06, 0); c.lineTo(-0.3, 1.5 * Math.abs(throttle)); c.lineTo(0.3, 1.5 * Math.abs(throttle)); c.lineTo(0.06, 0); c.fill();
    c.restore();
  }

  // The force on the boat: its arrow is as long as the thrust is strong.
  thrust(c, thruster, azimuth, throttle) {
    const strength = throttle * Math.abs(throttle);
    c.save();
    c.translate(thruster.y, -thruster.x);
    c.fillStyle = "#10222b";
    c.beginPath(); c.arc(0, 0, 0.075, 0, 7); c.fill();
    if (Math.abs(strength) > 0.004) {
      c.rotate(azimuth + (throttle < 0 ? Math.PI : 0));
      const tip = -(0.22 + 0.75 * Math.abs(strength));
      for (const [colour, width] of [["rgba(40,10,0,.65)", 0.13], ["#ffd23e", 0.075]]) {
        c.strokeStyle = colour;
        c.lineWidth = width;
        c.lineJoin = "round";
        c.beginPath(); c.moveTo(0, 0); c.lineTo(0, tip); c.moveTo(-0.11, tip + 0.14); c.lineTo(0, tip); c.lineTo(0.11, tip + 0.14); c.stroke();
      }
    }
    c.restore();
  }

  disc(north, east, radius, colour) {
    const c = this.context;
    c.fillStyle = colour;
    c.beginPath(); c.arc(...this.place(north, east), radius * this.camera.scale, 0, 7); c.fill();
  }
}

export function arrow(c, x, y, heading, length, head) {
  c.beginPath();
  addArrow(c, x, y, heading, length, head);
  c.stroke();
}

function addArrow(c, x, y, heading, length, head) {
  const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
  const at = (across, ahead) => [x + ahead * sin + across * cos, y - ahead * cos + across * sin];
  c.moveTo(x, y); c.lineTo(...at(0, length));
  c.moveTo(...at(-head * 0.6, length - head)); c.lineTo(...at(0, length)); c.lineTo(...at(head * 0.6, length - head));
}

const wrap = (value, length) => ((value % length) + length) % length;

// Faint wavelets, drawn so that the tile's edges meet.
function drawSea() {
  const size = 400;
  sea.width = sea.height = size;
  const c = sea.getContext("2d", { alpha: false });
  c.fillStyle = "#0f7190";
  c.fillRect(0, 0, size, size);
  let seed = 7;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  c.lineCap = "round";
  for (let i = 0; i < 90; i++) {
    const [x, y, w] = [random() * size, random() * size, 10 + 26 * random()];
    c.strokeStyle = i % 3 ? "rgba(255,255,255,.055)" : "rgba(0,30,50,.07)";
    c.lineWidth = 1.5 + 2 * random();
    for (const dx of [0, -size]) for (const dy of [0, -size]) {
      c.beginPath(); c.moveTo(x + dx, y + dy); c.quadraticCurveTo(x + dx + w / 2, y + dy - 7, x + dx + w, y + dy); c.stroke();
    }
  }
}
