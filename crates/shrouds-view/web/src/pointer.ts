// The pointer on the picture: picks a vertex where it clicks, and draws with the brush.

import { MOUSE } from "three";
import { latest } from "./latest.ts";
import type { Hit, Stage } from "./scene/stage.ts";
import type { Session } from "./session.ts";

/** A pointer that moved further, in pixels, did not click. */
const STILL = 4;

export function pointer(canvas: HTMLCanvasElement, session: Session, stage: Stage, pick: (hit: Hit) => void): void {
  const { store } = session;
  let down: [number, number] | undefined;
  let painting = false;
  // One dab for each place where the pointer was, however long it stays there.
  let due = false;
  let at: [number, number] = [0, 0];
  const place = (event: PointerEvent): [number, number] => {
    const { left, top } = canvas.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  };
  const hover = latest(async () => {
    await new Promise(requestAnimationFrame);
    const hit = store.state.brush ? stage.hit(...at) : undefined;
    stage.setBrush(hit?.place, store.state.brushRadius, store.state.brushAdds);
    const wanted = due;
    due = false;
    if (hit && wanted) await dab(session, hit);
  });
  canvas.addEventListener("pointerdown", (event) => {
    at = down = place(event);
    const active = stage.paneAt(...at);
    if (active >= 0) store.set({ active });
    painting = due = store.state.brush && event.button === 0;
    if (!painting) return;
    session.beginStroke();
    void hover();
  });
  canvas.addEventListener("pointermove", (event) => {
    at = place(event);
    due ||= painting;
    if (store.state.brush && (painting || event.buttons === 0)) void hover();
  });
  canvas.addEventListener("pointerup", (event) => {
    const [x, y] = place(event);
    const still = down && Math.hypot(x - down[0], y - down[1]) < STILL;
    const hit = still && !painting && event.button === 0 ? stage.hit(x, y) : undefined;
    if (hit) pick(hit);
    if (painting) session.endStroke();
    painting = false;
    down = undefined;
  });
  canvas.addEventListener("pointerleave", () => stage.setBrush(undefined, 0, true));
  const buttons = (): void => {
    const { brush } = store.state;
    stage.camera.controls.mouseButtons.LEFT = brush ? null : MOUSE.ROTATE;
    stage.camera.controls.mouseButtons.RIGHT = brush ? MOUSE.ROTATE : MOUSE.PAN;
    canvas.style.cursor = brush ? "crosshair" : "";
    if (!brush) stage.setBrush(undefined, 0, true);
  };
  store.watch(["brush"], buttons);
  buttons();
}

/** Adds or removes the voxels of a ball. */
async function dab(session: Session, { place }: Hit): Promise<void> {
  const { volume, store } = session;
  if (!volume) return;
  const centre = place.map((value, axis) => value / (volume.spacing[axis] ?? 1));
  await session.edit("brush", { add: store.state.brushAdds, centre, radius: store.state.brushRadius });
}
