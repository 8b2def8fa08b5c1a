// One visit: the volumes, the views and their solvers, as the program tells of them.

import { Connection, type Framed } from "./connection.ts";
import type { Answer, Frame } from "./frames.ts";
import type { Hello, Numbers, SizeEvent, Slot, SolverEvent, Source, Surface, Volume } from "./protocol.ts";
import { MOST_VIEWS, type Store } from "./state.ts";
import { emptyView, startOf, typed, unknown, type View } from "./view.ts";

/** What has changed. */
export type Topic = "volumes" | "views" | "solver" | "started" | "settled" | "numbers" | "work" | "messages" | "rows";

export interface Message {
  level: "info" | "warning" | "error";
  text: string;
}

/** Work without a known end is shown without a share. */
export interface Work {
  stage: string;
  share: number | null;
}

/** Shows what comes in binary frames. */
export interface Screen {
  show(frame: Frame, drawn: () => void): void;
  /** Another surface will come for the view. */
  forget(view: number): void;
}

interface Holding {
  volume: Volume;
}

interface Edited extends Holding {
  changed: number;
  surfaces: Surface[];
}

const RUN_DELAY = 120;
/** Solvers wait for the first picture, but no longer than this where none is drawn, in milliseconds. */
const MOST_WAIT = 500;
/** Larger surfaces are packed, to tell how small they become, only when that is asked for. */
const MOST_PACKED = 300_000;

export class Session {
  hello!: Hello;
  readonly volumes = new Map<Slot, Volume>();
  readonly views: View[] = Array.from({ length: MOST_VIEWS }, (_, index) => emptyView(index));
  readonly messages: Message[] = [];
  readonly rows: Record<string, unknown>[] = [];
  work: Work | undefined;
  private said = 0;
  private readonly listeners: [Topic, () => void][] = [];
  private readonly timers = new Map<number, ReturnType<typeof setTimeout>>();
  private readonly generations = Array<number>(MOST_VIEWS).fill(0);
  private readonly pictured = new Map<number, () => void>();
  /** Strokes of the brush so far, whether one goes on, and the views that changed since the last rest. */
  private strokes = 0;
  private painting = false;
  private readonly restless = new Set<number>();
  /** Where frames are shown. */
  screen!: Screen;

  private constructor(readonly store: Store) {}

  private connection!: Connection;

  /** Says hello. */
  static async start(socket: WebSocket, store: Store): Promise<Session> {
    const session = new Session(store);
    session.connection = await Connection.open(socket, {
      event: (name, event) => session.event(name, event),
      frame: (frame) => session.frame(frame),
      closed: (reason) => session.say("error", `${reason} Reload the page to go on: the address keeps your choices.`),
      broken: (error) => session.say("error", `The program sent what this page cannot read: ${error.message}`),
    });
    session.hello = await session.request<Hello>("hello");
    return session;
  }

  on(topic: Topic, listener: () => void): void {
    this.listeners.push([topic, listener]);
  }

  request<T>(name: string, fields: Record<string, unknown> = {}): Promise<T> {
    return this.connection.request<T>(name, fields).finally(() => this.work && this.working());
  }

  framed<T, F extends Answer>(name: string, fields: Record<string, unknown>): Promise<Framed<T, F>> {
    return this.connection.framedRequest<T, F>(name, fields).finally(() => this.work && this.working());
  }

  say(level: Message["level"], text: string): void {
    // Views that fail alike say so once.
    const now = performance.now();
    if (text === this.messages.at(-1)?.text && now - this.said < 2000) return;
    this.said = now;
    this.messages.push({ level, text });
    if (this.messages.length > 50) this.messages.shift();
    this.tell("messages");
  }

  /** Does it; what goes wrong is said to the user and nothing else. */
  async attempt<T>(doing: () => Promise<T>): Promise<T | undefined> {
    try {
      return await doing();
    } catch (error) {
      this.say("error", (error as Error).message);
      return undefined;
    }
  }

  /** Shows what is being done; nothing when it is done. */
  working(stage?: string, share: number | null = null): void {
    this.work = stage === undefined ? undefined : { stage, share };
    this.tell("work");
  }

  /** Reads a volume into a slot, and shrouds it anew in all views if it is the first slot's. */
  async open(slot: Slot, source: Source, select?: Record<string, unknown>): Promise<void> {
    this.working("opening");
    const opening = this.attempt(() => this.request<Holding>("open", { slot, source }));
    // The program does one after the other: surfaces need not wait for its answer.
    const early = slot === this.slot && !select;
    if (early) this.shroudAll(opening);
    const opened = await opening;
    const chosen =
      opened && select && (await this.attempt(() => this.request<Holding>("select", { slot, ...select })));
    this.working();
    if (opened) this.took((chosen || opened).volume, !early);
  }

