// One camera for all views: perspective or parallel, turned by mouse, touch and keys.

import { Matrix3, OrthographicCamera, PerspectiveCamera, Spherical, Vector3, type Box3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const ANGLE = 30;
/** As in the pictures of `shrouds render`: azimuth −75°, elevation 40°. */
const FROM = new Vector3(
  Math.cos((-75 * Math.PI) / 180) * Math.cos((40 * Math.PI) / 180),
  Math.sin((-75 * Math.PI) / 180) * Math.cos((40 * Math.PI) / 180),
  Math.sin((40 * Math.PI) / 180),
);

export class Camera {
  private readonly perspective = new PerspectiveCamera(ANGLE);
  private readonly orthographic = new OrthographicCamera();
  readonly controls: OrbitControls;
  /** Radius of all there is to see. */
  private radius = 1;

  constructor(element: HTMLElement) {
    for (const camera of [this.perspective, this.orthographic]) {
      camera.up.set(0, 0, 1);
      camera.position.copy(FROM);
    }
    this.controls = new OrbitControls(this.perspective, element);
    this.controls.zoomToCursor = true;
    this.controls.rotateSpeed = 0.8;
  }

  get current(): PerspectiveCamera | OrthographicCamera {
    return this.controls.object as PerspectiveCamera | OrthographicCamera;
  }

  /** Perspective or parallel rays, with the same size at the middle of what is seen. */
  project(parallel: boolean): void {
    const next = parallel ? this.orthographic : this.perspective;
    const last = this.current;
    if (next === last) return;
    const away = last.position.clone().sub(this.controls.target);
    next.position.copy(this.controls.target).addScaledVector(away, 1 / last.zoom);
    next.zoom = 1;
    this.controls.object = next;
    this.controls.update();
  }

  /** Makes ready for a picture of this size. */
  aim(width: number, height: number): PerspectiveCamera | OrthographicCamera {
    const camera = this.current;
    const aspect = width / Math.max(height, 1);
    const distance = camera.position.distanceTo(this.controls.target);
    if (camera instanceof PerspectiveCamera) {
      camera.aspect = aspect;
      camera.near = Math.max(distance - 3 * this.radius, distance / 200);
    } else {
      const half = distance * Math.tan((ANGLE * Math.PI) / 360);
      Object.assign(camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
      camera.near = distance - 12 * this.radius;
    }
    // Floors and ways of a scene reach beyond the surface.
    camera.far = distance + 12 * this.radius;
    camera.updateProjectionMatrix();
    return camera;
  }

  /** All of the box in sight, from where pictures are taken. */
  fit(box: Box3, directions: Matrix3, aspect: number): void {
    const middle = box.getCenter(new Vector3());
    this.radius = Math.max(box.getSize(new Vector3()).length() / 2, 1e-6);
    this.current.zoom = 1;
    this.controls.target.copy(middle.clone().applyMatrix3(directions));
    const away = Math.max(...corners(box).map((corner) => distance(corner.sub(middle).applyMatrix3(directions), aspect)));
    this.current.position.copy(this.controls.target).addScaledVector(FROM, Math.max(1.06 * away, 1e-6));
    this.controls.update();
  }

  /** Turns about the target, in degrees. */
  turn(right: number, up: number): void {
    const { target } = this.controls;
    const away = this.current.position.clone().sub(target);
    // OrbitControls has y up in its spherical coordinates, and so have we.
    const around = new Spherical().setFromCartesianCoords(away.x, away.z, -away.y);
    around.theta += (right * Math.PI) / 180;
    around.phi = Math.min(Math.max(around.phi - (up * Math.PI) / 180, 0.01), Math.PI - 0.01);
    const turned = new Vector3().setFromSpherical(around);
    this.current.position.copy(target).add(new Vector3(turned.x, -turned.z, turned.y));
    this.controls.update();
  }

  /** Nearer by a factor. */
  zoom(factor: number): void {
    const away = this.current.position.clone().sub(this.controls.target);
    this.current.position.copy(this.controls.target).addScaledVector(away, 1 / factor);
    this.controls.update();
  }

  /** Eye, target and magnification. */
  get text(): string {
    const { position, zoom } = this.current;
    const numbers = [...position.toArray(), ...this.controls.target.toArray(), zoom];
    return numbers.map((number) => Number(number.toPrecision(5))).join(",");
  }

  set text(text: string) {
    const numbers = text.split(",").map(Number);
    if (numbers.length !== 7 || !numbers.every(Number.isFinite)) return;
    this.current.position.fromArray(numbers);
    this.controls.target.fromArray(numbers, 3);
    this.current.zoom = Math.max(numbers[6] ?? 1, 1e-3);
    this.controls.update();
  }
}

function corners({ min, max }: Box3): Vector3[] {
  const ends = [min, max];
  return ends.flatMap(({ x }) => ends.flatMap(({ y }) => ends.map(({ z }) => new Vector3(x, y, z))));
}

/** How far from the middle the eye must be to see a corner of the box. */
function distance(corner: Vector3, aspect: number): number {
  const right = new Vector3(0, 0, 1).cross(FROM).normalize();
  const up = FROM.clone().cross(right);
  const half = Math.tan((ANGLE * Math.PI) / 360);
  const side = Math.max(Math.abs(corner.dot(right)) / aspect, Math.abs(corner.dot(up)));
  return corner.dot(FROM) + side / half;
}
