// What the page works out itself about triangles; arrays in, arrays out.

/** Normals of vertices, of any length: the sums of the area vectors of their triangles. */
export function normalsOf(positions: Float32Array, indices: Uint32Array): Float32Array {
  const normals = new Float32Array(positions.length);
  for (let t = 0; t < indices.length; t += 3) {
    const a = 3 * indices[t]!;
    const b = 3 * indices[t + 1]!;
    const c = 3 * indices[t + 2]!;
    const ux = positions[b]! - positions[a]!;
    const uy = positions[b + 1]! - positions[a + 1]!;
    const uz = positions[b + 2]! - positions[a + 2]!;
    const vx = positions[c]! - positions[a]!;
    const vy = positions[c + 1]! - positions[a + 1]!;
    const vz = positions[c + 2]! - positions[a + 2]!;
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    for (const at of [a, b, c]) {
      normals[at]! += nx;
      normals[at + 1]! += ny;
      normals[at + 2]! += nz;
    }
  }
  return normals;
}

/** How many voxels a block has along each axis in a reduced mesh. */
const BLOCK = 3;

/**
 * Triangles between one vertex of each block of voxels: those of the mesh whose corners lie in three
 * blocks, with the first vertex of the block for each corner.
 */
export function reduced(
  outside: Float32Array,
  indices: Uint32Array,
  spacing: readonly number[],
): Uint32Array {
  const [low, blocks] = extent(outside, spacing);
  const first = new Int32Array(blocks[0]! * blocks[1]! * blocks[2]!).fill(-1);
  const chosen = new Uint32Array(outside.length / 3);
  for (let vertex = 0; vertex < chosen.length; vertex++) {
    let block = 0;
    for (let axis = 2; axis >= 0; axis--) {
      const index = Math.round(outside[3 * vertex + axis]! / spacing[axis]!) - low[axis]!;
      block = block * blocks[axis]! + Math.floor(index / BLOCK);
    }
    if (first[block]! < 0) first[block] = vertex;
    chosen[vertex] = first[block]!;
  }
  return between(indices, chosen);
}

function extent(outside: Float32Array, spacing: readonly number[]): [number[], number[]] {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < outside.length; i++) {
    const index = Math.round(outside[i]! / spacing[i % 3]!);
    low[i % 3] = Math.min(low[i % 3]!, index);
    high[i % 3] = Math.max(high[i % 3]!, index);
  }
  return [low, high.map((end, axis) => Math.max(Math.floor((end - low[axis]!) / BLOCK) + 1, 0))];
}

function between(indices: Uint32Array, chosen: Uint32Array): Uint32Array {
  const kept = new Uint32Array(indices.length);
  let count = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const a = chosen[indices[t]!]!;
    const b = chosen[indices[t + 1]!]!;
    const c = chosen[indices[t + 2]!]!;
    if (a === b || b === c || c === a) continue;
    kept.set([a, b, c], count);
    count += 3;
  }
  return kept.slice(0, count);
}

/** The vertex nearest to a place. */
export function nearest(positions: Float32Array, place: readonly number[]): number {
  const [x = 0, y = 0, z = 0] = place;
  let best = -1;
  let least = Infinity;
  for (let at = 0; at < positions.length; at += 3) {
    const distance =
      (positions[at]! - x) ** 2 + (positions[at + 1]! - y) ** 2 + (positions[at + 2]! - z) ** 2;
    if (distance < least) [best, least] = [at / 3, distance];
  }
  return best;
}
