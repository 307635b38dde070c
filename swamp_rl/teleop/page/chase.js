// The view from behind and above the boat, in perspective.

import { gateColour, hullOutline, wakeBands } from "./scene.js";

const BEHIND = 3.6, ABOVE = 1.9, AHEAD = 5; // m: where the camera is, and the point it looks at
const NEAR = 0.35;

export class Chase {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.heading = null;
  }

  draw(scene, boat, trail, elapsed) {
    const { canvas, context: c } = this;
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    if (!w || !h) return;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
    }
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.size = [w, h];
    this.look(boat, elapsed);
    this.sky();
    this.sea(boat);
    this.pier(scene);
    this.wake(boat, trail);
    this.things(scene, boat);
  }

  look(boat, elapsed) {
    this.heading ??= boat.heading;
    const off = Math.atan2(Math.sin(boat.heading - this.heading), Math.cos(boat.heading - this.heading));
    this.heading += off * (1 - Math.exp(-elapsed / 0.28));
    const [cos, sin] = [Math.cos(this.heading), Math.sin(this.heading)];
    this.eye = [boat.north - BEHIND * cos, boat.east - BEHIND * sin];
    this.direction = [cos, sin];
    this.focal = 0.95 * Math.max(this.size[1] * 0.95, this.size[0] * 0.62);
    this.pitch = Math.atan2(ABOVE, BEHIND + AHEAD);
    this.horizon = this.size[1] / 2 - this.focal * Math.tan(this.pitch);
  }

  // Screen place and depth of a point, height above the water; null if it is behind the camera.
  project(north, east, height = 0) {
    const [dn, de] = [north - this.eye[0], east - this.eye[1]];
    const ahead = dn * this.direction[0] + de * this.direction[1];
    const right = de * this.direction[0] - dn * this.direction[1];
    const up = height - ABOVE;
    const [cos, sin] = [Math.cos(this.pitch), Math.sin(this.pitch)];
    const depth = ahead * cos - up * sin;
    if (depth < NEAR) return null;
    const rise = up * cos + ahead * sin;
    return { x: this.size[0] / 2 + (this.focal * right) / depth, y: this.size[1] / 2 - (this.focal * rise) / depth, scale: this.focal / depth, depth };
  }

  polygon(points, colour, edge) {
    const places = points.map((p) => this.project(...p));
    if (places.some((place) => !place)) return;
    const c = this.context;
    c.fillStyle = colour;
    c.beginPath();
    places.forEach(({ x, y }) => c.lineTo(x, y));
    c.closePath();
    c.fill();
    if (edge) { c.strokeStyle = edge; c.lineWidth = 1; c.stroke(); }
  }

  sky() {
    const { context: c, size: [w], horizon } = this;
    const sky = c.createLinearGradient(0, Math.min(0, horizon - 200), 0, horizon);
    sky.addColorStop(0, "#4fb3e8");
    sky.addColorStop(1, "#d9f1fb");
    c.fillStyle = sky;
    c.fillRect(0, 0, w, Math.max(horizon, 0) + 1);
    // Hills all round, as a sum of waves of the bearing.
    for (const [base, colour, phase] of [[0.075, "#a9c6d3", 0], [0.05, "#7fa48f", 2]]) {
      c.fillStyle = colour;
      c.beginPath();
      c.moveTo(0, horizon + 1);
      for (let x = 0; x <= w; x += 6) {
        const bearing = this.heading + Math.atan2(x - w / 2, this.focal);
        const height = base * (1 + 0.5 * Math.sin(3 * bearing + phase) + 0.3 * Math.sin(7 * bearing + 1.3 * phase) + 0.16 * Math.sin(17 * bearing));
        c.lineTo(x, horizon - height * this.focal * 0.55);
      }
      c.lineTo(w, horizon + 1);
      c.fill();
    }
  }

  sea(boat) {
    const { context: c, size: [w, h], horizon } = this;
    const top = Math.max(horizon, 0);
    const sea = c.createLinearGradient(0, top, 0, h);
    sea.addColorStop(0, "#7fc4d6");
    sea.addColorStop(0.18, "#2b93b1");
    sea.addColorStop(1, "#0c5f7f");
    c.fillStyle = sea;
    c.fillRect(0, top, w, h - top);
    // Wavelets that stand on the water, so that speed and turning can be seen.
    const grid = 1.6;
    const [n, e] = [Math.round(this.eye[0] / grid), Math.round(this.eye[1] / grid)];
    for (let i = n - 16; i <= n + 16; i++) {
      for (let j = e - 16; j <= e + 16; j++) {
        const jitter = Math.abs(Math.sin(i * 127.1 + j * 311.7) * 43758.5) % 1;
        const p = this.project((i + 0.8 * jitter) * grid + boat.current[0] * (boat.time % 60), (j + 0.6 * jitter) * grid + boat.current[1] * (boat.time % 60));
        if (!p || p.depth > 24 || p.x < -30 || p.x > w + 30 || p.y > h + 10) continue;
        c.fillStyle = `rgba(255,255,255,${0.26 * (1 - p.depth / 24) * (0.35 + 0.65 * jitter)})`;
        c.fillRect(p.x - 0.14 * p.scale, p.y, 0.28 * p.scale, Math.max(1, 0.035 * p.scale));
      }
    }
  }

  pier(scene) {
    const { south } = scene.course.bounds;
    const [front, back, left, right] = [south - 0.6, south - 7, -4.8, 4.6];
    this.polygon([[front, left, 0], [front, right, 0], [front, right, 0.9], [front, left, 0.9]], "#7d7567");
    this.polygon([[front, left, 0.9], [front, right, 0.9], [back, right, 0.9], [back, left, 0.9]], "#aaa292");
    this.polygon([[front - 1.6, -1.6, 3], [front - 1.6, 1.6, 3], [front - 3, 0, 4]], "#f6f3ea", "#c9c2b0");
  }

  wake(boat, trail) {
    const c = this.context;
    for (const { strength, strips } of wakeBands(trail, boat)) {
      c.fillStyle = `rgba(240,252,255,${0.42 * strength})`;
      for (const strip of strips) {
        const places = strip.map((p) => this.project(...p)).filter(Boolean); // the rest is behind the camera
        c.beginPath();
        places.forEach(({ x, y }) => c.lineTo(x, y));
        c.fill();
      }
    }
  }

  things(scene, boat) {
    const drawn = [];
    scene.course.gates.forEach((gate, index) => {
      const colour = gateColour(gate, index);
      for (const [north, east] of gate.buoys) {
        const p = this.project(north, east, scene.course.buoy_radius);
        if (p) drawn.push([p.depth, () => this.buoy(p, scene.course.buoy_radius, colour, boat.passed > index)]);
      }
      if (boat.passed === index) {
        const p = this.project(gate.centre[0], gate.centre[1], 1.5);
        if (p) drawn.push([p.depth, () => this.sign(p, colour)]);
      }
    });
    const p = this.project(boat.north, boat.east);
    if (p) drawn.push([p.depth, () => this.boat(scene, boat)]);
    drawn.sort((a, b) => b[0] - a[0]).forEach(([, draw]) => draw());
  }

  buoy(p, radius, colour, passed) {
    const c = this.context;
    const r = Math.max(radius * 1.6 * p.scale, 3);
    c.globalAlpha = passed ? 0.6 : 1;
    c.fillStyle = "rgba(0,30,45,.35)";
    c.beginPath(); c.ellipse(p.x, p.y + r * 0.75, r * 1.25, r * 0.35, 0, 0, 7); c.fill();
    const ball = c.createRadialGradient(p.x - r * 0.35, p.y - r * 0.4, r * 0.1, p.x, p.y, r);
    ball.addColorStop(0, "#fff");
    ball.addColorStop(0.35, colour);
    ball.addColorStop(1, "#1d2b2b");
    c.fillStyle = ball;
    c.beginPath(); c.arc(p.x, p.y, r, 0, 7); c.fill();
    c.globalAlpha = 1;
  }

  // Over the gate that is next.
  sign(p, colour) {
    const c = this.context;
    const s = Math.max(10, Math.min(0.55 * p.scale, 34));
    c.fillStyle = colour;
    c.strokeStyle = "rgba(0,30,45,.6)";
    c.lineWidth = 2;
    c.beginPath(); c.moveTo(p.x - s, p.y - s); c.lineTo(p.x + s, p.y - s); c.lineTo(p.x, p.y + s * 0.7); c.closePath(); c.stroke(); c.fill();
  }

  boat(scene, boat) {
    const { length, breadth, thrusters } = scene.boat;
    const [cos, sin] = [Math.cos(boat.heading), Math.sin(boat.heading)];
    const at = (right, aft, up) => [boat.north - aft * cos - right * sin, boat.east - aft * sin + right * cos, up];
    thrusters.forEach((thruster, k) => {
      const throttle = boat.throttle[k] / thruster.full;
      if (Math.abs(throttle) < 0.02) return;
      const back = boat.azimuth[k] + Math.PI;
      const end = (spread) => at(thruster.y + 1.3 * throttle * Math.sin(back + spread), -thruster.x - 1.3 * throttle * Math.cos(back + spread), 0);
      this.polygon([at(thruster.y, -thruster.x, 0), end(-0.22), end(0.22)], `rgba(255,255,255,${0.55 * Math.abs(throttle)})`);
    });
    const box = (outline, low, high, side, top) => {
      const centre = (i) => { const [a, b] = [outline[i], outline[(i + 1) % outline.length]]; return this.project(...at((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, low))?.depth ?? 0; };
      outline.map((_, i) => i).sort((a, b) => centre(b) - centre(a)).forEach((i) => {
        const [a, b] = [outline[i], outline[(i + 1) % outline.length]];
        this.polygon([at(...a, low), at(...b, low), at(...b, high), at(...a, high)], side, "rgba(20,35,45,.25)");
      });
      this.polygon(outline.map((p) => at(...p, high)), top, "rgba(20,35,45,.4)");
    };
    const sides = [-1, 1].sort((a, b) => this.project(...at(b, 0, 0)).depth - this.project(...at(a, 0, 0)).depth);
    for (const side of sides) box(hullOutline(length, 0.24, side * (breadth / 2 - 0.12)), 0, 0.24, "#dfe3e0", "#fbfbf7");
    const plate = (w, l, y) => [[-w, y - l], [w, y - l], [w, y + l], [-w, y + l]];
    box(plate(breadth * 0.36, length * 0.26, 0), 0.24, 0.36, "#d96c0c", "#ff9433");
    box(plate(0.13, 0.14, 0.03), 0.36, 0.52, "#1d282e", "#34444d");
    const mast = [this.project(...at(0, 0.03, 0.5)), this.project(...at(0, 0.03, 0.95))];
    if (mast[0] && mast[1]) {
      const c = this.context;
      c.strokeStyle = "#e9eef0"; c.lineWidth = 2;
      c.beginPath(); c.moveTo(mast[0].x, mast[0].y); c.lineTo(mast[1].x, mast[1].y); c.stroke();
      c.fillStyle = "#ffd23e"; c.beginPath(); c.arc(mast[1].x, mast[1].y, 3.5, 0, 7); c.fill();
    }
    this.forces(boat, thrusters, at);
  }

  forces(boat, thrusters, at) {
    const c = this.context;
    thrusters.forEach((thruster, k) => {
      const throttle = boat.throttle[k] / thruster.full;
      if (Math.abs(throttle) < 0.05) return;
      const reach = 0.2 + 0.75 * throttle * Math.abs(throttle);
      const tip = at(thruster.y + reach * Math.sin(boat.azimuth[k]), -thruster.x - reach * Math.cos(boat.azimuth[k]), 0.3);
      const [a, b] = [this.project(...at(thruster.y, -thruster.x, 0.3)), this.project(...tip)];
      if (!a || !b) return;
      for (const [colour, width] of [["rgba(40,10,0,.6)", 6], ["#ffd23e", 3.5]]) {
        c.strokeStyle = colour; c.lineWidth = width; c.lineCap = "round";
        c.beginPath(); c.moveTo(a.x, a.y); c.lineTo(b.x, b.y); c.stroke();
      }
    });
    c.lineCap = "butt";
  }
}
