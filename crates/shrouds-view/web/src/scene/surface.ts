// One surface on the screen: the mesh, its network and its colours.

import {
  BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, GLSL3, Group, LineSegments, Mesh,
  ShaderMaterial, Vector3, type IUniform, type Texture,
} from "three";
import type { Positions, Topology } from "../frames.ts";
import { LiveArray } from "./live.ts";
import { normalsOf, reduced } from "./mesh.ts";
import { lineFragment, lineVertex, pickFragment, surfaceFragment, surfaceVertex } from "./shaders.ts";

export type Uniforms = Record<string, IUniform>;

/** What the triangles of a surface lie between, where those are several labels. */
export interface Labelled {
  /** For each vertex the places of the labels on both sides in the palette. */
  sides: Float32Array;
  /** A colour for each label, with no opacity where it is hidden. */
  palette: Texture;
}

/** Red, white, blue: what the planes of the curves lie across, x, y, z. */
const FAMILIES = [0xd62728, 0xffffff, 0x1f5fd0] as const;
/** Steep faces make room for the lines on them. */
const BEHIND = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 } as const;
const NEARER = 1e-5;

export class SurfaceModel {
  readonly group = new Group();
  readonly uniforms: Uniforms;
  private readonly geometry = new BufferGeometry();
  private readonly mesh: Mesh;
  private readonly picker: ShaderMaterial;
  private readonly painter: ShaderMaterial;
  private readonly network: LineSegments[];
  private readonly deltas: LiveArray;
  private readonly before: LiveArray;
  private whole: BufferAttribute;
  private fewer: BufferAttribute | undefined;
  /** Whether the normals are those of other places. */
  private stale = true;

  constructor(
    readonly topology: Topology,
    shared: Uniforms,
    gl: WebGL2RenderingContext,
    private readonly labelled?: Labelled,
  ) {
    this.deltas = new LiveArray(gl, new Float32Array(this.count).fill(0.5));
    this.before = new LiveArray(gl, new Float32Array(this.count).fill(0.5));
    this.uniforms = {
      ...shared,
      glide: { value: 1 },
      midpoints: { value: false },
      coloured: { value: false },
      range: { value: [0, 1] },
      colours: { value: null },
      palette: { value: labelled?.palette ?? null },
    };
    this.whole = new BufferAttribute(topology.indices, 1);
    this.fill(this.count);
    const defines = labelled ? { LABELLED: "" } : {};
    const vertex = { glslVersion: GLSL3, uniforms: this.uniforms, side: DoubleSide, defines, ...BEHIND } as const;
    this.painter = new ShaderMaterial({ ...vertex, vertexShader: surfaceVertex, fragmentShader: surfaceFragment });
    this.picker = new ShaderMaterial({ ...vertex, vertexShader: surfaceVertex, fragmentShader: pickFragment });
    this.mesh = new Mesh(this.geometry, this.painter);
    this.mesh.frustumCulled = false;
    this.network = topology.families.map((segments, axis) => this.curves(segments, FAMILIES[axis] ?? 0));
    this.group.add(this.mesh, ...this.network);
  }

  private fill(count: number): void {
    const { outside, along } = this.topology;
    const set = (name: string, values: Float32Array, size: number): void => {
      this.geometry.setAttribute(name, new BufferAttribute(values, size).setUsage(DynamicDrawUsage));
    };
    set("outside", outside, 3);
    set("along", along, 3);
    this.geometry.setAttribute("delta", this.deltas.attribute);
    this.geometry.setAttribute("before", this.before.attribute);
    set("direction", new Float32Array(3 * count), 3);
    set("scalar", new Float32Array(count), 1);
    if (this.labelled) set("sides", this.labelled.sides, 2);
    this.geometry.setIndex(this.whole);
  }

