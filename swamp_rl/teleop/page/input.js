// Gamepads, keys and touch, as one pair of levers and a push at the stern.

const DEAD_ZONE = 0.08;
const STERN_PUSH = 1.0;
const keys = new Set();
const touch = { throttle: 0, angle: 0, kick: 0 };
const presses = []; // buttons of gamepads that went down since the last look
const held = new Map();

export const KEY_ACTS = { Enter: "accept", NumpadEnter: "accept", KeyR: "retry", Delete: "discard", Backspace: "discard", KeyT: "helm" };
const PAD_ACTS = { 0: "accept", 1: "discard", 2: "retry", 3: "helm" };
const DRIVING = new Set(["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE", "ShiftLeft", "ShiftRight"]);

const typing = (event) => event.target instanceof HTMLInputElement && event.target.type !== "range";

export function listen(changed, act) {
  addEventListener("keydown", (event) => {
    if (typing(event) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (DRIVING.has(event.code)) {
      event.preventDefault();
      if (document.activeElement instanceof HTMLSelectElement) document.activeElement.blur();
      if (!keys.has(event.code)) { keys.add(event.code); changed(event.timeStamp); }
    } else if (KEY_ACTS[event.code] && !event.repeat) {
      event.preventDefault();
      act(KEY_ACTS[event.code]);
    }
  });
  addEventListener("keyup", (event) => { if (keys.delete(event.code)) changed(event.timeStamp); });
  lever("left-lever", (x, y) => { touch.throttle = clamp(y, 0, 1); }, () => { touch.throttle = 0; }, changed);
  lever("right-lever", (x) => { touch.angle = clamp(2 * x - 1, -1, 1); }, () => { touch.angle = 0; }, changed);
  lever("kick-port", () => { touch.kick = -1; }, () => { touch.kick = 0; }, changed);
  lever("kick-starboard", () => { touch.kick = 1; }, () => { touch.kick = 0; }, changed);
}

export function forget() {
  keys.clear();
  Object.assign(touch, { throttle: 0, angle: 0, kick: 0 });
}

// A place on the page that a finger holds: from (0, 0) at its lower left to (1, 1).
function lever(id, moved, released, changed) {
  const element = document.getElementById(id);
  const at = (event) => {
    const box = element.getBoundingClientRect();
    const edge = Math.min(box.width, box.height) / 2;
    const part = (value, length) => (length > 2 * edge ? (value - edge) / (length - 2 * edge) : 0.5);
    moved(part(event.clientX - box.left, box.width), part(box.bottom - event.clientY, box.height));
    changed(event.timeStamp);
  };
  element.addEventListener("pointerdown", (event) => { element.setPointerCapture(event.pointerId); at(event); });
  element.addEventListener("pointermove", (event) => { if (element.hasPointerCapture(event.pointerId)) at(event); });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    element.addEventListener(end, (event) => { released(); changed(event.timeStamp); });
  }
}

export function read() {
  const pads = [...navigator.getGamepads()].filter((pad) => pad && pad.connected);
  const [first, second] = pads;
  const on = (...codes) => codes.some((code) => keys.has(code));
  const share = on("ShiftLeft", "ShiftRight") ? 0.5 : 1;
  const key = { throttle: on("ArrowUp", "KeyW") ? share : 0, angle: (on("ArrowRight", "KeyD") - on("ArrowLeft", "KeyA")) * share };
  const pad = first ? { throttle: Math.max(0, -dead(first.axes[1])), angle: dead(first.axes[2]) } : { throttle: 0, angle: 0 };
  const kick = on("KeyE") - on("KeyQ") || touch.kick || (pressed(first, 5) - pressed(first, 4));
  const stern = kick ? { throttle: STERN_PUSH, azimuth: kick } : stick(second);
  return {
    throttle: round(Math.max(key.throttle, pad.throttle, touch.throttle)),
    angle: round([key.angle, pad.angle, touch.angle].reduce((a, b) => (Math.abs(b) > Math.abs(a) ? b : a))),
    stern_throttle: round(stern.throttle),
    stern_azimuth: round(stern.azimuth),
  };
}

// Acts of the gamepads' buttons that went down since the last call.
export function padActs() {
  presses.length = 0;
  for (const pad of navigator.getGamepads()) {
    if (!pad || !pad.connected) continue;
    for (const [button, act] of Object.entries(PAD_ACTS)) {
      const name = `${pad.index}.${button}`;
      const down = pressed(pad, button) > 0;
      if (down && !held.get(name)) presses.push(act);
      held.set(name, down);
    }
  }
  return presses;
}

// The second joypad's right stick: where it points is where the stern is pushed.
function stick(pad) {
  if (!pad) return { throttle: 0, azimuth: 0 };
  const [x, y] = [dead(pad.axes[2]), dead(pad.axes[3])];
  const throttle = Math.min(1, Math.hypot(x, y));
  return { throttle, azimuth: throttle ? Math.atan2(x, -y) / (Math.PI / 2) : 0 };
}

const pressed = (pad, button) => (pad && pad.buttons[button]?.pressed ? 1 : 0);
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const round = (value) => Math.round(value * 1000) / 1000 || 0;
const dead = (value = 0) => (Math.abs(value) < DEAD_ZONE ? 0 : clamp((Math.abs(value) - DEAD_ZONE) / (0.98 - DEAD_ZONE), 0, 1) * Math.sign(value));
