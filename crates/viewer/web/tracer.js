// A tracer beside the page: the same program without a canvas. The first message is the program, with the ports of
// those whom it leads, or of the one who leads it.
import start from "./rayview.js";

// The page withdraws this address when something cannot wait: where it shares no memory, the one thing that a thread
// can learn in the midst of work.
let address;

const reaches = (address) => {
  try {
    const request = new XMLHttpRequest();
    request.open("GET", address, false);
    request.send();
    return request.status === 200;
  } catch {
    return false;
  }
};

// Whether this browser knows what is withdrawn.
const canBeStopped = () => {
  const address = URL.createObjectURL(new Blob(["."]));
  const before = reaches(address);
  URL.revokeObjectURL(address);
  return before && !reaches(address);
};

// As soon as the messages that wait were taken; timers would wait for some milliseconds more.
const { port1, port2 } = new MessageChannel();
const waiting = [];
port1.onmessage = () => waiting.shift()();
const later = (call) => { waiting.push(call); port2.postMessage(0); };

addEventListener("message", ({ data }) => {
  if (data.turn) {
    address = data.address;
    globalThis.rayview.turn = data.turn;
  }
  if (data.program) {
    const asked = () => Boolean(address) && !reaches(address);
    const counted = () => Atomics.load(data.count, 0) > globalThis.rayview.turn;
    const stopped = data.count ? counted : canBeStopped() ? asked : undefined;
    Object.assign(globalThis.rayview, { mates: data.mates, leader: data.leader, later, stopped });
    start({ module_or_path: data.program });
  }
});
globalThis.rayview = { turn: 0 };
