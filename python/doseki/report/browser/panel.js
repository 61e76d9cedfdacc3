// The controls under the picture.

const LAYERS = ["flow", "walls", "bodies", "terrain"];
const VIEWS = { top: [-90, 89], front: [-90, 0], side: [0, 0] }; // azimuth, elevation

function buildPanel(viewer) {
  const { scene, camera, part, place } = viewer, slider = part("time"), select = part("field");
  slider.max = scene.frames.length - 1;
  slider.addEventListener("input", () => viewer.show({ frame: Number(slider.value) }));
  select.replaceChildren(...scene.fields.map((field) => new Option(field.label, field.name)));
  select.addEventListener("change", () => viewer.show({ field: select.value }));
  part("play").addEventListener("click", () => viewer.setPlaying(!viewer.playing));
  part("play").disabled = slider.disabled = scene.frames.length < 2;
  part("home").addEventListener("click", () => {
    camera.reset();
    viewer.draw();
  });
  part("whole").addEventListener("click", () => {
    if (document.fullscreenElement) document.exitFullscreen();
    else place.requestFullscreen?.();
  });
  for (const [key, [azimuth, elevation]] of Object.entries(VIEWS)) {
    part(key).hidden = camera.flat;
    part(key).addEventListener("click", () => viewer.show({ azimuth, elevation }));
  }
  part("layers").replaceChildren(...checkboxes(viewer));
}

// One for each layer, where there are several, and one for walls in front.
function checkboxes(viewer) {
  const { scene, camera } = viewer;
  const bodies = scene.flow === "flow" ? "bodies" : "rigid bodies"; // beside deformable ones
  const labels = { flow: scene.flow, walls: "walls", bodies, terrain: "terrain" };
  const names = LAYERS.filter((name) => scene[name]);
  const boxes = names.map((name) => checkbox(viewer, labels[name], (on) => (viewer.shown[name] = on)));
  if (boxes.length < 2) return [];
  if (camera.flat) return boxes;
  const clear = checkbox(viewer, `clear ${scene.flow}`, (on) => (viewer.clear = on));
  viewer.clearBox = clear.querySelector("input");
  const cut = checkbox(viewer, "cut walls in front", (on) => (viewer.hides = on));
  cut.querySelector("input").checked = viewer.hides;
  return [...boxes, ...(scene.flow ? [clear] : []), ...(scene.walls ? [cut] : [])];
}

function checkbox(viewer, name, set) {
  const label = element("label", name), box = document.createElement("input");
  box.type = "checkbox";
  box.checked = true;
  box.addEventListener("change", () => {
    set(box.checked);
    viewer.draw();
  });
  label.prepend(box);
  return label;
}
