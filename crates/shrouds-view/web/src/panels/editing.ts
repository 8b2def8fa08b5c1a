// The brush, undo, and the sonar scene.

import { button, el, field, press, row, section, slider, toggle } from "../dom.ts";
import type { Lines } from "../frames.ts";
import { latest } from "../latest.ts";
import type { Volume } from "../protocol.ts";
import type { Stage } from "../scene/stage.ts";
import type { Session } from "../session.ts";
import { forOneBody } from "./one-body.ts";

export function editingPanel(session: Session): HTMLElement {
  const { store } = session;
  const on = toggle("Brush", "Drag on the surface to add or remove voxels (B); drag with the right button to turn", () =>
    store.set({ brush: !store.state.brush }),
  );
  on.dataset.look = "brush";
  const adds = toggle("add", "Add voxels (E changes)", () => store.set({ brushAdds: true }));
  const removes = toggle("remove", "Remove voxels (E changes)", () => store.set({ brushAdds: false }));
  const radius = slider("Radius of the brush in voxels", { min: 0, max: 12, step: 0.5 }, (brushRadius) => store.set({ brushRadius }));
  const show = (): void => {
    const { brush, brushAdds, brushRadius } = store.state;
    press(on, brush);
    press(adds, brushAdds);
    press(removes, !brushAdds);
    radius.set(brushRadius);
  };
  store.watch(["brush", "brushAdds", "brushRadius"], show);
  show();
  const all = el(
    "fieldset",
    { "aria-label": "Editing" },
    row(on, el("span", { className: "segmented", role: "group", "aria-label": "What the brush does" }, adds, removes)),
    field("Radius", radius.element, "In voxels; [ and ]"),
    row(
      button("Undo", () => void session.edit("undo"), "Undo (Ctrl+Z)"),
      button("Redo", () => void session.edit("redo"), "Redo (Ctrl+Shift+Z)"),
    ),
  );
  forOneBody(store, all);
  return section("Editing", all);
}

/** Where a target can be, from what a towed array has heard: a slider of time. */
export function sonarPanel(session: Session, stage: Stage): HTMLElement {
  const path = el("input", { type: "text", placeholder: `scene.toml, or ${session.hello.scenes.at(-1)}`, spellcheck: false });
  path.setAttribute("aria-label", "Path of a sonar scene");
  let steps: unknown[] = [];
  let at = 0;
  const go = latest(async () => {
    const answer = await session.attempt(() => session.framed<{ volume: Volume }, Lines>("scene_step", { step: at, into: "a" }));
    if (!answer) return;
    session.took(answer.ok.volume);
    stage.setOther("track", answer.frame);
  });
  const time = slider("Time", { min: 0, max: 1, step: 1 }, (value) => {
    at = value;
    time.set(at, `${at + 1} of ${steps.length}`);
    void go();
  });
  time.element.hidden = true;
  const load = async (): Promise<void> => {
    const { scenes } = session.hello;
    const text = path.value.trim() || scenes.at(-1) || "";
    const source = scenes.includes(text) ? { demo: text } : { path: text };
    const scene = await session.attempt(() => session.request<{ steps: unknown[] }>("scene", source));
    if (!scene) return;
    steps = scene.steps;
    at = steps.length - 1;
    time.input.max = String(at);
    time.element.hidden = false;
    time.set(at, `${at + 1} of ${steps.length}`);
    session.slot = "a";
    void go();
  };
  path.addEventListener("keydown", (event) => event.key === "Enter" && void load());
  const panel = section("Sonar scene", row(el("span", { className: "grow" }, path), button("Load", () => void load())), time.element);
  panel.open = false;
  return panel;
}
