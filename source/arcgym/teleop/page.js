// Copyright (c) 2026, The ARCGym Developers.
// SPDX-License-Identifier: BSD-3-Clause
// Tells the server which keys and sticks are held, ten times a second and at every change. Keys that steer are kept from
// the 3D view; keys typed into a field are left alone.
(() => {
  const steering = new Set("KeyW KeyS KeyA KeyD KeyR KeyF KeyI KeyK KeyJ KeyL KeyQ KeyE KeyG KeyB ShiftLeft ShiftRight".split(" "));
  const once = new Set("Space Period KeyM KeyU".split(" "));
  const held = new Set();
  const sent = new Map();
  let pressed = [], socket = null, number = 0, latency = null, before = "";

  const typing = (event) => {
    const field = event.target.closest ? event.target.closest("input, textarea, select, [contenteditable]") : null;
    return field && field.type !== "range" && field.type !== "checkbox";
  };
  const pads = () => {
    const found = navigator.getGamepads ? [...navigator.getGamepads()].find((pad) => pad && pad.connected) : null;
    if (!found) return null;
    return {axes: found.axes.map((x) => +x.toFixed(3)), buttons: found.buttons.map((b) => +b.value.toFixed(3))};
  };
  const send = (always) => {
    if (!socket || socket.readyState !== WebSocket.OPEN) return;
    const pad = pads();
    const now = JSON.stringify([[...held], pressed, pad]);
    if (!always && now === before) return;
    before = now;
    sent.set(++number, performance.now());
    if (sent.size > 50) sent.clear();
    socket.send(JSON.stringify({n: number, keys: [...held], pressed, pad, latency}));
    pressed = [];
  };
  const connect = () => {
    socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/hand`);
    socket.onmessage = (event) => {
      const answer = JSON.parse(event.data);
      if (sent.has(answer.n)) latency = (performance.now() - sent.get(answer.n)) / 1000;
      sent.delete(answer.n);
      window.arcgym = {...answer, latency, connected: true};
    };
    socket.onclose = () => {
      window.arcgym = {...(window.arcgym || {}), connected: false};
      setTimeout(connect, 500);
    };
  };
  const let_go = () => { held.clear(); send(true); };

  window.addEventListener("keydown", (event) => {
    if (typing(event) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!steering.has(event.code) && !once.has(event.code)) return;
    event.stopImmediatePropagation();
    event.preventDefault();
    if (event.repeat) return;
    if (once.has(event.code)) pressed.push(event.code); else held.add(event.code);
    send(true);
  }, true);
  window.addEventListener("keyup", (event) => {
    if (held.delete(event.code)) { event.stopImmediatePropagation(); send(true); }
  }, true);
  window.addEventListener("blur", let_go);
  document.addEventListener("visibilitychange", () => { if (document.hidden) let_go(); });
  setInterval(() => send(true), 100);
  setInterval(() => { if (pads()) send(false); }, 33);
  const style = document.createElement("style");
  style.textContent = "img { width: 100%; max-width: 100%; height: auto; }";
  document.documentElement.appendChild(style);
  connect();
})();