  /** Another choice of labels or of a threshold, or an operation: whatever answers with a volume. */
  async change(name: string, fields: Record<string, unknown>): Promise<void> {
    const answer = await this.attempt(() => this.request<Holding>(name, fields));
    if (answer) this.took(answer.volume);
  }

  /** A volume as it is now. The views show the first slot. */
  took(volume: Volume, again = true): void {
    this.volumes.set(volume.slot, volume);
    for (const warning of volume.warnings ?? []) this.say("warning", warning);
    this.tell("volumes");
    if (again && volume.slot === this.slot) this.shroudAll();
  }

  /** The dabs that come are of one stroke, which is taken back as a whole. */
  beginStroke(): void {
    this.strokes++;
    this.painting = true;
  }

  endStroke(): void {
    this.painting = false;
    this.rest();
  }

  /** Brush, undo and redo: the volume changes, and its surfaces follow where the change reaches if all is live. */
  async edit(name: "brush" | "undo" | "redo", fields: Record<string, unknown> = {}): Promise<void> {
    const { live } = this.store.state;
    const all = { slot: this.slot, follow: live, ...(name === "brush" && { stroke: this.strokes }), ...fields };
    const edited = await this.attempt(() => this.request<Edited>(name, all));
    if (!edited) return;
    this.took(edited.volume, false);
    for (const surface of edited.surfaces) {
      const model = this.views[surface.view];
      const anew = { ...emptyView(surface.view), surface, state: "paused", history: startOf(surface) };
      if (model) Object.assign(model, anew);
      this.restless.add(surface.view);
    }
    this.tell("started");
    this.tell("views");
    for (const { view, followed } of edited.surfaces) if (live && !followed) this.rest(view);
    if (!this.painting) this.rest();
  }

  /** After changes: solves the surfaces as a whole if all is live, and tells their numbers. */
  private rest(...views: number[]): void {
    for (const view of views.length > 0 ? views : [...this.restless]) {
      this.restless.delete(view);
      void (this.store.state.live ? this.control(view, "run") : this.settle(view));
    }
  }

  /** The slot that the views show. */
  slot: Slot = "a";

  /** Another slot in all views. */
  look(slot: Slot): void {
    this.slot = slot;
    this.tell("volumes");
    this.shroudAll();
  }

  get volume(): Volume | undefined {
    return this.volumes.get(this.slot);
  }

  get active(): View {
    return this.views[this.store.state.active] ?? this.views[0]!;
  }

  shroudAll(opening?: Promise<unknown>): void {
    for (let view = 0; view < this.store.state.views; view++) void this.shroud(view, opening);
  }

  /** A view that is not shown any more stops and is forgotten. */
  drop(view: number): void {
    const model = this.views[view];
    if (!model?.surface) return;
    this.later(view);
    clearTimeout(this.timers.get(view));
    void this.attempt(() => this.request("cancel", { view }));
    Object.assign(model, { ...emptyView(view), surface: undefined });
    this.screen.forget(view);
  }

  /** As `shroud`, when nothing has changed for a moment. */
  shroudSoon(view: number): void {
    clearTimeout(this.timers.get(view));
    this.timers.set(view, setTimeout(() => void this.shroud(view), RUN_DELAY));
  }

  /** A new surface with the settings of the view, of a volume that may still be opening, and a run if everything is live. */
  async shroud(view: number, opening?: Promise<unknown>): Promise<void> {
    const model = this.views[view];
    if (!model || (!this.volume && !opening)) return;
    const generation = this.later(view);
    Object.assign(model, { ...emptyView(view), state: "waiting" as const });
    this.tell("views");
    const settings = typed(this.store.state.settings[view] ?? {});
    try {
      const fields = { view, slot: this.slot, settings };
      const { surface } = await this.request<{ surface: Surface }>("shroud", fields);
      if (this.generations[view] !== generation) return;
      Object.assign(model, { surface, state: "paused", history: startOf(surface) });
      this.working();
      this.tell("views");
      // Of several labels there is nothing to see before the end.
      if (surface.materials) this.screen.forget(view);
      else await this.picture(view);
      if (this.generations[view] !== generation) return;
      if (this.store.state.live) await this.control(view, "run");
      else if (!surface.materials) await this.settle(view);
    } catch (error) {
      if (this.generations[view] !== generation) return;
      model.state = "empty";
      // That a volume could not be opened has been said.
      model.problem = opening && !(await opening) ? "" : (error as Error).message;
      this.screen.forget(view);
      this.tell("views");
    }
  }

  /** Waits until the surface of a view is on the screen. */
  private picture(view: number): Promise<void> {
    return new Promise((resolve) => {
      this.pictured.set(view, resolve);
      setTimeout(resolve, MOST_WAIT);
    });
  }

