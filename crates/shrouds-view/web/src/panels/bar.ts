// The top: what is shown, what is being done, how many views, light or dark.

import { button, el, toggle, press } from "../dom.ts";
import type { Session } from "../session.ts";
import { MOST_VIEWS, type State } from "../state.ts";

export function bar(session: Session, help: () => void): HTMLElement[] {
  return [
    el("h1", {}, "Shrouds ", el("span", {}, "test bed")),
    what(session),
    working(session),
    viewCount(session),
    themeSwitch(session),
    button("?", help, "Keys (?)"),
  ];
}

function what(session: Session): HTMLElement {
  const name = el("b");
  const rest = el("span");
  const show = (): void => {
    const { volume } = session;
    name.textContent = volume?.name.replace(/^.*[\\/]/, "") ?? "";
    rest.textContent = volume ? `  ${volume.dims.join(" × ")}` : "";
    document.title = volume ? `${name.textContent} · Shrouds test bed` : "Shrouds test bed";
  };
  session.on("volumes", show);
  return el("div", { className: "what" }, name, rest);
}

function working(session: Session): HTMLElement {
  const text = el("span");
  const progress = el("progress", { max: 1, "aria-label": "Progress" });
  const box = el("div", { className: "work", role: "status", hidden: true }, text, progress);
  box.id = "work";
  const show = (): void => {
    const { work } = session;
    const solving = session.views.some(({ state }) => state === "running" || state === "waiting");
    box.hidden = !work && !solving;
    text.textContent = work?.stage ?? "tightening";
    if (work?.share === null || work === undefined) progress.removeAttribute("value");
    else progress.value = work.share;
  };
  for (const topic of ["work", "solver", "views"] as const) session.on(topic, show);
  return box;
}

function viewCount({ store }: Session): HTMLElement {
  const group = el("div", { className: "segmented", role: "group", "aria-label": "Views side by side" });
  for (let views = 1; views <= MOST_VIEWS; views++) {
    const control = toggle(String(views), `${views} ${views > 1 ? "views side by side" : "view"} (Shift+${views})`, () => setViews(store, views));
    control.dataset.views = String(views);
    const show = (): void => press(control, store.state.views === views);
    store.watch(["views"], show);
    show();
    group.append(control);
  }
  return group;
}

/** A new view begins with the settings of the active one. */
export function setViews(store: Session["store"], views: number): void {
  const { settings, active, views: before } = store.state;
  const copied = settings.map((own, view) => (view >= before && view < views && Object.keys(own).length === 0 ? settings[active]! : own));
  store.set({ views, active: Math.min(active, views - 1), settings: copied });
}

const themes = ["auto", "light", "dark"] as const;
const signs = { auto: "◐", light: "☀", dark: "☾" };

function themeSwitch({ store }: Session): HTMLElement {
  const control = button("", () => store.set({ theme: nextTheme(store.state.theme) }), "Light, dark or as the system (T)");
  const show = (): void => {
    control.textContent = signs[store.state.theme];
    control.setAttribute("aria-label", `Colours of the page: ${store.state.theme}`);
  };
  store.watch(["theme"], show);
  show();
  return control;
}

export function nextTheme(theme: State["theme"]): State["theme"] {
  return themes[(themes.indexOf(theme) + 1) % themes.length]!;
}
