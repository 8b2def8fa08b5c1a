// What is drawn beside surfaces: contours and tracks, lattice points, a slice, the brush.

import {
  BufferAttribute, BufferGeometry, DataTexture, DoubleSide, GLSL3, LineSegments, Mesh, MeshBasicMaterial,
  NearestFilter, Points, SRGBColorSpace, ShaderMaterial, SphereGeometry, Vector3, type Object3D,
} from "three";
import { segmentsOf, type Lines, type Plane, type Points as PointsFrame } from "../frames.ts";
import { lineFragment, plainLineVertex, pointFragment, pointVertex } from "./shaders.ts";
import type { Uniforms } from "./surface.ts";

const NEARER = 2e-5;

export function lines(frame: Lines, shared: Uniforms, ink: Vector3): LineSegments {
  return edges(frame.points, segmentsOf(frame), shared, ink);
}

/** Lines between points, two by two. */
export function edges(points: Float32Array, ends: Uint32Array, shared: Uniforms, ink: Vector3): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setIndex(new BufferAttribute(ends, 1));
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { ...shared, ink: { value: ink }, nearer: { value: NEARER } },
    vertexShader: plainLineVertex,
    fragmentShader: lineFragment,
  });
  return still(new LineSegments(geometry, material));
}

/** Points of a lattice with this step, or in the size of such. */
export function points(frame: PointsFrame, shared: Uniforms, step: number): Points {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(frame.points, 3));
  geometry.setAttribute("inside", new BufferAttribute(frame.inside, 1));
  const uniforms = {
    ...shared,
    step: { value: step },
    inner: { value: new Vector3(0.05, 0.45, 0.7) },
    outer: { value: new Vector3(0.9, 0.62, 0) },
  };
  const shaders = { vertexShader: pointVertex, fragmentShader: pointFragment };
  return still(new Points(geometry, new ShaderMaterial({ glslVersion: GLSL3, uniforms, ...shaders })));
}

/** The pixels lie around the voxel centres, so the picture reaches half a pixel beyond the corners. */
export function plane(frame: Plane): Mesh {
  const [first, right, down] = [0, 3, 6].map((at) => new Vector3().fromArray(frame.corners, at));
  const across = right!.clone().sub(first!).divideScalar(Math.max(frame.width - 1, 1));
  const below = down!.clone().sub(first!).divideScalar(Math.max(frame.height - 1, 1));
  const start = first!.clone().addScaledVector(across, -0.5).addScaledVector(below, -0.5);
  const corner = (x: number, y: number): Vector3 =>
    start.clone().addScaledVector(across, x * frame.width).addScaledVector(below, y * frame.height);
  const geometry = new BufferGeometry().setFromPoints([corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)]);
  geometry.setAttribute("uv", new BufferAttribute(Float32Array.of(0, 0, 1, 0, 0, 1, 1, 1), 2));
  geometry.setIndex([0, 1, 2, 2, 1, 3]);
  const map = new DataTexture(new Uint8Array(frame.pixels), frame.width, frame.height);
  Object.assign(map, { magFilter: NearestFilter, minFilter: NearestFilter, colorSpace: SRGBColorSpace });
  map.needsUpdate = true;
  // Lattice points lie in the slice: it makes room for their discs.
  const behind = { polygonOffset: true, polygonOffsetFactor: 8, polygonOffsetUnits: 8 };
  const material = new MeshBasicMaterial({ map, side: DoubleSide, transparent: true, opacity: 0.9, ...behind });
  return still(new Mesh(geometry, material));
}

/** The ball that the brush would add or take away. */
export function ghost(): Mesh {
  const material = new MeshBasicMaterial({ transparent: true, opacity: 0.35, depthWrite: false });
  const ball = still(new Mesh(new SphereGeometry(1, 24, 16), material));
  ball.visible = false;
  return ball;
}

/** Removes it from the screen and from the memory of the graphics card. */
export function discard(object: Object3D | undefined): void {
  if (!object) return;
  object.removeFromParent();
  const { geometry, material } = object as Mesh;
  geometry.dispose();
  const { map } = material as MeshBasicMaterial;
  map?.dispose();
  (material as MeshBasicMaterial).dispose();
}

function still<T extends Object3D>(object: T): T {
  object.frustumCulled = false;
  return object;
}
