// Starts the application in the page's canvas, and says in words where there is nothing to see.
import start from "./rayview.js";

const message = document.getElementById("message");
const say = (text) => { message.textContent = text; };

globalThis.rayview = { canvas: document.getElementById("view"), say };

const stopped = (fault) =>
  say(`The application has stopped; load the page again. Perhaps the scene needs more memory than a page has. (${fault})`);
addEventListener("error", (event) => stopped(event.message));
addEventListener("unhandledrejection", (event) => stopped(event.reason));

start({ module_or_path: new URL("rayview_bg.wasm", import.meta.url) }).catch((fault) => say(`This browser cannot run the page: ${fault}`));
