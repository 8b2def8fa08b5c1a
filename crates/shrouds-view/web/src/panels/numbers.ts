// Numbers of all views side by side, and of energies compared.

import { button, bytes, compact, el, row } from "../dom.ts";
import type { Session } from "../session.ts";
import type { View } from "../view.ts";
import { materialsTables } from "./materials.ts";
import { forOneBody } from "./one-body.ts";

/** The columns of a comparison that come first. */
const FIRST = ["name", "status", "iterations", "seconds", "volume", "area", "roughness", "largest_move"];
/** Packed with so many bits for the place of each vertex. */
const BITS = ["0", "1", "2", "4", "8"];
const HEADINGS = [
  "setting", "energy", "vertices", "triangles", "volume", "area", "wrong side", "manifold", "parts", "roughness",
  ...BITS.map((bits) => (bits === "0" ? "0 bit" : bits)), "seconds",
];

export function numbersPanel(session: Session): HTMLElement[] {
  const body = el("tbody");
  const table = el("table", { "aria-label": "Numbers of the views" }, el("thead", {}, headings(HEADINGS)), body);
  const show = (): void => {
    const { views, active } = session.store.state;
    body.replaceChildren(...session.views.slice(0, views).map((view) => line(session, view, view.index === active)));
  };
  for (const topic of ["views", "solver", "numbers"] as const) session.on(topic, show);
  session.store.watch(["views", "active", "settings"], show);
  show();
  return [table, materialsTables(session), ...comparison(session)];
}

function headings(names: readonly string[]): HTMLElement {
  return el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name)));
}

/** What sets a view apart, in a few words. */
export function title(session: Session, view: number): string {
  const settings = session.store.state.settings[view] ?? {};
  const { energy = "bending", materials, ...others } = settings;
  return [materials ? "several labels" : energy, ...Object.entries(others).map(([name, value]) => `${name} ${value}`)].join(", ");
}

function line(session: Session, view: View, active: boolean): HTMLElement {
  const { numbers, surface, history } = view;
  const cell = (text: string, className = ""): HTMLElement => el("td", { className }, text);
  const sound = numbers && (numbers.manifold ? "yes" : "no");
  const wrong = numbers && numbers.wrong_side;
  const cells = [
    el("td", { title: title(session, view.index) }, title(session, view.index)),
    cell(compact(history.at(-1)?.energy)),
    cell(compact(numbers?.vertices ?? surface?.vertices)),
    cell(compact(numbers?.triangles ?? surface?.triangles)),
    cell(compact(numbers?.volume)),
    cell(compact(numbers?.area)),
    cell(compact(wrong), wrong === undefined ? "" : wrong === 0 ? "good" : "bad"),
    cell(sound ?? "–", sound === undefined ? "" : sound === "yes" ? "good" : "bad"),
    cell(compact(numbers?.components ?? surface?.components)),
    cell(compact(numbers?.roughness)),
    ...BITS.map((bits) => cell(size(view, bits))),
    cell(seconds(view)),
  ];
  const row_ = el("tr", { className: active ? "active" : "" }, ...cells);
  row_.addEventListener("click", () => session.store.set({ active: view.index }));
  return row_;
}

function size({ sizes, packing }: View, bits: string): string {
  const known = sizes[bits];
  return known === undefined ? (packing ? "…" : "–") : bytes(known);
}

function seconds({ numbers, seconds: solving }: View): string {
  const optimize = numbers?.times?.optimize ?? solving;
  return optimize ? optimize.toFixed(2) : "–";
}

/** The table of `shrouds compare`, row by row as they come. */
function comparison(session: Session): HTMLElement[] {
  const energies = el("input", { type: "text", value: "bending;bending+0.3*variation;linear;length", spellcheck: false });
  energies.setAttribute("aria-label", "Energies to compare, with semicolons between");
  const head = el("thead");
  const body = el("tbody");
  const table = el("table", { hidden: true, "aria-label": "Energies compared" }, head, body);
  const show = (): void => {
    const all = session.rows.flatMap((entry) => Object.keys(entry).filter((name) => plain(entry[name])));
    const names = [...new Set([...FIRST, ...all])].filter((name) => name !== "energy");
    table.hidden = session.rows.length === 0;
    head.replaceChildren(headings(names.map((name) => name.replaceAll("_", " "))));
    body.replaceChildren(...session.rows.map((entry) => el("tr", {}, ...names.map((name) => el("td", {}, text(entry[name]))))));
  };
  session.on("rows", show);
  const start = async (): Promise<void> => {
    session.rows.length = 0;
    show();
    go.disabled = true;
    const { energy: _, materials: __, ...settings } = session.store.state.settings[session.store.state.active] ?? {};
    const list = energies.value.split(";").map((energy) => energy.trim()).filter(Boolean);
    await session.attempt(() => session.request("compare", { slot: session.slot, energies: list, settings }));
    go.disabled = false;
  };
  const go = button("Compare", () => void start(), "Shroud the volume with one energy after the other");
  const sizes = button(
    "Sizes",
    () => void session.pack(session.store.state.active),
    "Bytes of the active view when packed with 0 to 8 bits for each vertex; all but the largest surfaces tell by themselves",
  );
  forOneBody(session.store, sizes);
  const bar = row(el("span", { className: "grow" }, energies), go, sizes);
  bar.style.padding = "5px 12px";
  return [bar, table];
}

const plain = (value: unknown): boolean => typeof value === "number" || typeof value === "string";

function text(value: unknown): string {
  return typeof value === "number" ? compact(value) : String(value ?? "–");
}
