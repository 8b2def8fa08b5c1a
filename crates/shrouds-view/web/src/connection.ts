// The way to the program: numbered requests, their answers, events and binary frames.

import { decode, type Answer, type Frame } from "./frames.ts";

export interface Handlers {
  event(name: string, event: Record<string, unknown>): void;
  frame(frame: Frame): void;
  /** The socket is gone, for the reason given. */
  closed(reason: string): void;
  /** A frame that cannot be read. */
  broken(error: Error): void;
}

interface Waiting {
  resolve(value: unknown): void;
  reject(error: Error): void;
}

/** An answer and the binary frame that came with it. */
export interface Framed<T, F extends Answer> {
  ok: T;
  frame: F;
}

const answers = new Set<Frame["kind"]>(["scalars", "lines", "points", "image"]);

export class Connection {
  private next = 1;
  private readonly waiting = new Map<number, Waiting>();
  private readonly framed = new Map<number, (frame: Answer) => void>();

  private constructor(
    private readonly socket: WebSocket,
    private readonly handlers: Handlers,
  ) {
    socket.addEventListener("message", ({ data }) => this.receive(data as string | ArrayBuffer));
    socket.addEventListener("close", ({ code, reason }) => this.end(code, reason));
  }

  /** Resolves when the socket, on which nothing has come yet, is open. */
  static open(socket: WebSocket, handlers: Handlers): Promise<Connection> {
    socket.binaryType = "arraybuffer";
    const connection = new Connection(socket, handlers);
    if (socket.readyState === WebSocket.OPEN) return Promise.resolve(connection);
    return new Promise((resolve) => socket.addEventListener("open", () => resolve(connection)));
  }

  /** The answer to a request. Rejects with the message of the server. */
  request<T>(name: string, fields: Record<string, unknown> = {}): Promise<T> {
    return this.send(this.next++, name, fields) as Promise<T>;
  }

  /** The answer to a request that is answered with numbers too. */
  async framedRequest<T, F extends Answer>(
    name: string,
    fields: Record<string, unknown>,
  ): Promise<Framed<T, F>> {
    const id = this.next++;
    const frame = new Promise<Answer>((resolve) => this.framed.set(id, resolve));
    try {
      const ok = (await this.send(id, name, fields)) as T;
      return { ok, frame: (await frame) as F };
    } finally {
      this.framed.delete(id);
    }
  }

  /** Says that the newest δ of a view is on the screen, so that the next may come. */
  acknowledge(view: number, revision: number, iteration: number): void {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    this.socket.send(JSON.stringify({ do: "ack", view, revision, iteration }));
  }

  private send(id: number, name: string, fields: Record<string, unknown>): Promise<unknown> {
    if (this.socket.readyState !== WebSocket.OPEN) {
      return Promise.reject(new Error("the program is not connected"));
    }
    const answer = new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
    this.socket.send(JSON.stringify({ id, do: name, ...fields }));
    return answer;
  }

  private receive(data: string | ArrayBuffer): void {
    try {
      if (typeof data === "string") this.text(JSON.parse(data) as Record<string, unknown>);
      else this.binary(decode(data));
    } catch (error) {
      this.handlers.broken(error as Error);
    }
  }

  private binary(frame: Frame): void {
    if (answers.has(frame.kind)) this.framed.get(frame.revision)?.(frame as Answer);
    else this.handlers.frame(frame);
  }

  private text(message: Record<string, unknown>): void {
    if (typeof message.event === "string") return this.handlers.event(message.event, message);
    const waiting = this.waiting.get(message.id as number);
    this.waiting.delete(message.id as number);
    if (message.error === undefined) waiting?.resolve(message.ok);
    else waiting?.reject(new Error(String(message.error)));
  }

  private end(code: number, reason: string): void {
    for (const { reject } of this.waiting.values()) reject(new Error("the connection was lost"));
    this.waiting.clear();
    const full = "Four pages are open already; close one and load this one again.";
    const lost = "The program has ended, or the connection to it was lost.";
    this.handlers.closed(code === 1013 ? reason || full : lost);
  }
}
