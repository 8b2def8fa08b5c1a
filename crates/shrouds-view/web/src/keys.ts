// Keys: one table for what they do and for the page that tells of them.

import { el } from "./dom.ts";
import { nextTheme, setViews } from "./panels/bar.ts";
import { randomStart } from "./panels/fairing.ts";
import type { Stage } from "./scene/stage.ts";
import type { Session } from "./session.ts";
import { MOST_VIEWS, type Axis, type State } from "./state.ts";

interface Key {
  /** As `KeyboardEvent.key`, in lower case. */
  keys: string[];
  shown: string;
  does: string;
  go(key: string): void;
}

const TURN = 7.5;
const ZOOM = 1.15;
const AXES: (Axis | "")[] = ["", "x", "y", "z"];

export function keyTable(session: Session, stage: Stage, help: () => void): Key[] {
  const { store } = session;
  const flip = (name: "smooth" | "network" | "points" | "parallel" | "wipe" | "brush" | "live" | "brushAdds") => () =>
    store.set({ [name]: !store.state[name] });
  const turnAxis = (name: "contours" | "slice" | "clip") => () =>
    store.set({ [name]: AXES[(AXES.indexOf(store.state[name]) + 1) % AXES.length] } as Partial<State>);
  const control = (what: "step" | "reset" | "cancel") => () => void session.control(store.state.active, what);
  const colours = ["", ...session.hello.fields.map(({ name }) => name)];
  const one = (key: string, does: string, go: (key: string) => void, shown = key.toUpperCase()): Key => ({ keys: [key], shown, does, go });
  return [
    one(" ", "run, pause", () => void session.control(store.state.active, session.active.state === "running" ? "pause" : "run"), "Space"),
    one("s", "one step", control("step")),
    one("r", "reset", control("reset")),
    one("x", "cancel", control("cancel")),
    one("a", "random start", () => randomStart(session)),
    one("l", "live", flip("live")),
    one("f", "smooth, flat", flip("smooth")),
    one("n", "network", flip("network")),
    one("v", "voxel centres", flip("points")),
    one("c", "contours: off, x, y, z", turnAxis("contours")),
    one("i", "slice: off, x, y, z", turnAxis("slice")),
    one("k", "clip: off, x, y, z", turnAxis("clip")),
    one("d", "next colours", () => store.set({ colours: colours[(colours.indexOf(store.state.colours) + 1) % colours.length]! })),
    one("w", "midpoint, shroud wipe", flip("wipe")),
    one("o", "parallel rays", flip("parallel")),
    one("b", "brush", flip("brush")),
    one("e", "brush adds, removes", flip("brushAdds")),
    { keys: ["[", "]"], shown: "[ ]", does: "radius of the brush", go: (key) => store.set({ brushRadius: Math.max(store.state.brushRadius + (key === "]" ? 0.5 : -0.5), 0) }) },
    { keys: ["1", "2", "3", "4"], shown: "1 … 4", does: "that view", go: (key) => Number(key) <= store.state.views && store.set({ active: Number(key) - 1 }) },
    { keys: ["arrowleft", "arrowright", "arrowup", "arrowdown"], shown: "← → ↑ ↓", does: "turn", go: (key) => turn(stage, key) },
    { keys: ["+", "=", "-"], shown: "+ −", does: "zoom", go: (key) => stage.camera.zoom(key === "-" ? 1 / ZOOM : ZOOM) },
    { keys: ["home", "0"], shown: "Home", does: "all in sight", go: () => stage.fit() },
    one("t", "light, dark", () => store.set({ theme: nextTheme(store.state.theme) })),
    one("?", "these keys", help),
  ];
}

function turn(stage: Stage, key: string): void {
  const right = key === "arrowright" ? -TURN : key === "arrowleft" ? TURN : 0;
  const up = key === "arrowup" ? TURN : key === "arrowdown" ? -TURN : 0;
  stage.camera.turn(right, up);
}

/** Listens; keys in fields and on buttons keep their own meaning. */
export function listen(session: Session, table: readonly Key[]): void {
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    const key = event.key.toLowerCase();
    if (target.matches("input:not([type=checkbox]), select, textarea") || target.closest("dialog")) return;
    if ((event.ctrlKey || event.metaKey) && key === "z") {
      event.preventDefault();
      return void session.edit(event.shiftKey ? "redo" : "undo");
    }
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const digit = /^Digit([1-4])$/.exec(event.code);
    if (event.shiftKey && digit && Number(digit[1]) <= MOST_VIEWS) return setViews(session.store, Number(digit[1]));
    if (key === " " && target.matches("button, summary, input")) return;
    const entry = table.find(({ keys }) => keys.includes(key));
    if (!entry) return;
    event.preventDefault();
    entry.go(key);
  });
}

/** The table, to read. */
export function fillHelp(dialog: HTMLDialogElement, table: readonly Key[]): void {
  const more: [string, string][] = [["Ctrl+Z", "undo"], ["Ctrl+Shift+Z", "redo"], ["Shift+1 … 4", "so many views"]];
  const all = [...table.map(({ shown, does }) => [does, shown]), ...more.map(([shown, does]) => [does, shown])];
  const lines = all.map(([does, shown]) => el("div", {}, does, el("kbd", {}, shown)));
  const close = el("form", { method: "dialog" }, el("button", { className: "strong" }, "Close"));
  close.style.marginTop = "12px";
  dialog.replaceChildren(el("h2", {}, "Keys"), el("div", { className: "keys" }, ...lines), close);
}
