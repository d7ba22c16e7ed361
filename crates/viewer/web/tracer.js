// The tracer beside the page: the same program without a canvas. The first message is the program.
import start from "./rayview.js";

onmessage = ({ data }) => {
  globalThis.rayview = {};
  start({ module_or_path: data });
};
