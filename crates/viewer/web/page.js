// Starts the application in the page's canvas with a tracer beside it, and says in words where there is nothing to see.
import start from "./rayview.js";

const message = document.getElementById("message");

// Where WebGPU has failed, the page begins anew under this mark, draws by WebGL2, and says so for a while, but never over
// a picture: what a hand does takes the words away.
const MARK = "#webgl2";
const instead = location.hash === MARK ? "WebGPU does not work in this browser: WebGL2 draws." : "";
const say = (text) => { message.textContent = text || instead; };
const heard = () => { if (message.textContent === instead) message.textContent = ""; };
if (instead) {
  setTimeout(heard, 15000);
  for (const deed of ["drop", "pointerdown", "keydown"]) addEventListener(deed, heard, { capture: true });
}

// Whether the application has a device of WebGPU.
let drawsByWebGPU = false;
const beginAnew = () => {
  location.hash = MARK;
  location.reload();
};
if (instead) {
  Object.defineProperty(navigator, "gpu", { value: undefined });
} else if (globalThis.GPUAdapter) {
  const request = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...more) {
    const device = await request.apply(this, more);
    drawsByWebGPU = true;
    device.lost.then(({ reason }) => { if (reason !== "destroyed") beginAnew(); });
    return device;
  };
}

const stopped = (fault) => drawsByWebGPU ? beginAnew() :
  say(`The application has stopped; load the page again. Perhaps it needs more memory than there is. (${fault})`);
addEventListener("error", (event) => stopped(event.message));
addEventListener("unhandledrejection", (event) => stopped(event.reason));

// How many tracers there are at most: each holds the scene, and the leader deals the tiles out to all.
const MOST = 8;

// Threads that run the same program, the first of which leads; without one the page traces by itself.
const crew = (program) => new Promise((found) => {
  const threads = Math.min(Math.max(navigator.hardwareConcurrency || 1, 1), MOST);
  const channels = Array.from({ length: threads - 1 }, () => new MessageChannel());
  // What cannot wait is counted where all tracers look now and then, and so stops what they trace. Pages that share no
  // memory with threads, since their server does not part them from all others, withdraw an address instead, for which
  // the tracers ask.
  let turn = 0, address;
  const count = globalThis.crossOriginIsolated ? new Int32Array(new SharedArrayBuffer(4)) : undefined;
  const cannotWait = () => {
    turn += 1;
    if (count) {
      Atomics.store(count, 0, turn);
    } else {
      URL.revokeObjectURL(address);
      address = URL.createObjectURL(new Blob(["."]));
    }
  };
  const begun = (message, ports) => {
    const worker = new Worker(new URL("tracer.js", import.meta.url), { type: "module" });
    worker.postMessage({ program, count, ...message }, ports);
    return worker;
  };
  const ports = channels.map(({ port1 }) => port1);
  const leader = begun({ mates: ports }, ports);
  const mates = channels.map(({ port2 }) => begun({ leader: port2 }, [port2]));
  const tracer = {
    threads,
    postMessage: (bytes, urgent) => {
      if (urgent) {
        cannotWait();
        mates.forEach((mate) => mate.postMessage({ turn, address }));
      }
      leader.postMessage({ bytes, turn, address }, [bytes.buffer]);
    },
    set onmessage(heard) { leader.onmessage = heard; },
  };
  leader.onmessage = () => found(tracer);
  leader.onerror = () => {
    mates.forEach((mate) => mate.terminate());
    found(undefined);
  };
});

// The program that has served this page. What it sends before the application listens is kept.
const server = (address) => new Promise((found, failed) => {
  const socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  let listener, early = [];
  const hear = (event) => { if (listener) listener(event); else early.push(event); };
  const tracer = {
    postMessage: (bytes) => socket.send(bytes),
    set onmessage(heard) { listener = heard; early.splice(0).forEach(heard); },
  };
  socket.onmessage = hear;
  socket.onopen = () => found(tracer);
  socket.onclose = () => { hear({ data: null }); failed("the program that has served this page does not answer"); };
});

const run = async () => {
  const program = await WebAssembly.compileStreaming(fetch(new URL("rayview_bg.wasm", import.meta.url)));
  const socket = document.body.dataset.socket;
  const tracer = socket ? await server(new URL(socket, location).href.replace(/^http/, "ws")) : await crew(program);
  globalThis.rayview = { canvas: document.getElementById("view"), say, tracer, packing: Boolean(socket) };
  await start({ module_or_path: program });
};
run().catch((fault) => say(`This browser cannot run the page: ${fault}`));