  private curves(segments: Uint32Array, ink: number): LineSegments {
    const geometry = new BufferGeometry();
    for (const name of ["outside", "along", "delta", "before"]) {
      geometry.setAttribute(name, this.geometry.getAttribute(name));
    }
    geometry.setIndex(new BufferAttribute(segments, 1));
    const colour = [16, 8, 0].map((shift) => ((ink >> shift) & 255) / 255);
    const uniforms = { ...this.uniforms, ink: { value: new Vector3(...colour) }, nearer: { value: NEARER } };
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      uniforms,
      vertexShader: lineVertex,
      fragmentShader: lineFragment,
    });
    const lines = new LineSegments(geometry, material);
    lines.frustumCulled = false;
    return lines;
  }

  private attribute(name: string): BufferAttribute {
    return this.geometry.getAttribute(name) as BufferAttribute;
  }

  get count(): number {
    return this.topology.outside.length / 3;
  }

  get delta(): Float32Array {
    return this.deltas.values;
  }

  /** Other places of the vertices; drawn gliding from those before, if asked to. */
  move(delta: Float32Array, glide: boolean): void {
    if (glide) this.before.write(this.shown());
    this.deltas.write(delta);
    this.uniforms.glide!.value = glide ? 0 : 1;
    this.stale = true;
  }

  /** The δ on the screen, which may be on its way. */
  private shown(): Float32Array {
    const share = this.uniforms.glide!.value as number;
    const before = this.before.values;
    return this.delta.map((now, i) => (before[i] ?? now) * (1 - share) + now * share);
  }

  private write(name: string, values: Float32Array): void {
    const attribute = this.attribute(name);
    (attribute.array as Float32Array).set(values.subarray(0, attribute.array.length));
    attribute.needsUpdate = true;
  }

  /** Another triangulation of the same vertices. */
  retriangulate(indices: Uint32Array): void {
    this.whole = new BufferAttribute(indices, 1);
    this.fewer = undefined;
    this.geometry.setIndex(this.whole);
  }

  setNormals(normals: Float32Array): void {
    this.write("direction", normals);
    this.stale = false;
  }

  /** Normals of the triangles where the program has sent none for these places. */
  ownNormals(): void {
    if (this.stale) this.setNormals(normalsOf(this.positions(), this.whole.array as Uint32Array));
  }

  /** Numbers of the vertices as colours of a ramp that spans the range; without numbers one colour. */
  setColours(values?: Float32Array, ramp?: Texture, range: [number, number] = [0, 1]): void {
    if (values) this.write("scalar", values);
    const { coloured, colours, range: span } = this.uniforms;
    (colours!.value as Texture | null)?.dispose();
    coloured!.value = values !== undefined;
    colours!.value = ramp ?? null;
    span!.value = range;
  }

  /** Where the vertices are, in lattice coordinates. */
  positions(): Float32Array {
    const { outside, along } = this.topology;
    const { delta } = this;
    return outside.map((start, i) => start + (along[i] ?? 0) * (delta[(i / 3) | 0] ?? 0));
  }

  /** Fewer triangles between the same vertices, for pictures in motion. Interfaces of several labels would mix. */
  reduce(on: boolean, spacing: readonly number[]): void {
    if (this.labelled) return;
    if (on && !this.fewer) {
      const indices = reduced(this.topology.outside, this.whole.array as Uint32Array, spacing);
      this.fewer = new BufferAttribute(indices, 1);
    }
    this.geometry.setIndex(on && this.fewer ? this.fewer : this.whole);
  }

  prepare(network: boolean, picking: boolean): void {
    for (const lines of this.network) lines.visible = network && !picking;
    this.mesh.material = picking ? this.picker : this.painter;
  }

  dispose(): void {
    this.group.removeFromParent();
    (this.uniforms.colours!.value as Texture | null)?.dispose();
    this.geometry.dispose();
    this.deltas.dispose();
    this.before.dispose();
    this.painter.dispose();
    this.picker.dispose();
    for (const lines of this.network) {
      lines.geometry.dispose();
      (lines.material as ShaderMaterial).dispose();
    }
  }
}

/** A mesh with vertices of its own, as a surface that does not move. */
export function asTopology({ view, revision, positions, indices }: Positions): Topology {
  const none = new Uint32Array();
  const along = new Float32Array(positions.length);
  return { kind: "topology", view, revision, outside: positions, along, indices, families: [none, none, none] };
}
