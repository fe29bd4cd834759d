// The line to the server.

/** Time from one try to the next, ms. */
const AGAIN = 1000;

/**
 * Keeps a WebSocket to the server, and tells what comes: `arm(message)`, `history(buffer)`, `rows(message)`,
 * `status(message)`, `skipped(count)`, `gone()`.
 */
export class Feed {
  constructor(tell) {
    this.tell = tell;
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(`ws://${location.host}/feed`);
    this.socket.onmessage = ({ data }) => this.take(JSON.parse(data));
    this.socket.onclose = () => {
      this.tell.gone();
      setTimeout(() => this.connect(), AGAIN);
    };
  }

  take(message) {
    switch (message.type) {
      case 'arm':
        // Rows that come before the history are kept until it is here.
        this.waiting = [];
        this.tell.arm(message);
        this.catchUp();
        break;
      case 'rows':
        if (this.waiting) this.waiting.push(message); else this.tell.rows(message);
        break;
      case 'status':
        this.tell.status(message);
        break;
      case 'skipped':
        this.tell.skipped(message.messages);
        break;
    }
  }

  /** Fetches what this page has missed. */
  async catchUp() {
    this.waiting ??= [];
    try {
      const answer = await fetch('/history');
      if (answer.ok) this.tell.history(await answer.arrayBuffer());
    } catch {
      // The server is gone; the socket says so.
    }
    const waiting = this.waiting ?? [];
    this.waiting = null;
    waiting.forEach((message) => this.tell.rows(message));
  }

  /** Says which batch is on the screen. */
  shown(newest_us) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ shown_us: newest_us }));
  }
}

/** Asks the server for something; gives its answer, or throws what it says. */
export async function ask(path, body, token) {
  const headers = { 'Content-Type': 'application/json' };
  if (token) headers.Authorization = `Bearer ${token}`;
  const answer = await fetch(path, { method: 'POST', headers, body: JSON.stringify(body) }).catch(() => {
    throw new Error('the monitor does not answer');
  });
  const text = await answer.text();
  if (!answer.ok) throw Object.assign(new Error(text), { status: answer.status });
  return text ? JSON.parse(text) : null;
}
