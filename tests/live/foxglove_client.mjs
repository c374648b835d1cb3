// A client of Foxglove's own packages: decodes a scan, an image and a cloud, and sets a parameter. Prints JSON.
// Arguments: URL, sub-protocol, folder of node_modules.
import { createRequire } from "node:module";
const require = createRequire(process.argv[4] + "/");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const WebSocket = require("ws");

const [, , url, protocol] = process.argv;
const client = new FoxgloveClient({ ws: new WebSocket(url, [protocol]) });
const wanted = new Map([["/SCAN/scan", "scan"], ["/CAM/image_raw", "image"], ["/SCAN/points", "points"]]);
const readers = new Map();
const found = { protocol };

function finishIfWhole() {
  if (!["scan", "image", "points", "parameter"].every((key) => key in found)) return;
  console.log(JSON.stringify(found));
  process.exit(0);
}
client.on("error", (error) => { console.error(String(error)); process.exit(1); });
client.on("serverInfo", (info) => {
  found.server = info.name;
  client.setParameters([{ name: "MOVE.x", value: 0.25 }], "request");
});
client.on("advertise", (channels) => {
  for (const channel of channels) {
    if (!wanted.has(channel.topic)) continue;
    const reader = new MessageReader(parse(channel.schema, { ros2: true }));
    readers.set(client.subscribe(channel.id), { reader, key: wanted.get(channel.topic) });
  }
});
client.on("message", ({ subscriptionId, data }) => {
  const { reader, key } = readers.get(subscriptionId);
  const message = reader.readMessage(data);
  if (key === "scan") found.scan = { frame: message.header.frame_id, ranges: message.ranges.length };
  if (key === "image") found.image = { width: message.width, encoding: message.encoding, bytes: message.data.length };
  if (key === "points") found.points = { width: message.width, fields: message.fields.map((field) => field.name) };
  finishIfWhole();
});
client.on("parameterValues", ({ parameters, id }) => {
  if (id === "request") found.parameter = parameters[0];
  finishIfWhole();
});
setTimeout(() => { console.error("not all has come: " + JSON.stringify(found)); process.exit(2); }, 60000);
