// The state as the last part of an address, readable and short: what is as it was at first is left out.

import { MOST_VIEWS, initial, type Settings, type State } from "./state.ts";

/** Settings of a view stand as `energy=…` for the first, `2.energy=…` for the second and so on. */
const SETTING = /^(?:([2-9])\.)?([a-z-]+)$/;
const choices: Partial<Record<keyof State, readonly string[]>> = {
  contours: ["", "x", "y", "z"],
  slice: ["", "x", "y", "z"],
  clip: ["", "x", "y", "z"],
  theme: ["auto", "light", "dark"],
};
const ranges: Partial<Record<keyof State, readonly [number, number]>> = {
  views: [1, MOST_VIEWS],
  active: [0, MOST_VIEWS - 1],
  every: [0.1, 1000],
  sliceAt: [0, 1],
  wipeAt: [0, 1],
  clipAt: [0, 1],
  brushRadius: [0, 64],
};

/** The text after `#`. */
export function toAddress(state: State): string {
  const parts: string[] = [];
  for (const name of names()) {
    const value = state[name];
    if (value !== initial[name]) parts.push(`${kebab(name)}=${escaped(String(value))}`);
  }
  state.settings.slice(0, state.views).forEach((settings, view) => {
    const prefix = view === 0 ? "" : `${view + 1}.`;
    for (const [name, value] of Object.entries(settings)) {
      parts.push(`${prefix}${settingName(name)}=${escaped(value)}`);
    }
  });
  return parts.join("&");
}

/** The state of such a text. What it does not know or cannot read stays as it is at first. */
export function fromAddress(text: string): State {
  const read: Record<string, unknown> = {};
  const settings: Settings[] = initial.settings.map(() => ({}));
  for (const part of text.replace(/^#/, "").split("&")) {
    const at = part.indexOf("=");
    if (at < 1) continue;
    const key = part.slice(0, at);
    const value = unescaped(part.slice(at + 1));
    const name = names().find((known) => kebab(known) === key);
    if (name) read[name] = parsed(name, value) ?? initial[name];
    else setting(settings, key, value);
  }
  const state = { ...initial, ...read, settings } as State;
  return { ...state, active: Math.min(state.active, state.views - 1) };
}

function setting(settings: Settings[], key: string, value: string): void {
  const match = SETTING.exec(key);
  const view = Number(match?.[1] ?? 1) - 1;
  const name = match?.[2];
  if (name === undefined || view >= MOST_VIEWS) return;
  settings[view] = { ...settings[view], [OWN_NAMES.has(name) ? name.slice(4) : name]: value };
}

/** Names that settings share with the page's own parts of the state get a prefix: `set-colours`. */
const OWN_NAMES = new Set<string>();
function settingName(name: string): string {
  return OWN_NAMES.has(`set-${name}`) ? `set-${name}` : name;
}

type Name = Exclude<keyof State, "settings">;

function names(): Name[] {
  return Object.keys(initial).filter((name): name is Name => name !== "settings");
}
for (const name of names()) OWN_NAMES.add(`set-${kebab(name)}`);

function parsed(name: Name, value: string): unknown {
  switch (typeof initial[name]) {
    case "boolean":
      return value === "true";
    case "number":
      return within(Number(value), ranges[name]);
    default:
      return choices[name]?.includes(value) === false ? undefined : value;
  }
}

function within(value: number, range: readonly [number, number] | undefined): number | undefined {
  if (!Number.isFinite(value)) return undefined;
  return range ? Math.min(Math.max(value, range[0]), range[1]) : value;
}

function kebab(name: string): string {
  return name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
}

/** Characters that are legal after `#` stay as they are, so that people can read and write them. */
function escaped(value: string): string {
  return encodeURIComponent(value).replace(/%(2C|3A|2F|3B|40)/g, (code) => decodeURIComponent(code));
}

function unescaped(value: string): string {
  try {
    return decodeURIComponent(value);
  } catch {
    return value;
  }
}
