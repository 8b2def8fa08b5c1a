// Messages to the user: errors stay until they are closed, others go by themselves.

import { button, el } from "../dom.ts";
import type { Session } from "../session.ts";

const STAY = 6000;
const MOST = 4;

export function messages(container: HTMLElement, session: Session): void {
  let shown = 0;
  session.on("messages", () => {
    const last = session.messages.at(-1);
    if (!last) return;
    shown++;
    const close = (): void => line.remove();
    const line = el("div", { className: `message ${last.level}` }, el("span", {}, last.text), button("×", close, "Close", "plain"));
    line.dataset.number = String(shown);
    container.append(line);
    while (container.children.length > MOST) container.firstElementChild?.remove();
    if (last.level !== "error") setTimeout(close, STAY);
  });
}
