// One visit: the volumes, the views and their solvers, as the program tells of them.

import { Connection, type Framed } from "./connection.ts";
import type { Answer, Frame } from "./frames.ts";
import type { Hello, Numbers, Slot, SolverEvent, SolverState, Source, Surface, Volume } from "./protocol.ts";
import { MOST_VIEWS, type Settings, type Store } from "./state.ts";

/** One point of the plots. */
export interface Sample {
  iteration: number;
  energy: number | null;
  gradient: number | null;
  move: number | null;
  change: number | null;
}

export interface View {
  readonly index: number;
  surface?: Surface;
  state: SolverState | "empty" | "waiting";
  status: string;
  iteration: number;
  seconds: number;
  history: Sample[];
  /** The message of the last request that failed. */
  problem: string;
  numbers?: Numbers | undefined;
  /** Nothing more comes of this surface until it is asked for. */
  settled: boolean;
  /** Goes back to the start: what the solver still says is not of interest. */
  resetting: boolean;
}

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
/** Larger surfaces are packed, to tell how small they become, only when that is asked for. */
const MOST_PACKED = 30_000;

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

  private constructor(
    readonly store: Store,
    private readonly screen: Screen,
  ) {}

  private connection!: Connection;

  /** Says hello. */
  static async start(socket: WebSocket, store: Store, screen: Screen): Promise<Session> {
    const session = new Session(store, screen);
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
    const opened = await this.attempt(() => this.request<Holding>("open", { slot, source }));
    const chosen =
      opened && select && (await this.attempt(() => this.request<Holding>("select", { slot, ...select })));
    this.working();
    if (opened) this.took((chosen || opened).volume);
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

  /** Brush, undo and redo: the volume changes, and its surfaces follow by themselves. */
  async edit(name: "brush" | "undo" | "redo", fields: Record<string, unknown> = {}): Promise<void> {
    const edited = await this.attempt(() => this.request<Edited>(name, { slot: this.slot, ...fields }));
    if (!edited) return;
    this.took(edited.volume, false);
    for (const surface of edited.surfaces) {
      const model = this.views[surface.view];
      const anew = { ...emptyView(surface.view), surface, state: "paused", history: startOf(surface) };
      if (model) Object.assign(model, anew);
    }
    this.tell("started");
    this.tell("views");
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

  shroudAll(): void {
    for (let view = 0; view < this.store.state.views; view++) void this.shroud(view);
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

  /** A new surface with the settings of the view, and a run if everything is live. */
  async shroud(view: number): Promise<void> {
    const model = this.views[view];
    if (!model || !this.volume) return;
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
      if (this.store.state.live) await this.control(view, "run");
      else await this.settle(view);
    } catch (error) {
      if (this.generations[view] !== generation) return;
      model.state = "empty";
      model.problem = (error as Error).message;
      this.screen.forget(view);
      this.tell("views");
    }
  }

  /** Run, step, pause, reset or cancel. */
  async control(view: number, what: "run" | "step" | "pause" | "reset" | "cancel"): Promise<void> {
    const model = this.views[view];
    if (!model?.surface) return;
    if (what === "run" || what === "step") Object.assign(model, { settled: false, problem: "", numbers: undefined });
    const anew = what === "reset" || (what !== "pause" && ["done", "cancelled"].includes(model.state));
    if (anew && what !== "cancel") Object.assign(model, { history: startOf(model.surface), iteration: 0 });
    if (what === "reset") {
      const start = { state: "paused", status: "", numbers: undefined, settled: false, resetting: true };
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
    this.screen.show(frame, () => {
      if (frame.kind === "delta") {
        this.connection.acknowledge(frame.view, frame.revision, model.iteration);
      }
    });
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
    const { iteration, energy, gradient, largest_move: move, change } = event;
    Object.assign(model, {
      state: event.state,
      status: event.status ?? "",
      iteration,
      seconds: event.seconds,
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
    await this.measure(view, false);
    if ((model.surface?.vertices ?? 0) < MOST_PACKED) await this.measure(view, true);
  }

  /** Asks for the numbers of a surface at rest; with the sizes when packed it can take a while. */
  async measure(view: number, bits: boolean): Promise<void> {
    const model = this.views[view];
    if (!model?.settled) return;
    const revision = model.surface?.revision;
    const numbers = await this.attempt(() => this.request<Numbers>("numbers", { view, bits }));
    if (!numbers || !model.settled || model.surface?.revision !== revision) return;
    model.numbers = numbers;
    this.tell("numbers");
  }
}

/** Settings as the program wants them: those without a value are true. */
function typed(settings: Settings): Record<string, string | true> {
  const entries = Object.entries(settings).map(([name, value]) => [name, value === "true" ? true : value]);
  return Object.fromEntries(entries) as Record<string, string | true>;
}

/** The first point of the plots. */
function startOf({ energy }: Surface): Sample[] {
  return [{ iteration: 0, energy, gradient: null, move: null, change: null }];
}

function emptyView(index: number): View {
  return {
    index,
    state: "empty",
    status: "",
    iteration: 0,
    seconds: 0,
    history: [],
    problem: "",
    numbers: undefined,
    settled: false,
    resetting: false,
  };
}
