// Messages of a recording, which lie in this file. The same interface as live_source.js.
import { decode } from "simvis/messages.js";

async function bytesOf(id) {
  const text = document.getElementById(id).textContent;
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

function messagesOf(buffer) {
  const view = new DataView(buffer),
    messages = [];
  for (let place = 0; place < buffer.byteLength;) {
    const binary = view.getUint32(place, true),
      length = view.getUint32(place + 4, true);
    messages.push(
      binary
        ? decode(buffer, place + 8, length)
        : decode(new TextDecoder().decode(new Uint8Array(buffer, place + 8, length))),
    );
    place += 8 + Math.ceil(length / 8) * 8;
  }
  return messages;
}

/** The last frame that is not later. */
const numberAt = (frames, time_s) => Math.max(0, frames.filter((frame) => frame.time_s <= time_s).length - 1);

const isMeasured = (message) => message.op === "scan" || message.op === "image";

/** The frame that the link names: PAGE.html#frame=12. Without one the first. */
const firstShown = () => Number(new URLSearchParams(location.hash.slice(1)).get("frame")) || 0;

export function open(onMessage, onState) {
  const { frames } = JSON.parse(document.getElementById("recording").textContent);
  let shown = -1,
    wanted = -1,
    working = false,
    playing = false,
    speed = 1,
    timer = 0,
    loop = 0, // counts how often play and pause were pressed
    keyed = { key: -1, messages: [] }; // the last key frame that was read
  onState("recording", false);

  async function messagesOfKey(key) {
    if (keyed.key !== key) keyed = { key, messages: messagesOf(await bytesOf(`frame-${key}`)) };
    return keyed.messages;
  }

  /** A frame with its place in the recording, and the warnings that came with it. */
  function ofRecording(message, number) {
    const news = message.warnings.slice(number > 0 ? frames[number - 1].warnings : 0);
    return { ...message, playing, number, count: frames.length, news };
  }

  /**
   * A frame's state is a difference from its key frame, which is therefore shown before it: what the frame before has
   * changed may be as in the key frame again. The last measurement of a sensor may be older.
   */
  async function show(number) {
    const { key } = frames[number];
    const known = shown >= 0 && frames[shown].key === key;
    const isOfScene = (m) => m.op === "scene" || m.op === "bodies";
    const begin = (await messagesOfKey(key)).filter(
      (m) => !isMeasured(m) && m.op !== "frame" && !(known && isOfScene(m)),
    );
    const own = messagesOf(await bytesOf(`frame-${number}`));
    const missing = new Set(known && number === shown + 1 ? [] : frames.slice(key, number).flatMap((f) => f.sensors));
    for (const sensor of frames[number].sensors) missing.delete(sensor);
    const older = [];
    for (const sensor of missing) {
      let last = number - 1;
      while (!frames[last].sensors.includes(sensor)) --last;
      older.push(...messagesOf(await bytesOf(`frame-${last}`)).filter((m) => isMeasured(m) && m.sensor === sensor));
    }
    shown = number;
    if (known) await onMessage({ op: "shapes", shapes: [] }); // as in the scene, unless a message says otherwise
    const newer = number === key && !known ? own : own.filter((m) => !isOfScene(m));
    for (const message of number === key ? newer : [...begin, ...older, ...newer]) {
      await onMessage(message.op === "frame" ? ofRecording(message, number) : message);
    }
  }

  async function seek(number) {
    wanted = Math.trunc(Math.max(0, Math.min(frames.length - 1, number))) || 0;
    if (working) return;
    working = true;
    try {
      while (shown !== wanted) await show(wanted);
    } finally {
      working = false;
    }
  }

  function advance() {
    if (!playing) return;
    if (shown >= frames.length - 1) return setPlaying(false);
    const wait = speed > 0 ? (frames[shown + 1].time_s - frames[shown].time_s) / speed : 0;
    const began = performance.now(),
      own = loop;
    seek(shown + 1).then(() => {
      if (own === loop) timer = setTimeout(advance, Math.max(0, 1000 * wait - (performance.now() - began)));
    });
  }

  async function setPlaying(on) {
    clearTimeout(timer);
    ++loop;
    if (on && shown >= frames.length - 1) await seek(0);
    playing = on;
    onMessage({ op: "playing", playing });
    advance();
  }

  const commands = {
    play: () => setPlaying(true),
    pause: () => setPlaying(false),
    step: () => {
      setPlaying(false);
      return seek(shown + 1);
    },
    seek: ({ frame, time_s }) => seek(frame ?? numberAt(frames, time_s)),
    speed: ({ factor }) => {
      speed = factor;
    },
  };
  return {
    recorded: true,
    async start() {
      await seek(firstShown());
      await onMessage(JSON.parse(new TextDecoder().decode(await bytesOf("series"))));
    },
    send: (message) => commands[message.op]?.(message),
    glb: (name) => bytesOf(name),
  };
}
