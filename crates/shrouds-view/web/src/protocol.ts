// What the messages of the server hold. docs/test-bed.md describes them.

export interface Choice {
  default: string | number | null;
  help: string;
  /** Where it stands among the others. */
  order?: number;
  values?: { value: string; help: string }[];
  range?: [number, number];
  /** Takes other values too. */
  text?: boolean;
  /** Has no value: given or not. */
  flag?: boolean;
  /** Interfaces of several labels have it, too. */
  materials?: boolean;
}

/** What `open` reads. */
export type Source = { demo: string; size?: number } | { path: string } | { upload: string };

export interface Hello {
  version: string;
  choices: Record<string, Choice>;
  energies: { name: string; arguments: string; summary: string }[];
  parameters: string[];
  fields: { name: string; help: string }[];
  formats: string[];
  demos: { name: string; size: number }[];
  /** Names of examples of sonar scenes. */
  scenes: string[];
  input: Source | null;
}

export interface Label {
  value: number;
  name?: string | null;
  count: number;
  colour: string;
}

export interface Volume {
  slot: Slot;
  name: string;
  dims: [number, number, number];
  spacing: [number, number, number];
  /** Index to world, four rows of four. */
  affine: number[] | number[][] | null;
  frame: string;
  unit: string | null;
  inside: number;
  labels: Label[] | null;
  range: [number, number] | null;
  /** What is inside, in words. */
  selected: string;
  warnings: string[];
}

export type Slot = "a" | "b" | "c";

export interface Surface {
  view: number;
  revision: number;
  /** Sizes of interfaces are known when they are made. */
  vertices: number | null;
  triangles: number | null;
  components: number | null;
  /** Of the start; unknown where it has followed a change of the volume. */
  energy: number | null;
  /** Whether what a change of the volume reaches is solved already. */
  followed: boolean;
  /** Of interfaces between several labels: the background and the labels that are chosen, ascending. */
  materials?: number[];
}

export type SolverState = "running" | "paused" | "done" | "cancelled";

export interface SolverEvent {
  view: number;
  /** Of interfaces, which nobody waits for. */
  revision?: number;
  state: SolverState;
  status: string | null;
  iteration: number;
  energy: number | null;
  gradient: number | null;
  largest_move: number | null;
  /** What the stop rule looks at, and where it stops. */
  change: number | null;
  tolerance: number | null;
  seconds: number;
  share: number | null;
  /** When the solver handed out its positions, in milliseconds since 1970. */
  at?: number;
}

/** The bytes of a packed file with so many bits for each vertex. */
export interface SizeEvent {
  view: number;
  revision: number;
  bits: number;
  bytes: number;
  share: number;
}

export interface Numbers {
  volume: number | null;
  area: number;
  wrong_side: number;
  manifold: boolean;
  components: number;
  roughness: number | null;
  times: Record<string, number>;
  vertices: number;
  triangles: number;
  materials?: Materials;
}

/** What is known of the interfaces between several labels, in world units. */
export interface Materials {
  crossings: number;
  /** Points, and edges between them, where three or more labels meet. */
  junctions: number;
  junction_lines: number;
  labels: LabelNumbers[];
  contacts: Contact[];
}

export interface LabelNumbers {
  label: number;
  name: string;
  voxels: number;
  voxel_volume: number;
  volume: number;
  area: number;
  triangles: number;
  components: number;
  /** Lattice points outside their label's boundary or inside that of another. */
  wrong_label: number;
}

/** Where two labels touch. */
export interface Contact {
  labels: [number, number];
  triangles: number;
  area: number;
}

export interface Picked {
  /** The axis of the grid edge and its two ends, in voxel indices. */
  edge: { axis: number; inside: [number, number, number]; outside: [number, number, number] };
  delta: number;
  /** In lattice coordinates, and in those of the file. */
  position: [number, number, number];
  world: [number, number, number];
  normal: [number, number, number];
  neighbours: (number | null)[];
  /** On either curve. */
  rho: (number | null)[];
  curvature: Record<string, number>;
}

export interface Colouring {
  low: number;
  high: number;
  unit?: string | null;
  legend: [number, string][];
}
