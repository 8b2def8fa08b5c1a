// The labels of a volume: which are chosen, whether they are one body or several, which boundaries are shown.

import { button, compact, el, press, row, toggle } from "../dom.ts";
import type { Label, Volume } from "../protocol.ts";
import { labelsIn } from "../scene/interfaces.ts";
import type { Session } from "../session.ts";
import type { Store } from "../state.ts";
import { showsSeveral } from "./one-body.ts";

/** The list of a volume's labels, and what brings its buttons up to date. */
export interface LabelList {
  elements: HTMLElement[];
  refresh(): void;
}

/** A line for each label, and buttons for all of them. */
export function labelList(session: Session, { labels: all }: Volume): LabelList {
  const { store } = session;
  const known = all ?? [];
  const named = labelsIn(store.state.labels);
  const chosen = named.size > 0 ? named : new Set(known.map(({ value }) => value).filter((value) => value !== 0));
  const boxes = new Map<number, HTMLInputElement>();
  const boundaries = new Map<number, HTMLElement>();
  const change = (): void => {
    const values = [...boxes].filter(([, box]) => box.checked).map(([value]) => value);
    if (values.length === 0) return session.say("info", "Choose at least one label.");
    store.set({ labels: values.join(","), threshold: "" });
    void session.change("select", { slot: "a", labels: values });
  };
  const line = ({ value, name, count, colour }: Label): HTMLElement => {
    const box = el("input", { type: "checkbox", checked: chosen.has(value), onchange: change });
    boxes.set(value, box);
    const swatch = el("i");
    swatch.style.background = colour.startsWith("#") ? colour : `#${colour}`;
    const text = name || String(value);
    const choice = el("label", {}, box, swatch, text, el("span", { className: "quiet" }, compact(count)));
    if (value !== 0) boundaries.set(value, boundary(store, value, text));
    return el("div", { className: "label" }, choice, boundaries.get(value));
  };
  const list = el("div", { className: "labels", role: "group", "aria-label": "Labels" }, ...known.map(line));
  const all_ = (on: boolean): void => {
    for (const box of boxes.values()) box.checked = on;
    if (on) change();
  };
  const shown = button("Show all", () => store.set({ hidden: "" }), "Show the boundaries of all labels");
  const refresh = (): void => {
    const hidden = labelsIn(store.state.hidden);
    for (const control of [shown, ...boundaries.values()]) control.hidden = !showsSeveral(store.state);
    for (const [label, control] of boundaries) press(control, !hidden.has(label));
  };
  refresh();
  const buttons = row(button("All", () => all_(true)), button("None", () => all_(false), "Then choose some"), shown);
  return { elements: [list, buttons], refresh };
}

/** Shows or hides the boundary of a label. */
function boundary(store: Store, label: number, name: string): HTMLElement {
  const control = toggle("show", `Show the boundary of label ${name}`, () => {
    const hidden = labelsIn(store.state.hidden);
    if (!hidden.delete(label)) hidden.add(label);
    store.set({ hidden: [...hidden].join(",") });
  });
  control.setAttribute("aria-label", `Show the boundary of label ${name}`);
  return control;
}

/** Whether the chosen labels are one body in the active view, or several with interfaces between them. */
export function bodySwitch({ store }: Session): HTMLElement {
  const choose = (several: boolean) => () => store.choose(store.state.active, "materials", several ? "true" : undefined);
  const one = toggle("One body", "The labels that are chosen as one body", choose(false));
  const all = toggle("All labels", "The interfaces between all labels that are chosen, at least two", choose(true));
  const show = (): void => {
    const several = showsSeveral(store.state);
    press(one, !several);
    press(all, several);
  };
  store.watch(["settings", "active"], show);
  show();
  return el("span", { className: "segmented", role: "group", "aria-label": "What the labels are" }, one, all);
}
