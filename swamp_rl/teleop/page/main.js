// The page shows and commands; the boat lives on the server.

import { Chart } from "./chart.js";
import { Chase } from "./chase.js";
import { showDials, showLevers, showWeather } from "./dials.js";
import { forget, listen, padActs, read } from "./input.js";
import { Replay } from "./replay.js";

const HEARTBEAT = 50; // ms between commands, though nothing moves: the dead-man waits for 250
const GAP = 14; // px between what is drawn and the panels
const LEAST = 60; // px of width and height below which the chart lies behind the panels
const SILENT = 3000; // ms without a frame, of which there are fifty a second
const CALM = [0, 0]; // m/s, drawn where wind and current are unknown
const CHOICES = ["boat", "level", "pilot"]; // of names, before a run
const by = (id) => document.getElementById(id);
const chart = new Chart(by("chart"));
const chase = new Chase(by("chase"));
const replay = new Replay();
const latencies = [];
let socket, scene, frame, status = {}, trail = [], arrived = 0, asked = null, sentAt = 0, last = performance.now(), reconnect = 300;
let waited = 0, odd = false;
window.swamp = { get frame() { return frame; }, get status() { return status; }, latencies, received: 0, place: (north, east) => chart.camera && chart.place(north, east) }; // for tests; no place before the first drawing

function connect() {
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
  socket.onopen = () => { reconnect = 300; };
  socket.onmessage = ({ data }) => hear(JSON.parse(data));
  socket.onclose = () => {
    document.body.dataset.connected = "no";
    setTimeout(connect, reconnect);
    reconnect = Math.min(4000, reconnect * 2);
  };
}

const send = (message) => { if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message)); };
const act = (name) => send({ type: "act", act: name });

function hear(message) {
  if (message.type === "frame") {
    frame = message;
    window.swamp.received++;
    arrived = performance.now();
    const { phase } = frame;
    if (document.body.dataset.phase !== phase) enter(phase);
    document.body.dataset.helm = frame.helm;
    if (moving()) leave();
    if (asked && !asked.heard && matches(frame)) asked.heard = arrived;
  } else if (message.type === "scene") {
    scene = message;
    document.body.dataset.connected = "yes";
    fill(by("boat"), scene.boats);
    fill(by("level"), scene.levels);
    fill(by("pilot"), scene.pilots);
    by("pilot-label").hidden = by("helm").hidden = !scene.pilots.length;
    by("kick-port").hidden = by("kick-starboard").hidden = !scene.boat.stern.length;
    by("course-name").textContent = scene.simulated ? scene.course.name : `${scene.course.name}, vehicle at a link`;
    replay.close();
    const kept = localStorage.getItem("nickname");
    if (kept) by("nickname").value = kept;
  } else if (message.type === "status") stand(message);
  else if (message.type === "accepted") say("Kept. Thank you!", true);
  else if (message.type === "say") say(message.text);
}

function leave() {
  const [north, east, heading] = frame.pose;
  const then = trail.at(-1);
  if (then && frame.time - then.time < 0.09) return;
  trail.push({ time: frame.time, north, east, heading, speed: Math.hypot(frame.velocity[0], frame.velocity[1]) });
}

function enter(phase) {
  if (phase === "ready") { trail = []; forget(); }
  document.body.dataset.phase = phase;
  by("accept").disabled = phase !== "ended";
  for (const id of CHOICES) by(id).disabled = phase !== "ready";
}

function stand(message) {
  const before = status;
  status = message;
  document.body.classList.toggle("watching", !status.driving);
  if (status.driving && !before.driving) send({ type: "choose", nickname: by("nickname").value });
  by("seat").textContent = status.driving ? "Leave" : status.seat_taken ? "Taken" : "Drive";
  by("seat").disabled = !status.driving && status.seat_taken;
  if (status.driving) sessionStorage.setItem("driver", "yes");
  else if (!status.seat_taken && before.driving === undefined && sessionStorage.getItem("driver")) act("seat");
  by("counter").textContent = `${status.count} run${status.count === 1 ? "" : "s"}`;
  by("boat").value = status.boat;
  if (scene) document.title = `${status.boat}, ${scene.course.name}`;
  by("level").value = status.level;
  if (status.pilot) by("pilot").value = status.pilot;
  const lines = message.watch.map((line) => Object.assign(document.createElement("li"), { textContent: line, className: /^\d/.test(line) ? "news" : "" }));
  document.querySelector("#watch ol").replaceChildren(...lines);
  by("watch").hidden = !lines.length;
  document.body.style.setProperty("--watch", `${by("watch").offsetHeight}px`); // a phone's banner stands below it
  const list = document.querySelector("#board ol");
  list.replaceChildren(...status.board.map(place));
  by("board-empty").hidden = status.board.length > 0;
}

