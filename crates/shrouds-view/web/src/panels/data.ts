// What is shown: demos, files, labels, thresholds, two volumes together.

import { button, compact, el, field, row, section, select, slider } from "../dom.ts";
import type { Slot, Volume } from "../protocol.ts";
import type { Session } from "../session.ts";
import { sourceOf, sourceText } from "../source.ts";
import { upload } from "../upload.ts";
import { bodySwitch, labelList, type LabelList } from "./labels.ts";
import { showsSeveral } from "./one-body.ts";

export function dataPanel(session: Session): HTMLElement[] {
  return [
    section("Data", ...source(session), summary(session)),
    selection(session),
    together(session),
  ];
}

/** Opens a volume and remembers it in the address. */
export async function open(session: Session, slot: Slot, text: string): Promise<void> {
  const { store } = session;
  store.set(slot === "a" ? { source: text, labels: "", hidden: "", threshold: "" } : { second: text });
  if (slot === "a") session.slot = "a";
  await session.open(slot, sourceOf(text));
}

/** What the address says, or else what the program was started with, or else the first demo. */
export async function restore(session: Session): Promise<void> {
  const { source: text, second, labels: chosen, threshold: above } = session.store.state;
  const given = session.hello.input;
  const first = session.hello.demos[0]?.name ?? "tori";
  const source = text ? sourceOf(text) : (given ?? { demo: first });
  session.store.set({ source: sourceText(source) });
  const select = chosen ? { labels: chosen.split(",").map(Number) } : above ? { threshold: Number(above) } : undefined;
  await session.open("a", source, select);
  if (second) await session.open("b", sourceOf(second));
}

/** Opens a file that the page was given. */
export async function openFile(session: Session, slot: Slot, file: File): Promise<void> {
  const { store } = session;
  store.set(slot === "a" ? { source: "", labels: "", hidden: "", threshold: "" } : { second: "" });
  if (slot === "a") session.slot = "a";
  const id = await session.attempt(() => upload(file, (share) => session.working("uploading", share)));
  session.working();
  if (id) await session.open(slot, { upload: id });
}

function source(session: Session): HTMLElement[] {
  const demos = session.hello.demos.map(({ name }) => name);
  const opening = (): void => void open(session, "a", demoText(name.value, size.value));
  const name = select(demos.map((value) => ({ value })), () => {
    size.value = String(session.hello.demos.find((demo) => demo.name === name.value)?.size ?? 64);
    opening();
  });
  const size = el("input", { type: "number", min: 1, max: 512, value: "64", title: "Voxels along each side" });
  size.setAttribute("aria-label", "Voxels along each side of the demo");
  size.addEventListener("change", opening);
  const path = el("input", { type: "text", placeholder: "path of a file or folder", spellcheck: false });
  path.setAttribute("aria-label", "Path of a file or folder on this machine");
  const given = (): void => {
    if (path.value.trim()) void open(session, "a", path.value.trim());
  };
  path.addEventListener("keydown", (event) => event.key === "Enter" && given());
  const file = el("input", { type: "file", hidden: true });
  file.addEventListener("change", () => {
    if (file.files?.[0]) void openFile(session, "a", file.files[0]);
    file.value = "";
  });
  const show = ({ source: text }: { source: string }): void => {
    const shown = sourceOf(text);
    if ("demo" in shown) {
      name.value = shown.demo;
      if (shown.size) size.value = String(shown.size);
    } else if ("path" in shown) path.value = shown.path;
  };
  session.store.watch(["source"], show);
  show(session.store.state);
  const pair = el("div", { className: "row" }, el("span", { className: "grow" }, name), size);
  pair.style.flexWrap = "nowrap";
  name.id = "demo";
  return [
    el("div", { className: "field short" }, el("label", { htmlFor: name.id }, "Demo"), pair),
    row(el("span", { className: "grow" }, path), button("Open", given)),
    row(button("Choose a file…", () => file.click()), el("span", { className: "quiet", title: "Held with Shift it becomes the second volume, B" }, "or drop one"), file),
  ];
}

function demoText(name: string, size: string): string {
  return `demo:${name}${Number(size) > 0 ? `:${size}` : ""}`;
}

