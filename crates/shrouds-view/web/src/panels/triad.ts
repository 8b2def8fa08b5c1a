// Where the axes of the volume point, in the colours of the network.

import { el } from "../dom.ts";
import type { Stage } from "../scene/stage.ts";
import { axes } from "../state.ts";

const SIZE = 64;
const LENGTH = 20;
const SPACE = "http://www.w3.org/2000/svg";

export function triad(stage: Stage): HTMLElement {
  const svg = document.createElementNS(SPACE, "svg");
  svg.setAttribute("viewBox", `${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`);
  const arms = axes.map((axis) => {
    const line = document.createElementNS(SPACE, "line");
    const text = document.createElementNS(SPACE, "text");
    text.textContent = axis;
    const arm = document.createElementNS(SPACE, "g");
    arm.setAttribute("class", `arm ${axis}`);
    arm.append(line, text);
    svg.append(arm);
    return { arm, line, text };
  });
  stage.onDraw(() => {
    const directions = stage.axisDirections();
    arms.forEach(({ arm, line, text }, axis) => {
      const [right = 0, up = 0, near = 0] = directions[axis] ?? [];
      line.setAttribute("x2", String(LENGTH * right));
      line.setAttribute("y2", String(-LENGTH * up));
      text.setAttribute("x", String((LENGTH + 7) * right));
      text.setAttribute("y", String(-(LENGTH + 7) * up + 3.5));
      arm.setAttribute("opacity", near < -0.2 ? "0.55" : "1");
    });
  });
  const box = el("div", { className: "triad", "aria-hidden": "true" });
  box.append(svg);
  return box;
}
