// One of the pictures beside each other.

import { Group, Scene, type Object3D } from "three";
import type { Positions } from "../frames.ts";
import type { SeveralModel } from "./several.ts";
import type { SurfaceModel } from "./surface.ts";

export interface Pane {
  scene: Scene;
  root: Group;
  surface?: SurfaceModel | undefined;
  /** The mesh with vertices of its own, shown in place of the surface while that does not move. */
  dual?: SurfaceModel | undefined;
  /** A mesh whose interfaces are on their way. */
  mesh?: Positions | undefined;
  /** What the surface is, where it is the interfaces of several labels. */
  several?: SeveralModel | undefined;
  contours?: Object3D | undefined;
  /** Told when what came last is on the screen. */
  drawn: (() => void)[];
}

export function emptyPane(): Pane {
  const scene = new Scene();
  const root = new Group();
  scene.add(root);
  return { scene, root, drawn: [] };
}
