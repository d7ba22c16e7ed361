// Tracers beside a page: threads that run the same program, the first of which leads and deals tiles out to the others.

// As many as the machine has cores, but at most so many, of a tracer's JavaScript; nothing where there can be none, and
// the page traces by itself.
export const crew = (program, tracer, most) => new Promise((found) => {
  const threads = Math.min(Math.max(navigator.hardwareConcurrency || 1, 1), most);
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
    const worker = new Worker(tracer, { type: "module" });
    worker.postMessage({ program, count, ...message }, ports);
    return worker;
  };
  const ports = channels.map(({ port1 }) => port1);
  const leader = begun({ mates: ports }, ports);
  const mates = channels.map(({ port2 }) => begun({ leader: port2 }, [port2]));
  const all = {
    threads,
    postMessage: (bytes, urgent) => {
      if (urgent) {
        cannotWait();
        mates.forEach((mate) => mate.postMessage({ turn, address }));
      }
      leader.postMessage({ bytes, turn, address }, [bytes.buffer]);
    },
    set onmessage(heard) { leader.onmessage = heard; },
    terminate: () => [leader, ...mates].forEach((worker) => worker.terminate()),
  };
  leader.onmessage = () => found(all);
  leader.onerror = () => {
    all.terminate();
    found(undefined);
  };
});
