// The numbers of the interfaces between several labels: each label, and the pairs that touch most.

import { compact, el } from "../dom.ts";
import type { Contact, LabelNumbers, Materials } from "../protocol.ts";
import type { Session } from "../session.ts";

/** Pairs that are listed. */
const LARGEST = 12;

/** The tables of the active view; nothing while it shows no interfaces. */
export function materialsTables(session: Session): HTMLElement {
  const box = el("div", { className: "materials", hidden: true });
  const show = (): void => {
    const materials = session.active.numbers?.materials;
    box.hidden = !materials;
    box.replaceChildren(...(materials ? tables(materials) : []));
  };
  for (const topic of ["views", "solver", "numbers"] as const) session.on(topic, show);
  session.store.watch(["active"], show);
  show();
  return box;
}

function tables(materials: Materials): HTMLElement[] {
  const { crossings, junctions, junction_lines: edges, labels, contacts } = materials;
  const names = new Map(labels.map(({ label, name }) => [label, name || String(label)]));
  const largest = [...contacts].sort((a, b) => b.area - a.area).slice(0, LARGEST);
  const counts = [
    `${compact(labels.length)} labels`,
    `${compact(crossings)} crossings`,
    `${compact(junctions)} junction points`,
    `${compact(edges)} edges of junction lines`,
    `${compact(contacts.length)} contacts`,
  ];
  const labelHeadings = ["label", "voxels", "voxel volume", "volume", "area", "triangles", "parts", "wrong points"];
  const shown = contacts.length > LARGEST ? `largest contacts of ${contacts.length}` : "contact";
  return [
    el("div", { className: "quiet" }, counts.join(" · ")),
    table("Numbers of the labels", labelHeadings, labels.map((one) => labelLine(one, names))),
    table("Largest contacts", [shown, "area", "triangles"], largest.map((one) => contactLine(one, names))),
  ];
}

function table(name: string, headings: readonly string[], lines: HTMLElement[]): HTMLElement {
  const head = el("tr", {}, ...headings.map((text) => el("th", { scope: "col" }, text)));
  return el("table", { "aria-label": name }, el("thead", {}, head), el("tbody", {}, ...lines));
}

function labelLine(one: LabelNumbers, names: ReadonlyMap<number, string>): HTMLElement {
  const { label, voxels, voxel_volume: voxelVolume, volume, area, triangles, components, wrong_label: wrong } = one;
  const numbers = [voxels, voxelVolume, volume, area, triangles, components];
  return el(
    "tr",
    {},
    el("td", { title: String(label) }, names.get(label)),
    ...numbers.map((value) => el("td", {}, compact(value))),
    el("td", { className: wrong === 0 ? "good" : "bad" }, compact(wrong)),
  );
}

function contactLine({ labels: [first, second], area, triangles }: Contact, names: ReadonlyMap<number, string>): HTMLElement {
  const name = (label: number): string => (label === 0 ? "background" : (names.get(label) ?? String(label)));
  return el("tr", {}, ...[`${name(first)} – ${name(second)}`, compact(area), compact(triangles)].map((text) => el("td", {}, text)));
}
