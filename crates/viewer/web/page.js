// Starts the application in the page's canvas with a tracer beside it, and says in words where there is nothing to see.
import start from "./rayview.js";

const message = document.getElementById("message");
const say = (text) => { message.textContent = text; };

const stopped = (fault) =>
  say(`The application has stopped; load the page again. Perhaps it needs more memory than there is. (${fault})`);
addEventListener("error", (event) => stopped(event.message));
addEventListener("unhandledrejection", (event) => stopped(event.reason));

// How many tracers there are at most: each holds the scene, and the leader deals the tiles out to all.
const MOST = 8;

// Threads that run the same program, the first of which leads; without one the page traces by itself.
const crew = (program) => new Promise((found) => {
  const threads = Math.min(Math.max(navigator.hardwareConcurrency || 1, 1), MOST);
  const channels = Array.from({ length: threads - 1 }, () => new MessageChannel());
  const begun = (message, ports) => {
    const worker = new Worker(new URL("tracer.js", import.meta.url), { type: "module" });
    worker.postMessage({ program, ...message }, ports);
    return worker;
  };
  const ports = channels.map(({ port1 }) => port1);
  const leader = begun({ mates: ports }, ports);
  const mates = channels.map(({ port2 }) => begun({ leader: port2 }, [port2]));
  // What cannot wait withdraws the address that all tracers ask for now and then, and so stops what they trace.
  let turn = 0, address;
  const tracer = {
    threads,
    postMessage: (bytes, urgent) => {
      if (urgent) {
        URL.revokeObjectURL(address);
        address = URL.createObjectURL(new Blob(["."]));
        turn += 1;
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
