// How it is shown.

import { compact, el, field, press, row, section, select, slider, toggle } from "../dom.ts";
import type { Session } from "../session.ts";
import { axes, initial, type Axis, type State, type Store } from "../state.ts";

type Flag = { [K in keyof State]: State[K] extends boolean ? K : never }[keyof State];

export function seeingPanel(session: Session): HTMLElement {
  const { store } = session;
  const flag = (name: Flag, text: string, title: string): HTMLElement => {
    const control = toggle(text, title, () => store.set({ [name]: !store.state[name] }));
    control.dataset.look = name;
    const show = (): void => press(control, store.state[name]);
    store.watch([name], show);
    show();
    return control;
  };
  const colours = [{ value: "", text: "none" }, ...session.hello.fields.map(({ name, help }) => ({ value: name, text: name.replaceAll("-", " "), help }))];
  return section(
    "Seeing",
    row(
      flag("smooth", "Smooth", "Smooth shading instead of flat (F)"),
      flag("network", "Network", "The slice curves: across x red, y white, z blue (N)"),
      flag("points", "Voxels", "Voxel centres near the surface: discs inside, rings outside (V)"),
      flag("parallel", "Parallel", "Parallel rays instead of perspective (O)"),
      flag("wipe", "Wipe", "Midpoints on the left, the shroud on the right (W)"),
    ),
    field("Colours", chosen(store, "colours", colours), "Numbers of the vertices as colours (D)"),
    contours(store),
    across(session, "slice", "sliceAt", "Slice", "A slice of the volume (I)"),
    across(session, "clip", "clipAt", "Clip", "Cut away what lies beyond a plane (K)", flag("clipBack", "⇄", "Cut the other side away")),
    wipeAt(store),
    field("Surface", settingSwitch(session), "Vertices on grid edges (primal) or one per cell patch (dual)"),
  );
}

function chosen(store: Store, name: "colours" | "contours" | "slice" | "clip", options: { value: string; text?: string }[]): HTMLSelectElement {
  const control = select(options, (value) => store.set({ [name]: value }));
  control.dataset.look = name;
  const show = (): void => void (control.value = store.state[name]);
  store.watch([name], show);
  show();
  return control;
}

const acrossAxes = [{ value: "", text: "off" }, ...axes.map((axis: Axis) => ({ value: axis, text: `across ${axis}` }))];

function contours(store: Store): HTMLElement {
  const every = el("input", { type: "number", min: 0.25, step: 0.5, title: "Distance in voxels" });
  every.setAttribute("aria-label", "Distance of the contours in voxels");
  every.addEventListener("change", () => store.set({ every: Number(every.value) || initial.every }));
  const show = (): void => {
    every.value = String(store.state.every);
    every.disabled = store.state.contours === "";
  };
  store.watch(["every", "contours"], show);
  show();
  const control = chosen(store, "contours", acrossAxes);
  return field("Contours", beside(control, every), "Contours across an axis, so many voxels apart (C)");
}

/** Something across an axis, with a slider for where. */
function across(session: Session, name: "slice" | "clip", at: "sliceAt" | "clipAt", text: string, help: string, more?: HTMLElement): HTMLElement {
  const { store } = session;
  const control = slider(`${text}: where`, { min: 0, max: 1, step: "any" }, (value) => store.set({ [at]: Number(value.toFixed(4)) }));
  const show = (): void => {
    const axis = store.state[name];
    control.element.hidden = axis === "";
    const size = session.volume?.dims[axes.indexOf(axis || "x")] ?? 1;
    const index = store.state[at] * (size - 1);
    control.set(store.state[at], compact(name === "slice" ? Math.round(index) : Number(index.toFixed(1))));
    if (more) more.hidden = axis === "";
  };
  store.watch([name, at], show);
  session.on("volumes", show);
  show();
  const box = el("div", {}, beside(chosen(store, name, acrossAxes), more), control.element);
  const line = field(text, box, help);
  line.querySelector("label")!.htmlFor = box.querySelector("select")!.id ||= `choice-${name}`;
  return line;
}

function beside(...children: (HTMLElement | undefined)[]): HTMLElement {
  const [first, ...others] = children;
  const box = el("div", { className: "row" }, el("span", { className: "grow" }, first), ...others);
  box.style.flexWrap = "nowrap";
  return box;
}

function wipeAt(store: Store): HTMLElement {
  const control = slider("Where the wipe is", { min: 0, max: 1, step: 0.01 }, (value) => store.set({ wipeAt: value }));
  const line = field("Wipe at", control.element);
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
    group.append(control);
  }
  return group;
}
