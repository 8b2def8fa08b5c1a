import assert from "node:assert/strict";
import { test } from "node:test";

import type { Interfaces, Positions } from "../../src/frames.ts";
import { apart, edgesShown, labelsIn, palette } from "../../src/scene/interfaces.ts";

/** Three triangles about the edge 0–1: between labels 3 and background, 7 and background, 3 and 7. */
const head = { view: 0, revision: 1 };
const positions = Float32Array.from([0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0]);
const mesh: Positions = { kind: "positions", ...head, positions, indices: Uint32Array.of(0, 1, 2, 0, 3, 1, 0, 1, 4) };
const runs = Uint32Array.of(1, 0, 1, 2, 0, 1, 1, 2, 1);
const interfaces: Interfaces = { kind: "interfaces", ...head, runs, edges: Uint32Array.of(0, 1), labels: [0, 3, 7] };

test("each pair has vertices of its own, in the same places", () => {
  const parts = apart(mesh, interfaces);
  assert.equal(parts.positions.length, 27);
  assert.deepEqual([...parts.sides], [1, 0, 1, 0, 1, 0, 2, 0, 2, 0, 2, 0, 1, 2, 1, 2, 1, 2]);
  const place = (from: Float32Array, vertex: number): number[] => [...from.subarray(3 * vertex, 3 * vertex + 3)];
  parts.indices.forEach((vertex, corner) => {
    assert.deepEqual(place(parts.positions, vertex), place(positions, mesh.indices[corner]!));
  });
});

test("runs that are not those of the triangles are refused", () => {
  for (const count of [0, 2, 0xffffffff]) {
    const wrong = Uint32Array.from(runs);
    wrong[8] = count;
    assert.throws(() => apart(mesh, { ...interfaces, runs: wrong }), /do not fit/);
  }
});

test("a line is shown as long as a triangle beside it is", () => {
  const edges = (...shown: boolean[]): number[] => [...edgesShown(mesh, interfaces, [false, ...shown])];
  assert.deepEqual(edges(true, true), [0, 1]);
  assert.deepEqual(edges(false, true), [0, 1]);
  assert.deepEqual(edges(false, false), []);
});

test("hidden labels and the background have no opacity", () => {
  const colours = new Map([[3, "ff0000"], [7, "#0102ff"]]);
  assert.deepEqual([...palette([0, 3, 7], colours, new Set([3]))], [128, 128, 128, 0, 255, 0, 0, 0, 1, 2, 255, 255]);
  assert.deepEqual([...labelsIn("7,,-3,x")], [7, -3]);
});
