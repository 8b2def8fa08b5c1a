// How it is shown.

import { compact, el, press, select, slider, toggle } from "../dom.ts";
import type { Session } from "../session.ts";
import { forOneBody } from "./one-body.ts";
import { axes, initial, type Axis, type State, type Store } from "../state.ts";

type Flag = { [K in keyof State]: State[K] extends boolean ? K : never }[keyof State];

export function seeingBar(session: Session): HTMLElement[] {
  const { store } = session;
  const flag = (name: Flag, text: string, title: string): HTMLButtonElement => {
    const control = toggle(text, title, () => store.set({ [name]: !store.state[name] }));
    control.dataset.look = name;
    const show = (): void => press(control, store.state[name]);
    store.watch([name], show);
    show();
    return control;
  };
  const fields = session.hello.fields.map(({ name, help }) => ({ value: name, text: name.replaceAll("-", " "), help }));
  const colours = [{ value: "", text: "none" }, ...fields];
  const network = flag("network", "Network", "The slice curves: across x red, y white, z blue (N)");
  const wipe = flag("wipe", "Wipe", "Midpoints on the left, the shroud on the right (W)");
  forOneBody(store, network, wipe);
  const back = flag("clipBack", "⇄", "Cut the other side away");
  return [
    el(
      "span",
      { className: "segmented", role: "group", "aria-label": "What is drawn" },
      flag("smooth", "Smooth", "Smooth shading instead of flat (F)"),
      network,
      flag("points", "Voxels", "Voxel centres near the surface: discs inside, rings outside (V)"),
      wipe,
      flag("parallel", "Parallel", "Parallel rays instead of perspective (O)"),
    ),
    settingSwitch(session),
    beside("Colours", "Numbers of the vertices as colours (D)", bodily(store, "colours", colours)),
    contours(store),
    across(session, "slice", "sliceAt", "Slice", "A slice of the volume (I)"),
    across(session, "clip", "clipAt", "Clip", "Cut away what lies beyond a plane (K)", back),
    wipeAt(store),
  ];
}

function chosen(store: Store, name: "colours" | "contours" | "slice" | "clip", options: { value: string; text?: string }[]): HTMLSelectElement {
  const control = select(options, (value) => store.set({ [name]: value }));
  control.dataset.look = name;
  const show = (): void => void (control.value = store.state[name]);
  store.watch([name], show);
  show();
  return control;
}

const acrossAxes = [{ value: "", text: "off" }, ...axes.map((axis: Axis) => ({ value: axis, text: axis }))];

/** The same for what there is of one body alone. */
function bodily(...[store, name, options]: Parameters<typeof chosen>): HTMLSelectElement {
  const control = chosen(store, name, options);
  forOneBody(store, control);
  return control;
}

/** A label, what it belongs to, and more. */
function beside(text: string, help: string, control: HTMLElement, ...more: (HTMLElement | undefined)[]): HTMLElement {
  return el("span", { className: "beside", title: help }, el("label", {}, text, control), ...more);
}

function contours(store: Store): HTMLElement {
  const every = el("input", { type: "number", min: 0.25, step: 0.5, title: "Distance in voxels" });
  every.setAttribute("aria-label", "Distance of the contours in voxels");
  every.addEventListener("change", () => store.set({ every: Number(every.value) || initial.every }));
  const show = (): void => {
    every.value = String(store.state.every);
    every.hidden = store.state.contours === "";
  };
  store.watch(["every", "contours"], show);
  show();
  return beside("Contours", "Contours across an axis, so many voxels apart (C)", bodily(store, "contours", acrossAxes), every);
}

/** Something across an axis, with a slider for where. */
function across(
  session: Session,
  name: "slice" | "clip",
  at: "sliceAt" | "clipAt",
  text: string,
  help: string,
  more?: HTMLElement,
): HTMLElement {
  const { store } = session;
  const range = { min: 0, max: 1, step: "any" } as const;
  const control = slider(`${text}: where`, range, (value) => store.set({ [at]: Number(value.toFixed(4)) }));
  const show = (): void => {
    const axis = store.state[name];
    control.element.hidden = axis === "";
    if (more) more.hidden = axis === "";
    const size = session.volume?.dims[axes.indexOf(axis || "x")] ?? 1;
    const index = store.state[at] * (size - 1);
    control.set(store.state[at], compact(name === "slice" ? Math.round(index) : Number(index.toFixed(1))));
  };
  store.watch([name, at], show);
  session.on("volumes", show);
  show();
  return beside(text, help, chosen(store, name, acrossAxes), control.element, more);
}

function wipeAt(store: Store): HTMLElement {
  const control = slider("Where the wipe is", { min: 0, max: 1, step: 0.01 }, (value) => store.set({ wipeAt: value }));
  const line = beside("Wipe at", "Drag the line, or this", control.element);
  const show = (): void => {
    line.hidden = !store.state.wipe;
    control.set(store.state.wipeAt, `${Math.round(100 * store.state.wipeAt)} %`);
  };
  store.watch(["wipe", "wipeAt"], show);
  show();
  return line;
}

/** The same as the setting, where one looks for it. */
function settingSwitch({ store, hello }: Session): HTMLElement {
  const usual = String(hello.choices.surface?.default ?? "primal");
  const group = el("span", { className: "segmented", role: "group", "aria-label": "Surface" });
  for (const { value, help } of hello.choices.surface?.values ?? []) {
    const choose = (): void => store.choose(store.state.active, "surface", value === usual ? undefined : value);
    const control = toggle(value, help, choose);
    const show = (): void => press(control, (store.state.settings[store.state.active]?.surface ?? usual) === value);
    store.watch(["settings", "active"], show);
    show();
    forOneBody(store, control);
    group.append(control);
  }
  return group;
}
