// The picture: one canvas, up to four panes with one camera, drawn only when something changes.

import {
  Box3, Color, Group, Matrix3, Matrix4, Object3D, Scene, Vector2, Vector3, Vector4,
  WebGLRenderer,
} from "three";
import type { Frame, Interfaces, Lines, Plane, Points, Topology } from "../frames.ts";
import type { Colouring, Volume } from "../protocol.ts";
import { axes, type State, type Store } from "../state.ts";
import { Camera } from "./camera.ts";
import { labelsIn } from "./interfaces.ts";
import * as overlays from "./overlays.ts";
import { nearest } from "./mesh.ts";
import { emptyPane, type Pane } from "./pane.ts";
import { Picker } from "./pick.ts";
import { ramp } from "./ramp.ts";
import { SeveralModel } from "./several.ts";
import { SurfaceModel, asTopology, type Uniforms } from "./surface.ts";

/** A pane's part of the canvas in CSS pixels, from the top left. */
export interface Rectangle {
  left: number;
  top: number;
  width: number;
  height: number;
}

export interface Hit {
  view: number;
  /** In lattice coordinates. */
  place: [number, number, number];
}

const GLIDE = 320;
/** Longer between two pictures in motion is slow, in milliseconds. */
const SLOW = 70;
const FRONT = new Vector3(0xde, 0xb8, 0x80).divideScalar(255);
const BACK = new Vector3(128, 62, 52).divideScalar(255);

