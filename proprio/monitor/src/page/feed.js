// The connection to the server.

/** Time without a dropped batch after which the missing rows are fetched, ms. */
const CALM = 10_000;
/** Time between two attempts to connect, ms. */
const RETRY = 1000;

/**
 * Keeps a WebSocket to the server and calls these `handlers`: `arm(message)`, `history(buffer)`, `arrived(sent_us)`,
 * `rows(message)`, `status(message)`, `delivery(message)`, `gone()`.
 */
export class Feed {
  constructor(handlers) {
    this.handlers = handlers;
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(`ws://${location.host}/feed`);
    this.socket.onmessage = ({ data }) => this.take(JSON.parse(data));
    this.socket.onclose = () => {
      this.handlers.gone();
      setTimeout(() => this.connect(), RETRY);
    };
  }

  take(message) {
    switch (message.type) {
      case 'arm':
        // Rows that come before the history are kept until it is here.
        this.waiting = [];
        this.handlers.arm(message);
        this.catchUp();
        break;
      case 'rows':
        // The server holds back a page that does not confirm.
        this.send({ taken_us: message.sent_us });
        this.handlers.arrived(message.sent_us);
        if (this.waiting) this.waiting.push(message); else this.handlers.rows(message);
        break;
      case 'status':
        this.handlers.status(message);
        break;
      case 'delivery':
        this.fill(message.skipped);
        this.handlers.delivery(message);
        break;
    }
  }

  /** Fetches the rows that this page has missed. */
  async catchUp() {
    this.waiting ??= [];
    try {
      const answer = await fetch('/history');
      if (answer.ok) this.handlers.history(await answer.arrayBuffer());
    } catch {
      // The server is gone; the socket's `onclose` handles that.
    }
    const waiting = this.waiting ?? [];
    this.waiting = null;
    waiting.forEach((message) => this.handlers.rows(message));
  }

  /** Fetches the rows of batches that the server has dropped, once this page keeps up again. */
  fill(skipped) {
    const now = performance.now();
    if (skipped !== this.skipped) Object.assign(this, { skipped, skippedAt: now, hasGap: skipped > 0 });
    if (!this.hasGap || this.waiting || now - this.skippedAt < CALM) return;
    this.hasGap = false;
    this.catchUp();
  }

  /** Reports the batch that is on the screen. */
  shown(newest_us) { this.send({ shown_us: newest_us }); }

  send(report) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(report));
  }
}

/** Sends a request to the server; returns its answer, or throws its error. */
export async function post(path, body, token) {
  const headers = { 'Content-Type': 'application/json' };
  if (token) headers.Authorization = `Bearer ${token}`;
  const answer = await fetch(path, { method: 'POST', headers, body: JSON.stringify(body) }).catch(() => {
    throw new Error('the monitor does not answer');
  });
  const text = await answer.text();
  if (!answer.ok) throw Object.assign(new Error(text), { status: answer.status });
  return text ? JSON.parse(text) : null;
}