  /** Run, step, pause, reset or cancel. */
  async control(view: number, what: "run" | "step" | "pause" | "reset" | "cancel"): Promise<void> {
    const model = this.views[view];
    if (!model?.surface) return;
    if (model.surface.materials && what !== "run" && what !== "cancel") {
      return this.say("info", "The interfaces of several labels are made in one piece: run or cancel them.");
    }
    if (what !== "pause") model.packing = false;
    if (what === "run" || what === "step") Object.assign(model, { settled: false, problem: "", ...unknown });
    const anew = what === "reset" || (what !== "pause" && ["done", "cancelled"].includes(model.state));
    if (anew && what !== "cancel") Object.assign(model, { history: startOf(model.surface), iteration: 0 });
    if (what === "reset") {
      const start = { state: "paused", status: "", ...unknown, settled: false, resetting: true };
      Object.assign(model, start);
    }
    this.tell("solver");
    this.tell("started");
    await this.attempt(() => this.request(what, { view }));
  }

  private later(view: number): number {
    this.generations[view] = (this.generations[view] ?? 0) + 1;
    return this.generations[view] ?? 0;
  }

  private tell(topic: Topic): void {
    for (const [asked, listener] of this.listeners) if (asked === topic) listener();
  }

  private frame(frame: Frame): void {
    const model = this.views[frame.view];
    if (!model) return;
    if (frame.kind === "interfaces") {
      const { surface } = model;
      // Those that are on their way when something else is shown are not of interest.
      if (surface?.revision !== frame.revision) return;
      frame.labels = surface.materials ?? [];
    }
    this.screen.show(frame, () => {
      if (frame.kind !== "delta") return;
      this.connection.acknowledge(frame.view, frame.revision, model.iteration);
      this.pictured.get(frame.view)?.();
    });
    if (frame.kind === "delta" && model.state === "running") {
      model.way = performance.timeOrigin + performance.now() - model.at;
    }
  }

  private event(name: string, event: Record<string, unknown>): void {
    switch (name) {
      case "solver":
        return this.solver(event as unknown as SolverEvent);
      case "settled":
        if (this.views[Number(event.view)]?.surface?.revision !== event.revision) return;
        return void this.settle(Number(event.view));
      case "progress":
        return this.working(String(event.stage), (event.share as number | null) ?? null);
      case "message":
        return this.say((event.level as Message["level"]) ?? "info", String(event.text));
      case "size":
        return this.size(event as unknown as SizeEvent);
      case "row":
        this.rows.push((event.row as Record<string, unknown> | undefined) ?? event);
        return this.tell("rows");
      default:
        return;
    }
  }

  private solver(event: SolverEvent): void {
    const model = this.views[event.view];
    if (!model || model.resetting || model.state === "waiting") return;
    if (event.revision !== undefined && event.revision !== model.surface?.revision) return;
    const { iteration, energy, gradient, largest_move: move, change } = event;
    Object.assign(model, {
      state: event.state,
      status: event.status ?? "",
      iteration,
      seconds: event.seconds,
      at: event.at ?? model.at,
    });
    if (energy !== null && energy !== undefined && model.history.at(-1)?.iteration !== iteration) {
      model.history.push({ iteration, energy, gradient, move, change });
    }
    this.tell("solver");
  }

  private async settle(view: number): Promise<void> {
    const model = this.views[view];
    if (!model) return;
    Object.assign(model, { settled: true, resetting: false });
    this.tell("solver");
    this.tell("settled");
    await this.measure(view);
    const { vertices, materials } = model.surface ?? {};
    if (!materials && (vertices ?? 0) < MOST_PACKED) await this.pack(view);
  }

  /** Asks for the numbers of a surface at rest. */
  private async measure(view: number): Promise<void> {
    const model = this.views[view];
    if (!model?.settled) return;
    const revision = model.surface?.revision;
    const numbers = await this.attempt(() => this.request<Numbers>("numbers", { view }));
    if (!numbers || !model.settled || model.surface?.revision !== revision) return;
    model.numbers = numbers;
    this.tell("numbers");
  }

  /** Asks for the sizes of a surface at rest, which come one after the other. */
  async pack(view: number): Promise<void> {
    const model = this.views[view];
    if (!model?.settled) return;
    Object.assign(model, { sizes: {}, packing: true });
    this.tell("numbers");
    await this.attempt(() => this.request("sizes", { view }));
  }

  private size({ view, revision, bits, bytes, share }: SizeEvent): void {
    const model = this.views[view];
    if (!model?.packing || model.surface?.revision !== revision) return;
    Object.assign(model, { sizes: { ...model.sizes, [bits]: bytes }, packing: share < 1 });
    this.tell("numbers");
  }
}