export class Stage {
  readonly camera: Camera;
  private readonly renderer: WebGLRenderer;
  private readonly panes: Pane[];
  private readonly shared = new Scene();
  private readonly sharedRoot = new Group();
  private readonly uniforms: Uniforms;
  private readonly picker = new Picker();
  private readonly ghost = overlays.ghost();
  private readonly box = new Box3();
  private readonly directions = new Matrix3();
  private readonly others = new Map<string, Object3D>();
  private volume: Volume | undefined;
  private fitted = "";
  private readonly listeners: (() => void)[] = [];
  private waiting = false;
  private glideStart = 0;
  private moving = false;
  private slow = false;
  private last = 0;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly store: Store,
    private readonly layout: () => Rectangle[],
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.autoClear = false;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera = new Camera(canvas);
    this.uniforms = this.commonUniforms();
    this.panes = Array.from({ length: 4 }, () => emptyPane());
    this.shared.add(this.sharedRoot.add(this.ghost));
    this.listen();
  }

  private commonUniforms(): Uniforms {
    return {
      plane: { value: new Vector4(0, 0, 0, 1) },
      pixels: { value: new Vector2(1, 1) },
      smoothly: { value: false },
      front: { value: FRONT },
      back: { value: BACK },
    };
  }

  private listen(): void {
    const { controls } = this.camera;
    controls.addEventListener("change", () => this.draw());
    controls.addEventListener("start", () => this.motion(true));
    controls.addEventListener("end", () => this.motion(false));
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.store.watch([], () => this.draw());
    this.store.watch(["hidden"], () => this.panes.forEach(({ several }) => this.paint(several)));
    this.camera.project(this.store.state.parallel);
    this.store.watch(["parallel"], ({ parallel }) => this.camera.project(parallel));
  }

  private motion(on: boolean): void {
    this.moving = on;
    this.last = 0;
    if (!on) this.store.set({ camera: this.camera.text });
    this.draw();
  }

  /** Another volume: its directions turn all that is drawn in its lattice. */
  look(volume: Volume): void {
    this.volume = volume;
    const rows = (volume.affine?.flat() ?? []) as number[];
    const column = (axis: number): Vector3 =>
      new Vector3(rows[axis] ?? 0, rows[4 + axis] ?? 0, rows[8 + axis] ?? 0).normalize();
    const base = rows.length >= 12 ? axes.map((_, axis) => column(axis)) : [];
    const [x, y, z] = base.every((v) => v.lengthSq() > 0.5) ? base : [];
    const matrix = x && y && z ? new Matrix4().makeBasis(x, y, z) : new Matrix4();
    this.directions.setFromMatrix4(matrix);
    for (const root of [this.sharedRoot, ...this.panes.map((pane) => pane.root)]) {
      root.matrixAutoUpdate = false;
      root.matrix.copy(matrix);
      root.matrixWorldNeedsUpdate = true;
    }
    this.draw();
  }

  /** Puts a frame on the screen and then says so. */
  show(frame: Frame, drawn: () => void): void {
    const pane = this.panes[frame.view];
    if (!pane) return;
    if (frame.kind === "topology") this.replace(pane, this.model(frame));
    else if (frame.kind === "interfaces") this.setSeveral(pane, frame);
    else if (frame.kind === "positions" && (pane.several || pane.surface?.topology.revision !== frame.revision)) {
      // What its triangles lie between comes next.
      pane.mesh = frame;
      return drawn();
    }
    else if (pane.surface?.topology.revision !== frame.revision) return drawn();
    else if (frame.kind === "positions") this.setDual(pane, this.model(asTopology(frame)));
    else if (frame.kind === "delta") this.move(pane, pane.surface, frame.values);
    else if (frame.kind === "triangles") pane.surface.retriangulate(frame.indices);
    else if (frame.kind === "normals") pane.surface.setNormals(frame.values);
    pane.drawn.push(drawn);
    this.draw();
  }

  /** Interfaces of several labels, in their colours. */
  private setSeveral(pane: Pane, frame: Interfaces): void {
    const { mesh } = pane;
    pane.mesh = undefined;
    if (mesh?.revision !== frame.revision) return;
    const several = new SeveralModel(mesh, frame, this.uniforms, this.renderer.getContext() as WebGL2RenderingContext);
    this.paint(several);
    this.replace(pane, several.surface, several);
  }

  private paint(several: SeveralModel | undefined): void {
    const colours = (this.volume?.labels ?? []).map(({ value, colour }) => [value, colour] as const);
    several?.paint(new Map(colours), labelsIn(this.store.state.hidden));
  }

  private clear(pane: Pane): void {
    this.setDual(pane, undefined);
    (pane.several ?? pane.surface)?.dispose();
    pane.several = pane.surface = undefined;
  }

  private replace(pane: Pane, surface: SurfaceModel, several?: SeveralModel): void {
    this.clear(pane);
    Object.assign(pane, { surface, several });
    pane.root.add(surface.group);
    this.slow = false;
    this.box.setFromArray(surface.topology.outside as unknown as number[]);
    // What is edited, or another step of the same scene, is looked at from where one is.
    const { name = "", dims, spacing } = this.volume ?? {};
    const identity = JSON.stringify([name.replace(/( \(edited\)|, contact \d+)$/, ""), dims, spacing]);
    if (this.fitted === identity || this.box.isEmpty()) return;
    const first = this.fitted === "" && this.store.state.camera !== "";
    this.fitted = identity;
    this.fit();
    if (first) this.camera.text = this.store.state.camera;
  }

  private model(topology: Topology): SurfaceModel {
    return new SurfaceModel(topology, this.uniforms, this.renderer.getContext() as WebGL2RenderingContext);
  }

  private setDual(pane: Pane, dual: SurfaceModel | undefined): void {
    pane.dual?.dispose();
    pane.dual = dual;
    if (dual) pane.root.add(dual.group);
  }

  private move(pane: Pane, surface: SurfaceModel, delta: Float32Array): void {
    this.setDual(pane, undefined);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const glide = !calm && delta.length < 100_000;
    surface.move(delta, glide);
    if (glide) this.glideStart = performance.now();
  }

  /** No surface for now. */
  forget(view: number): void {
    const pane = this.panes[view];
    if (!pane) return;
    this.clear(pane);
    this.setContours(view, undefined);
  }

  /** All in sight, from where pictures are taken. */
  fit(): void {
    const { width, height } = this.layout()[0] ?? { width: 1, height: 1 };
    this.camera.fit(this.box, this.directions, width / Math.max(height, 1));
    this.draw();
  }

  setColours(view: number, values: Float32Array | undefined, colouring?: Colouring): void {
    const { surface, dual } = this.panes[view] ?? {};
    for (const model of [surface, dual]) {
      const fits = values && model?.count === values.length;
      if (fits && colouring) model.setColours(values, ramp(colouring), [colouring.low, colouring.high]);
      else model?.setColours();
    }
    this.draw();
  }

  setContours(view: number, frame: Lines | undefined): void {
    const pane = this.panes[view];
    if (!pane) return;
    overlays.discard(pane.contours);
    pane.contours = frame && overlays.lines(frame, this.uniforms, new Vector3(0.1, 0.1, 0.12));
    if (pane.contours) pane.root.add(pane.contours);
    this.draw();
  }

  /** Things that all views share, each under a name. */
  setOther(name: string, frame: Points | Plane | Lines | undefined): void {
    overlays.discard(this.others.get(name));
    this.others.delete(name);
    if (frame) {
      const object =
        frame.kind === "image"
          ? overlays.plane(frame)
          : frame.kind === "points"
            ? overlays.points(frame, this.uniforms, Math.min(...(this.volume?.spacing ?? [1])))
            : overlays.lines(frame, this.uniforms, new Vector3(0.85, 0.33, 0.1));
      this.others.set(name, object);
      this.sharedRoot.add(object);
    }
    this.draw();
  }

  /** The brush, in lattice coordinates. */
  setBrush(place: readonly number[] | undefined, radius: number, adds: boolean): void {
    this.ghost.visible = place !== undefined;
    if (place) {
      this.ghost.position.fromArray(place as number[]);
      const spacing = this.volume?.spacing ?? [1, 1, 1];
      this.ghost.scale.fromArray(spacing.map((step) => step * Math.max(radius, 0.5)));
      (this.ghost.material as unknown as { color: Color }).color.set(adds ? 0x2a9d6f : 0xd1495b);
    }
    this.draw();
  }

  /** The pane at a place on the canvas, in CSS pixels from its top left; −1 where there is none. */
  paneAt(x: number, y: number): number {
    const inside = ({ left, top, width, height }: Rectangle): boolean =>
      x >= left && y >= top && x < left + width && y < top + height;
    return this.layout().findIndex(inside);
  }

  /** What lies under such a place. */
  hit(x: number, y: number): Hit | undefined {
    const view = this.paneAt(x, y);
    const pane = this.panes[view];
    const rectangle = this.layout()[view];
    if (!pane?.surface || !rectangle) return undefined;
    this.prepare(pane, true);
    const camera = this.camera.aim(rectangle.width, rectangle.height);
    const at: [number, number] = [x - rectangle.left, y - rectangle.top];
    const place = this.picker.place(this.renderer, pane.scene, camera, rectangle, at);
    this.prepare(pane, false);
    return place && { view, place };
  }

  /** The vertex of a view that is nearest to a place. */
  vertex({ view, place }: Hit): number {
    const surface = this.panes[view]?.surface;
    return surface ? nearest(surface.positions(), place) : -1;
  }

  /** Where the vertices of a view are, in lattice coordinates. */
  positions(view: number): Float32Array | undefined {
    return this.panes[view]?.surface?.positions();
  }

  /** The δ of a view as it is drawn in the end, for tests. */
  delta(view: number): Float32Array | undefined {
    return this.panes[view]?.surface?.delta;
  }

  /** Where the axes of the lattice point on the screen: right, up, towards the eye. */
  axisDirections(): number[][] {
    const turn = new Matrix3().setFromMatrix4(this.camera.current.matrixWorldInverse).multiply(this.directions);
    return axes.map((_, axis) => new Vector3().setComponent(axis, 1).applyMatrix3(turn).toArray());
  }

  /** Calls after each picture. */
  onDraw(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** The picture as it is now. */
  picture(): Promise<Blob | null> {
    this.render(performance.now());
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => {
      this.waiting = false;
      this.render(now);
    });
  }

  private render(now: number): void {
    const started = performance.now();
    this.measure(now);
    this.background();
    const { state } = this.store;
    this.layout().forEach((rectangle, view) => {
      const pane = this.panes[view];
      if (pane && view < state.views) this.pane(pane, rectangle, state);
    });
    const told = this.panes.flatMap((pane) => pane.drawn.splice(0));
    for (const drawn of [...told, ...this.listeners]) drawn();
    if (this.glide(started)) this.draw();
  }

  private measure(now: number): void {
    if (this.moving && this.last > 0 && now - this.last > SLOW) this.slow = true;
    this.last = now;
  }

  private background(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const ratio = this.renderer.getPixelRatio();
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setSize(width, height, false);
    }
    const colour = getComputedStyle(this.canvas).getPropertyValue("--canvas").trim();
    this.renderer.setClearColor(colour || "#f6f6f4");
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
  }

  private pane(pane: Pane, { left, top, width, height }: Rectangle, state: State): void {
    if (width < 1 || height < 1) return;
    const bottom = this.canvas.clientHeight - top - height;
    const camera = this.camera.aim(width, height);
    this.renderer.setViewport(left, bottom, width, height);
    const ratio = this.renderer.getPixelRatio();
    (this.uniforms.pixels!.value as Vector2).set(ratio, ratio * height);
    this.prepare(pane, false);
    const part = (from: number, to: number, midpoints: boolean): void => {
      if (to <= from) return;
      if (pane.surface) pane.surface.uniforms.midpoints!.value = midpoints;
      this.renderer.setScissor(left + from, bottom, to - from, height);
      this.renderer.render(pane.scene, camera);
      this.renderer.render(this.shared, camera);
    };
    // Midpoints are those of the grid edges: a mesh with vertices of its own has none.
    const edge = state.wipe && !pane.dual && !pane.several ? Math.round(state.wipeAt * width) : 0;
    part(0, edge, true);
    part(edge, width, false);
  }

  private prepare(pane: Pane, picking: boolean): void {
    const { state } = this.store;
    const surface = pane.dual ?? pane.surface;
    if (pane.surface) pane.surface.group.visible = !pane.dual;
    this.uniforms.smoothly!.value = state.smooth;
    (this.uniforms.plane!.value as Vector4).copy(this.clipping(state));
    if (!surface) return;
    const fewer = this.moving && this.slow && !picking;
    surface.reduce(fewer, this.volume?.spacing ?? [1, 1, 1]);
    if (state.smooth && !picking) surface.ownNormals();
    surface.prepare(state.network && !fewer, picking);
    if (pane.contours) pane.contours.visible = !picking && !fewer;
  }

  private clipping({ clip, clipAt, clipBack }: State): Vector4 {
    const axis = clip === "" ? -1 : axes.indexOf(clip);
    if (axis < 0 || !this.volume) return new Vector4(0, 0, 0, 1);
    const length = ((this.volume.dims[axis] ?? 1) - 1) * (this.volume.spacing[axis] ?? 1);
    const normal = [0, 0, 0, clipAt * length];
    normal[axis] = 1;
    const plane = new Vector4().fromArray(normal);
    return clipBack ? plane.negate() : plane;
  }

  /** Moves all that glides on; whether anything still does. */
  private glide(now: number): boolean {
    const share = Math.min((now - this.glideStart) / GLIDE, 1);
    let moving = false;
    for (const { surface } of this.panes) {
      const at = surface?.uniforms.glide;
      if (!at || at.value === 1) continue;
      at.value = share;
      moving = true;
    }
    return moving;
  }
}
