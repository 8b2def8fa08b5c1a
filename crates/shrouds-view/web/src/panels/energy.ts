// The energy as a sum of measures with weights, each term a line.

import { button, el, field, row, select } from "../dom.ts";
import { energyText, terms, type Term } from "../energy.ts";
import type { Session } from "../session.ts";

export function energyEditor(session: Session): HTMLElement[] {
  const { store, hello } = session;
  const lines = el("div", { className: "body", role: "group", "aria-label": "Terms of the energy" });
  lines.style.padding = "0";
  const text = el("input", { type: "text", spellcheck: false, placeholder: "bending (as the preset has it)" });
  const choose = (sum: readonly Term[]): void => setText(energyText(sum));
  const setText = (value: string): void =>
    store.choose(store.state.active, "energy", value.trim() || undefined);
  text.addEventListener("change", () => setText(text.value));

  const show = (): void => {
    const value = store.state.settings[store.state.active]?.energy ?? "";
    if (document.activeElement !== text) text.value = value;
    const sum = terms(value || "bending");
    // A line that is being typed into is left alone.
    if (!sum || lines.contains(document.activeElement)) return;
    lines.replaceChildren(...sum.map((_, index) => line(sum, index)));
  };
  const changed = (sum: readonly Term[]): void => {
    (document.activeElement as HTMLElement | null)?.blur();
    choose(sum);
  };

  const line = (sum: Term[], index: number): HTMLElement => {
    const term = sum[index]!;
    const entry = hello.energies.find(({ name }) => name === term.measure);
    const other = (change: Partial<Term>): void =>
      changed(sum.map((old, at) => (at === index ? { ...old, ...change } : old)));
    const weight = el("input", { type: "number", min: 0, step: 0.1, value: String(term.weight), title: "Weight" });
    weight.setAttribute("aria-label", `Weight of ${term.measure}`);
    weight.addEventListener("change", () => other({ weight: Number(weight.value) || 1 }));
    const measures = hello.energies.map(({ name, summary }) => ({ value: name, help: summary }));
    const measure = select(measures, (value) => other({ measure: value, arguments: "" }));
    measure.value = term.measure;
    measure.title = entry?.summary ?? "";
    measure.setAttribute("aria-label", `Measure ${index + 1}`);
    const remove = button("×", () => changed(sum.filter((_, at) => at !== index)), `Remove ${term.measure}`, "plain");
    remove.disabled = sum.length === 1;
    return el("div", { className: "term" }, weight, measure, remove, entry?.arguments ? inner(term, entry.arguments, other) : undefined);
  };

  const add = button("+ add a measure", () => {
    const sum = terms(store.state.settings[store.state.active]?.energy ?? "bending") ?? [];
    const free = hello.energies.find(({ name }) => !sum.some(({ measure }) => measure === name));
    if (free) changed([...sum, { weight: 0.3, measure: free.name, arguments: "" }]);
  }, "Another measure with a weight of its own");
  store.watch(["settings", "active"], show);
  show();
  return [lines, row(add), field("as text", text, "Measures with weights, such as bending+0.3*variation")];
}

function inner(term: Term, pattern: string, other: (change: Partial<Term>) => void): HTMLElement {
  const input = el("input", { type: "text", className: "inner", value: term.arguments, placeholder: pattern, title: pattern });
  input.setAttribute("aria-label", `Arguments of ${term.measure}`);
  input.addEventListener("change", () => other({ arguments: input.value.trim() }));
  return input;
}
