// How the active view is smoothed: its energy, its settings, and the buttons that run it.

import { button, compact, el, field, press, row, section, select, setOptions, toggle } from "../dom.ts";
import type { Choice } from "../protocol.ts";
import type { Session } from "../session.ts";
import { energyEditor } from "./energy.ts";
import { WHY, forOneBody, showsSeveral } from "./one-body.ts";
import { plots } from "./plot.ts";

export function fairingPanel(session: Session): HTMLElement[] {
  const energy = el("fieldset", { "aria-label": "Energy" }, ...energyEditor(session));
  forOneBody(session.store, energy);
  return [
    section("Fairing", ...transport(session)),
    section("Progress", ...plots(session)),
    section("Energy", energy),
    section("Settings", ...settings(session)),
  ];
}

function transport(session: Session): HTMLElement[] {
  const { store } = session;
  const control = (what: "run" | "step" | "pause" | "reset" | "cancel") => () =>
    void session.control(store.state.active, what);
  const run = button("▶ Run", control("run"), "Run until it ends (Space)", "strong");
  const pause = button("❚❚ Pause", control("pause"), "Pause (Space)");
  const step = button("Step", control("step"), "One step or sweep (S)");
  const reset = button("Reset", control("reset"), "Back to the start (R)");
  const cancel = button("Cancel", control("cancel"), "Stop at once (X)");
  const random = button("Random start", () => randomStart(session), "Start from random places of the vertices (A)");
  const live = toggle("Live", "Run whenever something changes (L)", () => store.set({ live: !store.state.live }));
  const state = el("div", { className: "quiet", role: "status" });
  state.id = "solver-state";
  const problem = el("div", { className: "problem", role: "alert" });
  const show = (): void => {
    const view = session.active;
    const running = view.state === "running";
    // Those of several labels run in one piece.
    const whole = showsSeveral(store.state);
    run.hidden = running && !whole;
    pause.hidden = !running || whole;
    for (const control of [run, pause, step, reset, cancel]) control.disabled = !view.surface;
    run.disabled ||= running;
    for (const control of [step, reset]) control.disabled ||= whole;
    cancel.disabled ||= !running && (whole || view.state !== "paused");
    step.title = whole ? WHY : "One step or sweep (S)";
    reset.title = whole ? WHY : "Back to the start (R)";
    cancel.title = whole ? "Drop what comes of it, when it comes" : "Stop at once (X)";
    press(live, store.state.live);
    state.textContent = stateText(view);
    problem.textContent = view.problem;
    problem.hidden = view.problem === "";
  };
  for (const topic of ["views", "solver"] as const) session.on(topic, show);
  store.watch(["active", "live", "settings"], show);
  show();
  return [row(run, pause, step, reset, cancel), row(random, live), state, problem];
}

/** What a view is at, in words. */
export function stateText({ state, status, iteration, seconds, surface }: Session["active"]): string {
  if (surface?.materials && state === "paused") return "nothing is made yet: run it";
  if (surface?.materials && state === "running") return "making the interfaces…";
  const words = { empty: "nothing to do yet", waiting: "making the surface…" } as Record<string, string>;
  const doing = words[state];
  if (doing !== undefined) return doing;
  const what = state === "done" ? status || "done" : state;
  return `${what} · step ${iteration} · ${compact(Number(seconds.toFixed(2)))} s`;
}

export function randomStart(session: Session): void {
  const seed = 1 + Math.floor(Math.random() * 9999);
  session.store.choose(session.store.state.active, "start", `random:${seed}`);
}

function settings(session: Session): HTMLElement[] {
  const { choices } = session.hello;
  const names = Object.keys(choices).filter((name) => name !== "energy" && name !== "materials");
  names.sort((a, b) => (choices[a]?.order ?? 99) - (choices[b]?.order ?? 99));
  const { store } = session;
  return names.map((name) => {
    const choice = choices[name]!;
    const choose = (value: string | undefined): void => store.choose(store.state.active, name, value);
    const { element, show } = control(choice, choose);
    const line = field(name.replaceAll("-", " "), element, choice.help);
    element.dataset.setting = name;
    if (choice.materials === false) forOneBody(store, element);
    const refresh = (): void => {
      const value = store.state.settings[store.state.active]?.[name];
      line.classList.toggle("changed", value !== undefined);
      show(value);
    };
    store.watch(["settings", "active"], refresh);
    refresh();
    return line;
  });
}

interface Control {
  element: HTMLInputElement | HTMLSelectElement;
  show(value: string | undefined): void;
}

function control(choice: Choice, choose: (value: string | undefined) => void): Control {
  if (choice.flag) return flag(choose);
  if (choice.values?.length && !choice.text) return choosing(choice, choose);
  return typing(choice, choose);
}

function flag(choose: (value: string | undefined) => void): Control {
  const element = el("input", { type: "checkbox" });
  element.addEventListener("change", () => choose(element.checked ? "true" : undefined));
  element.style.justifySelf = "start";
  return { element, show: (value) => (element.checked = value === "true") };
}

function choosing(choice: Choice, choose: (value: string | undefined) => void): Control {
  const usual = choice.default === null ? "usual" : String(choice.default);
  const options = (choice.values ?? []).filter(({ value }) => value !== choice.default);
  const element = select([], (value) => choose(value === "" ? undefined : value));
  const show = (value = ""): void => {
    const known = value === "" || options.some((option) => option.value === value);
    const more = known ? [] : [{ value }];
    setOptions(element, [{ value: "", text: usual }, ...options, ...more]);
    element.value = value;
  };
  return { element, show };
}

function typing(choice: Choice, choose: (value: string | undefined) => void): Control {
  const placeholder = choice.default === null ? "usual" : String(choice.default);
  const element = el("input", { type: "text", placeholder, spellcheck: false, title: choice.help });
  element.addEventListener("change", () => choose(element.value.trim() || undefined));
  if (choice.values) element.setAttribute("list", suggestions(choice.values));
  const show = (value = ""): void => {
    if (document.activeElement !== element || value === "") element.value = value;
  };
  return { element, show };
}

/** A list of values to choose from or to change; its name. */
function suggestions(values: readonly { value: string; help: string }[]): string {
  const list = el("datalist", {}, ...values.map(({ value, help }) => el("option", { value }, help)));
  list.id = `values-${values.map(({ value }) => value).join("-")}`;
  document.body.append(list);
  return list.id;
}
