// What there is for one body and not for the interfaces between several labels.

import type { State, Store } from "../state.ts";

export const WHY = "Not for the interfaces of several labels: show one body for it";

/** Whether the active view shows several labels, or is meant to. */
export function showsSeveral({ settings, active }: State): boolean {
  return settings[active]?.materials !== undefined;
}

type Control = HTMLButtonElement | HTMLSelectElement | HTMLInputElement | HTMLFieldSetElement;

/** Switches controls off, with the reason as their title, while the active view shows several labels. */
export function forOneBody(store: Store, ...controls: Control[]): void {
  const titles = controls.map(({ title }) => title);
  const show = (): void => {
    const several = showsSeveral(store.state);
    controls.forEach((control, index) => {
      control.disabled = several;
      control.title = several ? WHY : (titles[index] ?? "");
    });
  };
  store.watch(["settings", "active"], show);
  show();
}
