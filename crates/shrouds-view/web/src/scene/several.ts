// The interfaces between several labels on the screen, and the lines where three or more meet.

import { DataTexture, NearestFilter, Vector3, type LineSegments } from "three";
import type { Interfaces, Positions } from "../frames.ts";
import { apart, edgesShown, palette } from "./interfaces.ts";
import * as overlays from "./overlays.ts";
import { SurfaceModel, asTopology, type Uniforms } from "./surface.ts";

const INK = new Vector3(0.06, 0.06, 0.07);

export class SeveralModel {
  readonly surface: SurfaceModel;
  private readonly colours: DataTexture;
  private lines: LineSegments | undefined;

  constructor(
    private readonly mesh: Positions,
    private readonly interfaces: Interfaces,
    private readonly shared: Uniforms,
    gl: WebGL2RenderingContext,
  ) {
    const { labels } = interfaces;
    this.colours = new DataTexture(new Uint8Array(4 * labels.length), labels.length, 1);
    Object.assign(this.colours, { magFilter: NearestFilter, minFilter: NearestFilter });
    const { positions, indices, sides } = apart(mesh, interfaces);
    const topology = asTopology({ ...mesh, positions, indices });
    this.surface = new SurfaceModel(topology, shared, gl, { sides, palette: this.colours });
  }

  /** Shows each label in its colour, but for those that are hidden. */
  paint(colours: ReadonlyMap<number, string>, hidden: ReadonlySet<number>): void {
    const { labels } = this.interfaces;
    (this.colours.image.data as Uint8Array).set(palette(labels, colours, hidden));
    this.colours.needsUpdate = true;
    const shown = labels.map((label) => label !== 0 && !hidden.has(label));
    overlays.discard(this.lines);
    const edges = edgesShown(this.mesh, this.interfaces, shown);
    this.lines = overlays.edges(this.mesh.positions, edges, this.shared, INK);
    this.surface.group.add(this.lines);
  }

  /** How many edges of junction lines are drawn, for tests. */
  get edges(): number {
    return (this.lines?.geometry.index?.count ?? 0) / 2;
  }

  dispose(): void {
    overlays.discard(this.lines);
    this.colours.dispose();
    this.surface.dispose();
  }
}
