// Frames from the plant, and commands to it. A lost connection is taken up again by itself.

const WATCH = 2500; // ms without a frame before the connection counts as lost

export async function load(path, kind) {
  const answer = await fetch(path, { cache: "no-store" });
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  if (answer.status === 204) throw new Error(`${path}: nothing`);
  return kind === "json" ? answer.json() : answer.text();
}

/** Calls `onFrame` with every frame and `onLink` with true and false as the connection comes and goes. */
export function listen(onFrame, onLink) {
  let source = null;
  let last = 0;
  let live = false;
  const set = (state) => { if (state !== live) { live = state; onLink(state); } };
  const open = () => {
    if (source) source.close();
    last = performance.now();
    source = new EventSource("/events");
    source.onmessage = (event) => {
      last = performance.now();
      set(true);
      onFrame(JSON.parse(event.data));
    };
    source.onerror = () => set(false);
  };
  open();
  // The browser comes back by itself, except after some answers: then this does.
  setInterval(() => {
    const silent = performance.now() - last > WATCH;
    if (silent) set(false);
    if (silent && source.readyState === EventSource.CLOSED) open();
  }, 500);
}

/** Asks the server to do something; resolves to an empty text or to why it was refused. */
export async function ask(path, wish) {
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(wish),
    });
    return answer.ok ? "" : (await answer.text()).trim();
  } catch {
    return "the plant does not answer";
  }
}

/** Sends a command. */
export const send = (command) => ask("/command", command);
