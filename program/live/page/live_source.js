// Messages of a running simulation, over a WebSocket. The same interface as recorded_source.js.
import { decode } from "simvis/messages.js";

const PROTOCOL = "simvis.live.v1";
const FIRST_WAIT_MS = 500,
  LONGEST_WAIT_MS = 8000;

const address = (name) => new URL(name, location.href);

/** Why there is no connection. Each run has secrets of its own; the browser does not say that a WebSocket was refused. */
async function reason() {
  const answer = await fetch(address("index.html"), { method: "HEAD" }).catch(() => null);
  return answer?.status === 403
    ? "another run is at this address; open the link that it has printed"
    : "no simulation answers; trying again";
}

export function open(onMessage, onState) {
  let socket = null,
    wait = FIRST_WAIT_MS,
    last = null,
    queue = Promise.resolve();

  function connect() {
    const url = address("live");
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    const opened = new WebSocket(url, PROTOCOL);
    socket = opened;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      wait = FIRST_WAIT_MS;
      onState("connected", false);
      if (last) socket.send(last);
    };
    // Messages are taken one after the other: a scene takes a while to load.
    socket.onmessage = ({ data }) => {
      queue = queue.then(() => take(decode(data), opened)).catch(console.error);
    };
    socket.onclose = async () => {
      onState(await reason(), true);
      setTimeout(connect, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    };
  }

  // The simulation sends the next frame when this one is drawn: a slow or hidden page gets fewer.
  async function take(message, from) {
    await onMessage(message);
    if (message.op === "frame") requestAnimationFrame(() => from.send('{"op":"shown"}'));
  }

  return {
    recorded: false,
    start: connect,
    send(message) {
      const text = JSON.stringify(message);
      if (message.op === "look") last = text; // a new connection has to know it
      if (socket?.readyState === WebSocket.OPEN) socket.send(text);
    },
    async glb(name) {
      const response = await fetch(address(name));
      if (!response.ok) throw new Error(`${name}: ${response.status} ${response.statusText}`);
      return response.arrayBuffer();
    },
  };
}