function summary(session: Session): HTMLElement {
  const list = el("dl");
  const show = (): void => {
    const { volume } = session;
    list.hidden = !volume;
    if (volume) list.replaceChildren(...facts(volume).flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
  };
  session.on("volumes", show);
  show();
  return list;
}

function facts(volume: Volume): [string, string][] {
  const { dims, spacing, unit, inside, frame, selected } = volume;
  const steps = spacing.map((step) => compact(step)).join(" × ");
  const found: [string, string][] = [
    ["voxels", dims.join(" × ")],
    ["spacing", unit && unit !== "unknown" ? `${steps} ${unit}` : steps],
    ["inside", compact(inside)],
  ];
  if (frame) found.push(["frame", frame]);
  if (volume.range) found.push(["values", volume.range.map(compact).join(" … ")]);
  if (selected) found.push(["chosen", selected]);
  return found;
}

/** Labels with their colours and counts where the volume has some, else a threshold. */
function selection(session: Session): HTMLElement {
  const body = el("div");
  const choice = bodySwitch(session);
  const panel = section("Inside", choice, body);
  let shown: Volume | undefined;
  let list: LabelList | undefined;
  const show = (): void => {
    const volume = session.volumes.get("a");
    // Whoever asked for several labels where there are none must be able to take that back.
    const several = showsSeveral(session.store.state);
    panel.hidden = !volume || (!labelled(volume) && !volume.range && !several);
    if (!volume || panel.hidden) return;
    choice.hidden = !labelled(volume) && !several;
    list?.refresh();
    if (sameChoice(shown, volume)) return;
    shown = volume;
    list = labelled(volume) ? labelList(session, volume) : undefined;
    body.replaceChildren(...(list?.elements ?? []), ...threshold(session, volume));
  };
  session.store.watch(["settings", "active", "hidden"], show);
  session.on("volumes", show);
  show();
  return panel;
}

function sameChoice(a: Volume | undefined, b: Volume): boolean {
  const key = (volume?: Volume): string => JSON.stringify([volume?.name, volume?.dims, volume?.labels, volume?.range]);
  return key(a) === key(b);
}

const labelled = ({ labels: there }: Volume): boolean => (there?.length ?? 0) > 0;

function threshold(session: Session, { range }: Volume): HTMLElement[] {
  const [low, high] = range ?? [0, 1];
  if (high - low <= 1 && Number.isInteger(low) && Number.isInteger(high)) return [];
  let timer: ReturnType<typeof setTimeout>;
  const control = slider("Threshold: inside is above", { min: low, max: high, step: "any" }, (value) => {
    const text = String(Number(value.toPrecision(4)));
    control.set(value, text);
    clearTimeout(timer);
    timer = setTimeout(() => {
      session.store.set({ threshold: text, labels: "" });
      void session.change("select", { slot: "a", threshold: Number(text) });
    }, 150);
  });
  const now = Number(session.store.state.threshold || low);
  control.set(now, compact(now));
  return [field("Above", control.element, "Inside are the voxels with a value above this")];
}

/** A second volume, Boolean operations, and offsets. */
function together(session: Session): HTMLElement {
  const { store } = session;
  const second = el("input", { type: "text", placeholder: "path, or demo:ball:64", spellcheck: false });
  second.setAttribute("aria-label", "The second volume, B: a path or demo:NAME:SIZE");
  second.value = store.state.second;
  const opening = (): void => {
    if (second.value.trim()) void open(session, "b", second.value.trim());
  };
  second.addEventListener("keydown", (event) => event.key === "Enter" && opening());
  const signs = { union: "A ∪ B", intersect: "A ∩ B", subtract: "A ∖ B", xor: "A ⊕ B" };
  const operations = Object.entries(signs).map(([operation, sign]) =>
    button(sign, () => void combine(session, operation), operation),
  );
  const by = el("input", { type: "number", step: 0.5, value: "1", title: "Distance in the unit of the file" });
  by.setAttribute("aria-label", "Distance of the offset");
  const offset = button("Offset", () => void grow(session, Number(by.value)), "Grow by this distance, or shrink where negative");
  const slots = el("span", { className: "segmented", role: "group", "aria-label": "The volume shown" });
  const show = (): void => {
    const there = (["a", "b", "c"] as const).filter((slot) => session.volumes.has(slot));
    const names = { a: "A", b: "B", c: "Result" };
    slots.replaceChildren(
      ...there.map((slot) => {
        const chosen = button(names[slot], () => session.look(slot), session.volumes.get(slot)?.name);
        chosen.setAttribute("aria-pressed", String(slot === session.slot));
        return chosen;
      }),
    );
    slots.hidden = there.length < 2;
    for (const operation of operations) operation.disabled = !session.volumes.has("a") || !session.volumes.has("b");
    offset.disabled = !session.volume;
  };
  session.on("volumes", show);
  show();
  return section(
    "Two volumes",
    row(el("span", { className: "grow" }, second), button("Open B", opening)),
    row(...operations),
    row(offset, by, el("span", { className: "quiet" }, "− shrinks")),
    slots,
  );
}

async function combine(session: Session, operation: string): Promise<void> {
  await toResult(session, "combine", { operation, a: "a", b: "b", into: "c" });
}

async function grow(session: Session, by: number): Promise<void> {
  await toResult(session, "offset", { slot: session.slot, by, into: "c" });
}

async function toResult(session: Session, name: string, fields: Record<string, unknown>): Promise<void> {
  const answer = await session.attempt(() => session.request<{ volume: Volume }>(name, fields));
  if (!answer) return;
  session.slot = "c";
  session.took(answer.volume);
}
