// Starts the application in the page's canvas with a tracer beside it, and says in words where there is nothing to see.
import start from "./rayview.js";

const message = document.getElementById("message");
const say = (text) => { message.textContent = text; };

const stopped = (fault) =>
  say(`The application has stopped; load the page again. Perhaps it needs more memory than there is. (${fault})`);
addEventListener("error", (event) => stopped(event.message));
addEventListener("unhandledrejection", (event) => stopped(event.reason));

// A thread that runs the same program; without one the page traces by itself.
const worker = (program) => new Promise((found) => {
  const worker = new Worker(new URL("tracer.js", import.meta.url), { type: "module" });
  worker.onmessage = () => found(worker);
  worker.onerror = () => found(undefined);
  worker.postMessage(program);
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
  const tracer = socket ? await server(new URL(socket, location).href.replace(/^http/, "ws")) : await worker(program);
  globalThis.rayview = { canvas: document.getElementById("view"), say, tracer, packing: Boolean(socket) };
  await start({ module_or_path: program });
};
run().catch((fault) => say(`This browser cannot run the page: ${fault}`));
