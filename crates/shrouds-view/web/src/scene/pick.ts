// What lies under a pixel: the surface drawn once more into a picture of one pixel, its places as colours.

import {
  FloatType, NearestFilter, WebGLRenderTarget, type OrthographicCamera, type PerspectiveCamera, type Scene,
  type WebGLRenderer,
} from "three";

export class Picker {
  private readonly target = new WebGLRenderTarget(1, 1, {
    type: FloatType,
    minFilter: NearestFilter,
    magFilter: NearestFilter,
  });
  private readonly pixel = new Float32Array(4);

  /** The place in lattice coordinates; none where there is only background. */
  place(
    renderer: WebGLRenderer,
    scene: Scene,
    camera: PerspectiveCamera | OrthographicCamera,
    { width, height }: { width: number; height: number },
    [x, y]: [number, number],
  ): [number, number, number] | undefined {
    camera.setViewOffset(width, height, x, y, 1, 1);
    renderer.setRenderTarget(this.target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(scene, camera);
    renderer.readRenderTargetPixels(this.target, 0, 0, 1, 1, this.pixel);
    renderer.setRenderTarget(null);
    camera.clearViewOffset();
    const [px = 0, py = 0, pz = 0, there = 0] = this.pixel;
    return there > 0.5 ? [px, py, pz] : undefined;
  }
}
