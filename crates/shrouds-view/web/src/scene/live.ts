// Numbers of the vertices that change while a solver works.

import { GLBufferAttribute, type BufferAttribute } from "three";

/** Goes to the graphics card when it is written, not with the next picture, which may be late. */
export class LiveArray {
  readonly attribute: BufferAttribute;
  private readonly buffer: WebGLBuffer;

  constructor(
    private readonly gl: WebGL2RenderingContext,
    readonly values: Float32Array,
  ) {
    this.buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    // Geometries take both kinds; their types do not say so.
    this.attribute = new GLBufferAttribute(this.buffer, gl.FLOAT, 1, 4, values.length) as unknown as BufferAttribute;
  }

  write(values: Float32Array): void {
    const { gl } = this;
    this.values.set(values.subarray(0, this.values.length));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, this.values);
    gl.flush();
  }

  dispose(): void {
    this.gl.deleteBuffer(this.buffer);
  }
}
