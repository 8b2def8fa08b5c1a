// What a user has chosen, all of it, and who wants to know when it changes.

export type Axis = "x" | "y" | "z";
export const axes: readonly Axis[] = ["x", "y", "z"];

/** Settings of one view as on the command line, without those left at their defaults. */
export type Settings = Readonly<Record<string, string>>;

export const MOST_VIEWS = 4;

export interface State {
  /** `demo:NAME` or `demo:NAME:SIZE`, or a path; empty before the first. */
  readonly source: string;
  /** The second volume, in slot b. */
  readonly second: string;
  /** Chosen labels with commas between; empty for what the file says. */
  readonly labels: string;
  /** Labels whose boundaries are not shown where there are several, with commas between. */
  readonly hidden: string;
  /** Inside is what lies above this; empty for none. */
  readonly threshold: string;
  readonly views: number;
  readonly active: number;
  readonly settings: readonly Settings[];
  /** Runs whenever something changes. */
  readonly live: boolean;
  readonly smooth: boolean;
  readonly network: boolean;
  readonly contours: Axis | "";
  /** Distance of the contours in voxels. */
  readonly every: number;
  readonly points: boolean;
  readonly slice: Axis | "";
  /** Which slice, as a share of the volume. */
  readonly sliceAt: number;
  /** Numbers shown as colours; empty for none. */
  readonly colours: string;
  readonly wipe: boolean;
  readonly wipeAt: number;
  readonly clip: Axis | "";
  readonly clipAt: number;
  readonly clipBack: boolean;
  readonly parallel: boolean;
  readonly brush: boolean;
  readonly brushAdds: boolean;
  readonly brushRadius: number;
  readonly theme: "auto" | "light" | "dark";
  /** Eye, target and magnification: seven numbers with commas between; empty for all in sight. */
  readonly camera: string;
}

export const initial: State = {
  source: "",
  second: "",
  labels: "",
  hidden: "",
  threshold: "",
  views: 1,
  active: 0,
  settings: Array.from({ length: MOST_VIEWS }, () => ({})),
  live: true,
  smooth: false,
  network: false,
  contours: "",
  every: 4,
  points: false,
  slice: "",
  sliceAt: 0.5,
  colours: "",
  wipe: false,
  wipeAt: 0.5,
  clip: "",
  clipAt: 0.5,
  clipBack: false,
  parallel: false,
  brush: false,
  brushAdds: true,
  brushRadius: 2,
  theme: "auto",
  camera: "",
};

export type Change = Partial<State>;
type Listener = (state: State, changed: ReadonlySet<keyof State>) => void;

/** Holds the state and tells of each change what it changed. */
export class Store {
  private readonly listeners: Listener[] = [];

  constructor(private current: State) {}

  get state(): State {
    return this.current;
  }

  set(change: Change): void {
    const names = Object.keys(change) as (keyof State)[];
    const changed = new Set(names.filter((name) => change[name] !== this.current[name]));
    if (changed.size === 0) return;
    this.current = { ...this.current, ...change };
    for (const listener of this.listeners) listener(this.current, changed);
  }

  /** Another value of one setting of one view; without a value its default again. */
  choose(view: number, name: string, value: string | undefined): void {
    const { [name]: _, ...others } = this.state.settings[view] ?? {};
    const chosen = value === undefined ? others : { ...others, [name]: value };
    this.set({ settings: this.state.settings.map((old, i) => (i === view ? chosen : old)) });
  }

  /** Calls the listener now if asked to, and after each change of one of the names, or of any. */
  watch(names: readonly (keyof State)[], listener: (state: State) => void): void {
    this.listeners.push((state, changed) => {
      if (names.length === 0 || names.some((name) => changed.has(name))) listener(state);
    });
  }
}
