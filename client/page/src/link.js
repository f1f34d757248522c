// The connection to the program, and its next try when it is lost.

const kWaits_ms = [500, 1000, 2000, 4000, 5000];

/**
 * Keeps a WebSocket to the program that served this page.
 *
 * @param {{message: (message: object) => void, changed: (state: LinkState) => void}} on
 * @typedef {{open: boolean, ever: boolean, lostSince: Date|null, reason: string}} LinkState
 */
export function openLink(on) {
  const state = { open: false, ever: false, lostSince: null, reason: "" };
  let tries = 0;
  let socket = null;

  const address = () => {
    const url = new URL("live", window.location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    url.search = window.location.search;
    return url;
  };

  const connect = () => {
    socket = new WebSocket(address());
    socket.onopen = () => {
      tries = 0;
      Object.assign(state, { open: true, ever: true, lostSince: null, reason: "" });
      on.changed(state);
    };
    socket.onmessage = (event) => {
      let message;
      try {
        message = JSON.parse(event.data);
      } catch {
        return;
      }
      on.message(message);
    };
    socket.onclose = (event) => {
      if (state.open || !state.lostSince) state.lostSince = new Date();
      state.open = false;
      state.reason = event.reason || state.reason;
      on.changed(state);
      window.setTimeout(connect, kWaits_ms[Math.min(tries++, kWaits_ms.length - 1)]);
    };
  };
  connect();

  return {
    /** Sends if the connection is open; what is sent while it is not is lost. */
    send(message) {
      if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
    },
  };
}
