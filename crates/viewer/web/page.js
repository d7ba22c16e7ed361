// Starts the application in the page's canvas with a tracer beside it, and says in words where there is nothing to see.
import start from "./rayview.js";
import { crew } from "./crew.js";

const message = document.getElementById("message");

// Where WebGPU has failed, the page begins anew under the first mark, draws by WebGL2, and says so for a while, but
// never over a picture: what a hand does takes the words away. The second one is chosen by hand: nothing has failed.
const [FAILED, CHOSEN] = ["#webgl2-instead", "#webgl2"];
const instead = location.hash === FAILED ? "WebGPU does not work in this browser: WebGL2 draws." :
  location.hash === CHOSEN ? "WebGL2 draws, as the address asks." : "";
const say = (text) => { message.textContent = text || instead; };
const heard = () => { if (message.textContent === instead) message.textContent = ""; };
if (instead) {
  setTimeout(heard, 15000);
  for (const deed of ["drop", "pointerdown", "keydown"]) addEventListener(deed, heard, { capture: true });
}

// Whether the application has a device of WebGPU.
let drawsByWebGPU = false;
const beginAnew = () => {
  location.hash = FAILED;
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

// How many tracers there are at most: each holds the scene.
const MOST = 8;

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
  const tracer = socket ? await server(new URL(socket, location).href.replace(/^http/, "ws")) :
    await crew(program, new URL("tracer.js", import.meta.url), MOST);
  globalThis.rayview = { canvas: document.getElementById("view"), say, tracer, packing: Boolean(socket) };
  await start({ module_or_path: program });
};
run().catch((fault) => say(`This browser cannot run the page: ${fault}`));
