// The worker of the page that needs no program: runs the pipeline, a WebAssembly module, and lets its time pass; with Bluetooth the page does.

const PERIOD = 10;
const encoder = new TextEncoder();
const decoder = new TextDecoder();
let program = null;
/** From this worker's clock to the page's, in ms. */
let ahead = 0;

function give(bytes) {
  const address = program.input(bytes.length);
  new Uint8Array(program.memory.buffer, address, bytes.length).set(bytes);
}

/** Calls a function of the module at a time of the page, and posts what it says: a JSON array. */
function call(name, now = performance.now() + ahead) {
  const length = program[name](now);
  if (length > "[]".length) {
    postMessage(decoder.decode(new Uint8Array(program.memory.buffer, program.output(), length)));
  }
}

async function begin({ code, model, file, wanted, origin, ticks }) {
  ahead = performance.timeOrigin - origin;
  const unpacked = new Response(new Blob([code]).stream().pipeThrough(new DecompressionStream("gzip")));
  const { instance } = await WebAssembly.instantiate(await unpacked.arrayBuffer());
  program = instance.exports;
  for (const [name, bytes] of [["model", model], ["file", file]]) {
    if (bytes) {
      give(bytes);
      program[name]();
    }
  }
  give(encoder.encode(wanted));
  call("open");
  // Bluetooth has time pass itself.
  if (ticks) {
    setInterval(() => call("tick"), PERIOD);
  }
}

onmessage = ({ data }) => {
  if (data.code) {
    begin(data).catch((error) => setTimeout(() => {
      throw error;
    }));
  } else if (program) {
    if (data.file) {
      give(typeof data.file === "string" ? encoder.encode(data.file) : data.file);
      program.file();
    }
    if (data.heard === "") {
      call("tick", data.now);
      return;
    }
    give(data.heard ?? encoder.encode(data.request));
    call(data.heard ? "heard" : "request", data.now);
  }
};
