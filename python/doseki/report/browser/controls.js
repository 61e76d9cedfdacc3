// Mouse, touch and keys: one finger or button turns (a flat scene: moves), two fingers move and zoom.

function attachControls(canvas, camera, changed, keys) {
  const down = new Map(); // place of each pointer that is pressed
  const spread = () => {
    const [a, b] = [...down.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) || 1 };
  };
  const moved = (action) => {
    action();
    changed(true);
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = down.get(event.pointerId);
    if (!last) return;
    const before = down.size === 2 ? spread() : last;
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const now = down.size === 2 ? spread() : down.get(event.pointerId);
    const [right, up] = [now.x - before.x, before.y - now.y].map((d) => d / canvas.clientHeight);
    if (down.size > 2) return;
    if (down.size === 2) {
      moved(() => {
        camera.pan(right, up);
        camera.zoom(before.apart / now.apart);
      });
    } else if (camera.flat || event.shiftKey || event.buttons > 1) moved(() => camera.pan(right, up));
    else moved(() => camera.orbit(200 * right, -200 * up));
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => {
      down.delete(event.pointerId);
      changed(false);
    });
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", () => moved(() => camera.reset()));
  // The page scrolls until the picture has been clicked.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    moved(() => camera.zoom(Math.exp(clamp(event.deltaY, -120, 120) / 400)));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] }[event.key];
    const factor = { "+": 0.8, "=": 0.8, "-": 1.25 }[event.key];
    if (turns && camera.flat) moved(() => camera.pan(-turns[0] / 100, -turns[1] / 100));
    else if (turns) moved(() => camera.orbit(...turns));
    else if (factor) moved(() => camera.zoom(factor));
    else if (keys[event.key]) keys[event.key]();
    else return;
    event.preventDefault();
  });
}
