// What is known of one view.

import type { Numbers, SolverState, Surface } from "./protocol.ts";
import type { Settings } from "./state.ts";

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
  /** Bytes of the packed file by bits for each vertex, as far as they are known, and whether more will come. */
  sizes: Readonly<Record<string, number>>;
  packing: boolean;
  /** When the solver had the newest positions, and how long the last ones took from there to the graphics card, in
   * milliseconds. */
  at: number;
  way: number | null;
  /** Nothing more comes of this surface until it is asked for. */
  settled: boolean;
  /** Goes back to the start: what the solver still says is not of interest. */
  resetting: boolean;
}

/** Settings as the program wants them: those without a value are true. */
export function typed(settings: Settings): Record<string, string | true> {
  const entries = Object.entries(settings).map(([name, value]) => [name, value === "true" ? true : value]);
  return Object.fromEntries(entries) as Record<string, string | true>;
}

/** The first point of the plots. */
export function startOf({ energy }: Surface): Sample[] {
  return [{ iteration: 0, energy, gradient: null, move: null, change: null }];
}

/** What is not known of a surface in motion. */
export const unknown = { numbers: undefined, sizes: {}, packing: false } as const;

export function emptyView(index: number): View {
  return {
    index,
    state: "empty",
    status: "",
    iteration: 0,
    seconds: 0,
    history: [],
    problem: "",
    ...unknown,
    at: 0,
    way: null,
    settled: false,
    resetting: false,
  };
}
