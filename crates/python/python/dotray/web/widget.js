// The viewer in a cell of a notebook. The kernel sends the program and the scene when they are asked for.

const fetched = (model) => new Promise((done) => {
  const hear = (content, buffers) => {
    if (!content || !content.names) return;
    model.off("msg:custom", hear);
    const parts = buffers.map((part) => new Uint8Array(part.buffer ?? part, part.byteOffset ?? 0, part.byteLength));
    const [glue, packed, crew, tracer, ...files] = parts;
    done({ glue, packed, crew, tracer, files: content.names.map((name, index) => [name, files[index]]) });
  };
  model.on("msg:custom", hear);
  model.send("files");
});

const script = (text) => URL.createObjectURL(new Blob([text], { type: "text/javascript" }));

// How many tracers a cell has at most: there may be many cells.
const MOST = 4;

// Threads that run the same program; where the page allows none, the viewer traces by itself.
const tracers = async (glue, program, crew, tracer) => {
  const own = new TextDecoder().decode(tracer).replace("./rayview.js", glue);
  try {
    return await (await import(/* webpackIgnore: true */ script(crew))).crew(program, script(own), MOST);
  } catch {
    return undefined;
  }
};

const startIn = async (model, canvas, say) => {
  const { glue, packed, crew, tracer: part, files } = await fetched(model);
  const whole = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const program = await WebAssembly.compile(await new Response(whole).arrayBuffer());
  // Each cell has the program's JavaScript for itself: it can be started once.
  const address = script(glue);
  const { default: start } = await import(/* webpackIgnore: true */ address);
  const tracer = await tracers(address, program, crew, part);
  const given = { canvas, tracer, files, small: true };
  const begun = new Promise((done) => { given.say = (text) => { say(text); done(); }; });
  globalThis.rayview = given;
  await start({ module_or_path: program });
  await begun;
  return () => { given.stop?.(); tracer?.terminate(); };
};

const render = ({ model, el }) => {
  const canvas = document.createElement("canvas");
  canvas.style.cssText = "display: block; width: 100%; outline: none; touch-action: none;";
  canvas.style.height = `${model.get("height")}px`;
  canvas.tabIndex = 0;
  const message = document.createElement("p");
  const say = (text) => { message.textContent = text; message.hidden = text === ""; };
  say("loading the viewer …");
  el.append(message, canvas);
  // The program finds its canvas by one name, so cells start one after the other.
  const turn = (globalThis.rayviewTurn ?? Promise.resolve()).then(() => startIn(model, canvas, say));
  globalThis.rayviewTurn = turn.catch(() => undefined);
  turn.catch((fault) => say(`The viewer cannot be shown here: ${fault}`));
  return () => turn.then((stop) => stop(), () => undefined);
};

export default { render };
