// What lies over the picture: titles of the views, the wipe, the legend, notices.

import { compact, el } from "../dom.ts";
import type { Looks } from "../looks.ts";
import type { Rectangle } from "../scene/stage.ts";
import type { Session } from "../session.ts";
import type { Store } from "../state.ts";
import { stateText } from "./fairing.ts";
import { title } from "./numbers.ts";

/** The places of the views on the canvas. */
export function layout(container: HTMLElement): () => Rectangle[] {
  return () => {
    const base = container.getBoundingClientRect();
    return [...container.children].map((pane) => {
      const { left, top, width, height } = pane.getBoundingClientRect();
      return { left: left - base.left, top: top - base.top, width, height };
    });
  };
}

/** As many empty panes as there are views. */
export function makePanes(container: HTMLElement, store: Store): void {
  const show = (): void => {
    const { views, active } = store.state;
    container.dataset.views = String(views);
    while (container.children.length > views) container.lastElementChild?.remove();
    while (container.children.length < views) container.append(pane(store));
    [...container.children].forEach((child, view) => child.classList.toggle("active", view === active));
  };
  store.watch(["views", "active"], show);
  show();
}

function pane(store: Store): HTMLElement {
  const wipe = el("div", { className: "wipe" });
  const box = el("div", { className: "pane" }, el("div", { className: "title" }, el("b"), el("span", { className: "state" })), el("div", { className: "problem", hidden: true }), wipe);
  wipe.addEventListener("pointerdown", (event) => wipe.setPointerCapture(event.pointerId));
  wipe.addEventListener("pointermove", (event) => {
    if (!wipe.hasPointerCapture(event.pointerId)) return;
    const { left, width } = box.getBoundingClientRect();
    store.set({ wipeAt: Math.min(Math.max((event.clientX - left) / width, 0), 1) });
  });
  return box;
}

/** Keeps what the panes say up to date. */
export function describe(container: HTMLElement, session: Session): void {
  const show = (): void => {
    const { views, wipe, wipeAt } = session.store.state;
    [...container.children].forEach((box, index) => {
      const view = session.views[index];
      if (!view) return;
      box.querySelector("b")!.textContent = views > 1 ? title(session, index) : "";
      box.querySelector(".state")!.textContent = views > 1 && view.surface ? stateText(view) : "";
      const problem = box.querySelector<HTMLElement>(".problem")!;
      problem.textContent = view.problem;
      problem.hidden = view.problem === "";
      const line = box.querySelector<HTMLElement>(".wipe")!;
      line.hidden = !wipe || ["surface", "materials"].some((name) => name in (session.store.state.settings[index] ?? {}));
      line.style.left = `${100 * wipeAt}%`;
    });
  };
  for (const topic of ["views", "solver"] as const) session.on(topic, show);
  session.store.watch(["views", "active", "settings", "wipe", "wipeAt"], show);
  show();
}

export function legend(session: Session, looks: Looks): { element: HTMLElement; show: () => void } {
  const name = el("b");
  const ramp = el("div", { className: "ramp" });
  const ends = el("div", { className: "ends" });
  const element = el("div", { className: "legend", role: "img", hidden: true }, name, ramp, ends);
  const show = (): void => {
    const { colouring } = looks;
    element.hidden = !colouring;
    if (!colouring) return;
    const { low, high, legend: stops, unit } = colouring;
    const share = (value: number): number => (100 * (value - low)) / (high - low || 1);
    const hex = (text: string): string => (text.startsWith("#") ? text : `#${text}`);
    const colours = stops.map(([value, colour]) => `${hex(colour)} ${share(value).toFixed(1)}%`);
    ramp.style.background = `linear-gradient(to right, ${colours.join(", ")})`;
    const field = session.store.state.colours.replaceAll("-", " ");
    name.textContent = unit ? `${field}, ${unit}` : field;
    ends.replaceChildren(...[low, (low + high) / 2, high].map((value) => el("span", {}, compact(value))));
    element.setAttribute("aria-label", `Colours: ${field} from ${compact(low)} to ${compact(high)}`);
  };
  session.store.watch(["colours"], show);
  return { element, show };
}
