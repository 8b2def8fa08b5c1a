// Asks for what is shown beside the surfaces, when it is wanted and when what it shows has changed.

import type { Lines, Plane, Points, Values } from "./frames.ts";
import { latest } from "./latest.ts";
import type { Colouring } from "./protocol.ts";
import type { Stage } from "./scene/stage.ts";
import type { Session } from "./session.ts";
import { axes, type Axis } from "./state.ts";

/** How far from the surface lattice points are shown, in voxels. */
const NEAR = 1;
const VOXEL_AXES: Record<Axis, string> = { x: "i", y: "j", z: "k" };

export class Looks {
  /** The colours of the active view. */
  colouring: Colouring | undefined;
  private readonly contours: () => Promise<void>;
  private readonly colours: () => Promise<void>;

  constructor(
    private readonly session: Session,
    private readonly stage: Stage,
    private readonly told: () => void,
  ) {
    const { store } = session;
    this.contours = latest(() => this.eachView((view) => this.contour(view)));
    this.colours = latest(() => this.eachView((view) => this.colour(view)));
    const points = latest(() => this.points());
    const slice = latest(() => this.slice());
    store.watch(["contours", "every"], () => void this.contours());
    store.watch(["colours"], () => void this.colours());
    store.watch(["points"], () => void points());
    store.watch(["slice", "sliceAt"], () => void slice());
    session.on("volumes", () => void Promise.all([points(), slice()]));
    session.on("settled", () => void Promise.all([this.contours(), this.colours()]));
    session.on("started", () => this.clear());
  }

  /** What was true of places that the vertices have left is not shown. */
  private clear(): void {
    for (const { index, settled } of this.session.views) {
      if (settled) continue;
      this.stage.setContours(index, undefined);
      this.stage.setColours(index, undefined);
    }
  }

  /** Interfaces of several labels have neither contours nor numbers at their vertices. */
  private async eachView(work: (view: number) => Promise<void>): Promise<void> {
    for (let view = 0; view < this.session.store.state.views; view++) {
      const { settled, surface } = this.session.views[view] ?? {};
      if (settled && !surface?.materials) await this.session.attempt(() => work(view));
    }
  }

  private async contour(view: number): Promise<void> {
    const { contours, every } = this.session.store.state;
    if (contours === "") return this.stage.setContours(view, undefined);
    const fields = { view, axis: VOXEL_AXES[contours], every };
    const { frame } = await this.session.framed<unknown, Lines>("contours", fields);
    if (this.session.views[view]?.settled) this.stage.setContours(view, frame);
  }

  /** All views have the range of the first, so that they can be compared. */
  private async colour(view: number): Promise<void> {
    const field = this.session.store.state.colours;
    if (field === "") {
      this.colouring = undefined;
      this.stage.setColours(view, undefined);
      return this.told();
    }
    const { low, high } = this.colouring ?? {};
    const range = view > 0 && low !== undefined ? { range: [low, high] } : {};
    const fields = { view, field, ...range };
    const { ok, frame } = await this.session.framed<Colouring, Values>("colours", fields);
    if (!this.session.views[view]?.settled) return;
    if (view === 0) this.colouring = ok;
    this.stage.setColours(view, frame.values, ok);
    this.told();
  }

  private async points(): Promise<void> {
    const { slot, volume, store } = this.session;
    if (!store.state.points || !volume) return this.stage.setOther("points", undefined);
    const fields = { slot, near: NEAR };
    const answer = await this.session.attempt(() => this.session.framed<unknown, Points>("points", fields));
    this.stage.setOther("points", answer?.frame);
  }

  private async slice(): Promise<void> {
    const { slot, volume, store } = this.session;
    const { slice, sliceAt } = store.state;
    if (slice === "" || !volume) return this.stage.setOther("slice", undefined);
    const size = volume.dims[axes.indexOf(slice)] ?? 1;
    const fields = { slot, axis: slice, index: Math.round(sliceAt * (size - 1)) };
    const answer = await this.session.attempt(() => this.session.framed<unknown, Plane>("slice", fields));
    this.stage.setOther("slice", answer?.frame);
  }
}
