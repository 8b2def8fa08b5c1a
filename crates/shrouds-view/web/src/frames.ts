// Binary messages of the server: a header of four u32, then arrays, all little-endian.

/** What a frame holds, as its header says. */
export const kinds = [
  "", "topology", "delta", "triangles", "positions", "normals", "scalars", "lines", "points", "image",
  "interfaces",
] as const;

interface Head {
  view: number;
  /** The surface the frame belongs to; for answers to one request, the number of that request. */
  revision: number;
}

/** What is the same for every δ: where the grid edges lie, and who is next to whom. */
export interface Topology extends Head {
  kind: "topology";
  /** x, y, z of the outside end of each vertex's grid edge. */
  outside: Float32Array;
  /** From there to the inside end. */
  along: Float32Array;
  indices: Uint32Array;
  /** Segments of the network, by what their planes lie across: x, y, z. */
  families: [Uint32Array, Uint32Array, Uint32Array];
}

export interface Values extends Head {
  kind: "delta" | "normals" | "scalars";
  values: Float32Array;
}

export interface Triangles extends Head {
  kind: "triangles";
  indices: Uint32Array;
}

/** A mesh with vertices of its own, the dual. */
export interface Positions extends Head {
  kind: "positions";
  positions: Float32Array;
  indices: Uint32Array;
}

export interface Lines extends Head {
  kind: "lines";
  /** Points of each polyline. */
  lengths: Uint32Array;
  points: Float32Array;
}

export interface Points extends Head {
  kind: "points";
  points: Float32Array;
  /** 1 where the point is inside, else 0. */
  inside: Float32Array;
}

export interface Plane extends Head {
  kind: "image";
  width: number;
  height: number;
  /** Centres of the first pixel, of the last of the first row and of the first of the last row. */
  corners: Float32Array;
  pixels: Uint8Array;
}

/** What the triangles of the mesh before lie between. */
export interface Interfaces extends Head {
  kind: "interfaces";
  /** Runs of triangles: the places of both labels in the list of the surface, and how many there are. */
  runs: Uint32Array;
  /** Edges where three or more labels meet, as pairs of vertices. */
  edges: Uint32Array;
  /** That list; no part of the frame, but said by whoever knows the surface. */
  labels: readonly number[];
}

export type Frame = Topology | Values | Triangles | Positions | Lines | Points | Plane | Interfaces;
export type Answer = Values | Lines | Points | Plane;

const HEADER = 16;

/** Reads a buffer from front to back and refuses to read beyond its end. */
class Reader {
  private at = HEADER;

  constructor(private readonly buffer: ArrayBuffer) {}

  get rest(): number {
    return this.buffer.byteLength - this.at;
  }

  numbers(count: number): Uint32Array {
    return new Uint32Array(this.buffer, this.take(count, 4), count);
  }

  floats(count: number): Float32Array {
    return new Float32Array(this.buffer, this.take(count, 4), count);
  }

  bytes(count: number): Uint8Array {
    return new Uint8Array(this.buffer, this.take(count, 1), count);
  }

  number(): number {
    return this.numbers(1)[0] ?? 0;
  }

  /** Throws where fewer bytes are left. */
  expect(bytes: number): void {
    if (bytes <= this.rest) return;
    throw new Error(`a message ends too early: ${bytes} bytes needed, ${this.rest} there`);
  }

  private take(count: number, size: number): number {
    const start = this.at;
    this.expect(count * size);
    this.at += count * size;
    return start;
  }
}

/** The frame in a binary message. Throws where its lengths do not fit together. */
export function decode(buffer: ArrayBuffer): Frame {
  if (buffer.byteLength < HEADER) throw new Error("a message is shorter than its header");
  const [number = 0, view = 0, revision = 0, count = 0] = new Uint32Array(buffer, 0, 4);
  const head = { view, revision };
  const reader = new Reader(buffer);
  const kind = kinds[number];
  switch (kind) {
    case "topology":
      return topology(reader, head);
    case "delta":
    case "scalars":
      return { kind, ...head, values: reader.floats(count) };
    case "normals":
      return { kind, ...head, values: reader.floats(3 * count) };
    case "triangles":
      return { kind, ...head, indices: reader.numbers(3 * count) };
    case "positions": {
      const vertices = reader.number();
      const triangles = reader.number();
      const positions = reader.floats(3 * vertices);
      return { kind, ...head, positions, indices: reader.numbers(3 * triangles) };
    }
    case "lines": {
      const lengths = reader.numbers(reader.number());
      const points = lengths.reduce((sum, length) => sum + length, 0);
      return { kind, ...head, lengths, points: reader.floats(3 * points) };
    }
    case "points":
      return { kind, ...head, ...marked(reader, count) };
    case "image": {
      const width = reader.number();
      const height = reader.number();
      const corners = reader.floats(9);
      return { kind, ...head, width, height, corners, pixels: reader.bytes(4 * width * height) };
    }
    case "interfaces": {
      const runs = reader.number();
      const edges = reader.number();
      return { kind, ...head, runs: reader.numbers(3 * runs), edges: reader.numbers(2 * edges), labels: [] };
    }
    default:
      throw new Error(`a message of unknown kind ${number}`);
  }
}

function topology(reader: Reader, head: Head): Topology {
  const [vertices = 0, triangles = 0, segments = 0] = reader.numbers(4);
  const outside = reader.floats(3 * vertices);
  const along = reader.floats(3 * vertices);
  const indices = reader.numbers(3 * triangles);
  const pairs = reader.numbers(2 * segments);
  const family = reader.bytes(4 * Math.ceil(segments / 4)).subarray(0, segments);
  return { kind: "topology", ...head, outside, along, indices, families: byFamily(pairs, family) };
}

function byFamily(pairs: Uint32Array, family: Uint8Array): Topology["families"] {
  const sizes = [0, 0, 0];
  for (const axis of family) {
    if (axis > 2) throw new Error(`a segment of the network across axis ${axis}`);
    sizes[axis] = (sizes[axis] ?? 0) + 2;
  }
  const sorted = sizes.map((size) => new Uint32Array(size)) as Topology["families"];
  const filled = [0, 0, 0];
  for (let segment = 0; segment < family.length; segment++) {
    const axis = family[segment]!;
    const at = filled[axis]!;
    sorted[axis]![at] = pairs[2 * segment]!;
    sorted[axis]![at + 1] = pairs[2 * segment + 1]!;
    filled[axis] = at + 2;
  }
  return sorted;
}

function marked(reader: Reader, count: number): Pick<Points, "points" | "inside"> {
  const places = reader.floats(4 * count);
  const sides = new Uint32Array(places.buffer, places.byteOffset, places.length);
  const points = new Float32Array(3 * count);
  const inside = new Float32Array(count);
  for (let i = 0; i < count; i++) {
    for (let axis = 0; axis < 3; axis++) points[3 * i + axis] = places[4 * i + axis]!;
    inside[i] = sides[4 * i + 3] ? 1 : 0;
  }
  return { points, inside };
}

/** Ends of the segments of polylines, two by two. */
export function segmentsOf({ lengths, points }: Lines): Uint32Array {
  const indices: number[] = [];
  let first = 0;
  for (const length of lengths) {
    for (let i = 1; i < length; i++) indices.push(first + i - 1, first + i);
    first += length;
  }
  if (3 * first !== points.length) throw new Error("polylines and their points do not fit");
  return Uint32Array.from(indices);
}
