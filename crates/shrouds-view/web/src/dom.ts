// Elements and controls, each with its label.

type Child = Node | string | undefined | false;
type Properties = Record<string, unknown>;

/** An element with properties (`on…` are listeners, names with `-` or unknown ones attributes) and children. */
export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Properties = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
    else if (name in element && !name.includes("-")) (element as unknown as Properties)[name] = value;
    else if (value !== undefined && value !== false) element.setAttribute(name, String(value));
  }
  element.append(...children.filter((child): child is Node | string => child !== undefined && child !== false));
  return element;
}

let lastId = 0;

/** A label before its control. */
export function field(text: string, control: HTMLElement, help = ""): HTMLElement {
  control.id ||= `control-${++lastId}`;
  return el("div", { className: "field", title: help }, el("label", { htmlFor: control.id }, text), control);
}

export function button(text: string, onclick: () => void, title = "", className = ""): HTMLButtonElement {
  return el("button", { type: "button", title, className, onclick }, text);
}

/** A button that is on or off. */
export function toggle(text: string, title: string, onclick: () => void): HTMLButtonElement {
  return el("button", { type: "button", className: "toggle", title, onclick, "aria-pressed": "false" }, text);
}

export function press(toggled: HTMLElement, on: boolean): void {
  toggled.setAttribute("aria-pressed", String(on));
}

export interface Option {
  value: string;
  text?: string;
  help?: string;
}

export function select(options: readonly Option[], onchange: (value: string) => void): HTMLSelectElement {
  const control = el("select", { onchange: () => onchange(control.value) });
  setOptions(control, options);
  return control;
}

export function setOptions(control: HTMLSelectElement, options: readonly Option[]): void {
  const made = options.map(({ value, text, help }) => el("option", { value, title: help ?? "" }, text ?? value));
  control.replaceChildren(...made);
}

/** A slider with its value beside it. */
export interface Slider {
  element: HTMLElement;
  input: HTMLInputElement;
  set(value: number, text?: string): void;
}

export function slider(
  label: string,
  { min, max, step }: { min: number; max: number; step: number | "any" },
  oninput: (value: number) => void,
): Slider {
  const input = el("input", { type: "range", min, max, step, oninput: () => oninput(Number(input.value)) });
  input.setAttribute("aria-label", label);
  const output = el("output");
  return {
    element: el("span", { className: "slider" }, input, output),
    input,
    set(value, text) {
      if (document.activeElement !== input || Number(input.value) !== value) input.value = String(value);
      output.textContent = text ?? compact(value);
    },
  };
}

/** A part of a panel that can be folded away. */
export function section(title: string, ...children: Child[]): HTMLDetailsElement {
  return el("details", { open: true }, el("summary", {}, title), el("div", { className: "body" }, ...children));
}

export function row(...children: Child[]): HTMLElement {
  return el("div", { className: "row" }, ...children);
}

/** Few digits, but never wrong ones: 12 345, 1.234, 1.2e-7. */
export function compact(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return value.toLocaleString("en").replaceAll(",", "\u202f");
  const size = Math.abs(value);
  if (size >= 1e6 || (size > 0 && size < 1e-3)) return value.toExponential(2).replace("e+", "e");
  return String(Number(value.toPrecision(4)));
}

/** Bytes in three digits: 259, 1.45k, 22k. */
export function bytes(value: number): string {
  const power = value < 1000 ? 0 : value < 1e6 ? 1 : 2;
  return `${Number((value / 1000 ** power).toPrecision(3))}${["", "k", "M"][power]}`;
}
