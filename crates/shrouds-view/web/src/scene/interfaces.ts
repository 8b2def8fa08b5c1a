// Interfaces between several labels: what of them is drawn, and in which colours; arrays in, arrays out.

import type { Interfaces, Positions } from "../frames.ts";

/** The triangles of interfaces, each pair with vertices of its own, so that it can have its own colours and normals. */
export interface Parts {
  positions: Float32Array;
  indices: Uint32Array;
  /** For each vertex the places of the labels on both sides. */
  sides: Float32Array;
}

/** Takes the pairs apart. Throws where runs and triangles do not fit together. */
export function apart({ positions, indices }: Positions, { runs }: Interfaces): Parts {
  const copies = new Int32Array(positions.length / 3).fill(-1);
  const origins: number[] = [];
  const sides: number[] = [];
  const own = new Uint32Array(indices.length);
  let at = 0;
  for (let run = 0; run < runs.length; run += 3) {
    const [first = 0, second = 0, count = 0] = runs.subarray(run, run + 3);
    const start = origins.length;
    const end = at + 3 * count;
    if (end > indices.length) throw new Error("interfaces and their triangles do not fit");
    for (; at < end; at++) {
      const vertex = indices[at]!;
      if (copies[vertex]! < start) {
        copies[vertex] = origins.length;
        origins.push(vertex);
        sides.push(first, second);
      }
      own[at] = copies[vertex]!;
    }
  }
  if (at !== indices.length) throw new Error("interfaces and their triangles do not fit");
  const places = new Float32Array(3 * origins.length);
  origins.forEach((vertex, copy) => places.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * copy));
  return { positions: places, indices: own, sides: Float32Array.from(sides) };
}

/** The edges that border a triangle which is shown. An interface is shown where one of its labels is. */
export function edgesShown({ positions, indices }: Positions, { runs, edges }: Interfaces, shown: readonly boolean[]): Uint32Array {
  const seen = new Uint8Array(positions.length / 3);
  let at = 0;
  for (let run = 0; run < runs.length; run += 3) {
    const [first = 0, second = 0, count = 0] = runs.subarray(run, run + 3);
    const end = at + 3 * count;
    if (shown[first] || shown[second]) for (const vertex of indices.subarray(at, end)) seen[vertex] = 1;
    at = end;
  }
  const kept: number[] = [];
  for (let edge = 0; edge < edges.length; edge += 2) {
    const [a = 0, b = 0] = edges.subarray(edge, edge + 2);
    if (seen[a] && seen[b]) kept.push(a, b);
  }
  return Uint32Array.from(kept);
}

/** Red, green, blue and whether it is shown, for each label of a list; the background never is. */
export function palette(labels: readonly number[], colours: ReadonlyMap<number, string>, hidden: ReadonlySet<number>): Uint8Array {
  const pixels = new Uint8Array(4 * labels.length);
  labels.forEach((label, place) => {
    const text = (colours.get(label) ?? "808080").replace("#", "");
    const parts = [0, 2, 4].map((start) => Number.parseInt(text.slice(start, start + 2), 16) || 0);
    pixels.set([...parts, label === 0 || hidden.has(label) ? 0 : 255], 4 * place);
  });
  return pixels;
}

/** Labels in a text, with commas between. */
export function labelsIn(text: string): Set<number> {
  return new Set(text.split(",").filter(Boolean).map(Number).filter(Number.isFinite));
}