function place(row) {
  const item = document.createElement("li");
  item.tabIndex = 0;
  item.dataset.run = row.run;
  const who = row.helm === "pilot" ? "⚙ autopilot" : row.helm === "both" ? `${row.nickname} ⚙` : row.nickname;
  for (const [tag, words] of [["b", who], ["span", row.level], ["i", `${row.seconds.toFixed(1)} s`]]) {
    item.append(Object.assign(document.createElement(tag), { textContent: words }));
  }
  const open = () => { document.body.classList.remove("board-open"); replay.open(row.run); };
  item.addEventListener("click", open);
  item.addEventListener("keydown", (event) => { if (event.code === "Enter") { event.stopPropagation(); open(); } });
  return item;
}

function fill(select, names) {
  select.replaceChildren(...names.map((name) => Object.assign(document.createElement("option"), { value: name, textContent: name.replace(/^.*\//, "") })));
}

let saying;
function say(words, good = false) {
  const box = by("said");
  box.textContent = words;
  box.className = good ? "shown good" : "shown";
  clearTimeout(saying);
  saying = setTimeout(() => { box.className = ""; }, 3000);
}

const ENDS = { link_lost: "Link lost", buoy: "Touched a buoy", aground: "Aground", out_of_bounds: "Out of bounds", timeout: "Time is up", diverged: "Simulation diverged" };
const success = ({ length }) => (length === 1 ? "Through the gate!" : length === 2 ? "Both gates!" : "All gates!");
function headline() {
  if (document.body.dataset.connected !== "yes" || !frame) return ["Connecting …", ""];
  if (performance.now() - arrived > SILENT) return ["The recorder does not answer", "Kept runs are safe. Its terminal says more."];
  if (document.body.dataset.replay) return ["", ""];
  if (frame.trouble) return ["The levers are off", frame.trouble];
  if (!status.driving) return ["Watching", status.seat_taken ? "Someone is at the levers." : "The seat is free: press Drive."];
  const { gates } = scene.course;
  const next = gates[Math.min(frame.passed, gates.length - 1)].name;
  switch (frame.phase) {
    case "ready": return ["Ready", `Push the throttle: through ${gates.map((gate) => gate.name).join(", then ")}.`];
    case "run":
      if (frame.stopped) return ["Thrusters stopped", "The page lost your hand: click here, or move a lever."];
      if (frame.helm === "pilot") return ["", "The autopilot has the helm."];
      if (frame.passed) return ["", `Recording. Now ${next}.`];
      return ["", `Recording. To the ${next} gate${gates.length > 1 ? ": the clock starts there" : ""}.`];
    case "saving": return ["Saving …", ""];
    default: {
      const home = frame.outcome === "success";
      const end = home ? success(gates) : ENDS[frame.outcome] ?? frame.outcome;
      if (!scene.simulated) return [end, "The levers still drive the vehicle: bring it back, then keep or discard."];
      const from = gates.length > 1 ? "from gate to gate" : "from the first thrust";
      return [end, home ? `${frame.run_time.toFixed(1)} s ${from}` : "A failed run is kept as such; pilots learn from successful ones."];
    }
  }
}

// --- commands ---

const live = () => document.hasFocus() && !document.hidden;
const moving = () => frame?.phase === "run";
const matches = ({ levers }) => Math.abs(levers[0] - asked.throttle) < 1e-3 && Math.abs(levers[1] - asked.angle) < 1e-3;
let sent = "";

function command(since) {
  if (!status.driving || !live()) return;
  const levers = read();
  const text = JSON.stringify(levers);
  const now = performance.now();
  if (text === sent && now - sentAt < HEARTBEAT) return;
  // Timed is only what the boat will obey: not the autopilot's boat, nor one that lies at the start.
  if (text !== sent) asked = moving() && frame.helm === "person" ? { ...levers, since: since ?? now, heard: 0 } : null;
  sent = text;
  sentAt = now;
  send({ type: "command", ...levers });
}

function stop() {
  forget();
  sent = "";
  if (status.driving) send({ type: "command", throttle: 0, angle: 0, live: false });
}

listen(command, (name) => { if (name !== "accept" || frame?.phase === "ended") act(name); });
setInterval(look, HEARTBEAT / 2);
addEventListener("gamepadconnected", ({ gamepad }) => {
  if (gamepad.mapping !== "standard") say("Gamepad of an unknown layout: axis 2 is the throttle, axis 3 steers. If the boat turns by itself, unplug it.");
});
addEventListener("blur", stop);
document.addEventListener("visibilitychange", () => { if (document.hidden) stop(); });
for (const id of ["accept", "retry", "discard", "helm", "seat"]) {
  by(id).addEventListener("click", (event) => { event.currentTarget.blur(); act(id); });
}
by("seat").addEventListener("click", () => sessionStorage.removeItem("driver"));
by("more").addEventListener("click", () => document.body.classList.toggle("board-open"));
by("nickname").addEventListener("change", ({ target }) => {
  localStorage.setItem("nickname", target.value);
  if (status.driving) send({ type: "choose", nickname: target.value });
});
by("nickname").addEventListener("keydown", (event) => { if (event.code === "Enter") event.target.blur(); });
for (const id of CHOICES) by(id).addEventListener("change", ({ target }) => { send({ type: "choose", [id]: target.value }); target.blur(); });

// --- pictures ---

// Where the boat is now: the last frame, carried on for the few milliseconds since it came.
function present() {
  const age = moving() ? Math.min(0.05, (performance.now() - arrived) / 1000) : 0;
  const [north, east, heading] = frame.pose;
  const [u, v, r] = frame.velocity;
  const [cos, sin] = [Math.cos(heading), Math.sin(heading)];
  return {
    phase: frame.phase, time: frame.time, north: north + age * (u * cos - v * sin), east: east + age * (u * sin + v * cos), heading: heading + age * r,
    u, v, azimuth: frame.azimuth, throttle: frame.throttle, levers: frame.levers, wind: frame.wind ?? CALM, current: frame.current ?? CALM, known: Boolean(frame.wind), passed: frame.passed,
    runTime: frame.run_time,
  };
}

// Where the chart is drawn: between the panels, or in the whole window where these leave too little.
function freeArea(phase) {
  const area = betweenPanels(phase);
  const roomy = Math.min(area.right - area.left, area.bottom - area.top) >= LEAST;
  return roomy ? area : { left: 0, right: innerWidth, top: 0, bottom: innerHeight };
}

// The part of the page that no panel covers; at a run's end and in a replay the middle of the footer is empty.
function betweenPanels(phase) {
  const box = (id) => by(id).getBoundingClientRect();
  const narrow = getComputedStyle(document.querySelector("aside")).display === "grid";
  const title = by("banner").firstElementChild.textContent ? box("banner").bottom : 0;
  const bar = replay.run ? box("replay").bottom : 0;
  const bare = phase === "ended" || phase === "saving" || phase === "replay";
  const [throttle, steering] = [box("left-lever"), box("right-lever")];
  const top = Math.max(title, bar, narrow ? box("dials").bottom + 30 : 70) + GAP;
  if (bare && !narrow) return { left: throttle.right, right: steering.left, top, bottom: innerHeight - GAP };
  const middle = bare ? innerHeight : box("middle").top;
  if (narrow) return { left: 0, right: innerWidth, top, bottom: Math.min(middle, steering.top - 2 * GAP) - GAP };
  const right = document.querySelector("aside").getBoundingClientRect().left;
  return { left: throttle.right, right, top, bottom: middle - GAP };
}

// A button may go down and up again between two pictures of a slow screen.
function look() {
  padActs().forEach((name) => act(name));
  command();
}

function draw(now) {
  requestAnimationFrame(draw);
  const elapsed = Math.min(0.1, (now - last) / 1000);
  last = now;
  look();
  const [title, line] = headline();
  const banner = by("banner");
  if (banner.children[0].textContent !== title) banner.children[0].textContent = title;
  if (banner.children[1].textContent !== line) banner.children[1].textContent = line;
  if (!scene || !frame) return;
  const { boat, trail: path } = replay.run ? replay.look(elapsed, scene.course.gates) : { boat: present(), trail };
  chart.draw(scene, boat, path, freeArea(boat.phase), elapsed);
  // Every other picture does without the view from behind, so that without a graphics card too the page keeps time
  // for what it hears and for the hand.
  waited += elapsed;
  odd = !odd;
  if (odd) {
    chase.draw(scene, boat, path, waited);
    waited = 0;
  }
  showDials(boat, boat.runTime);
  showLevers(boat.levers[0], boat.levers[1]);
  showWeather(by("weather"), boat);
  if (asked?.heard && asked.since) measure();
}

// From the event of a key, stick or finger to the picture that shows what came of it.
function measure() {
  const { since, heard } = asked;
  asked.since = 0;
  // The picture is on the screen after this frame's callbacks.
  requestAnimationFrame(() => {
    latencies.push([heard - since, performance.now() - since]);
    if (latencies.length > 200) latencies.shift();
    const sorted = latencies.map(([, shown]) => shown).sort((a, b) => a - b);
    by("latency").textContent = `hand to picture ${Math.round(sorted[Math.floor(sorted.length / 2)])} ms`;
  });
}

connect();
requestAnimationFrame(draw);
