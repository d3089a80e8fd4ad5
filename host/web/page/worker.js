// The worker of the page that needs no program: runs the pipeline, a WebAssembly module, and lets its time pass.

const PERIOD = 10;
const encoder = new TextEncoder();
const decoder = new TextDecoder();
let program = null;

function give(bytes) {
  const address = program.input(bytes.length);
  new Uint8Array(program.memory.buffer, address, bytes.length).set(bytes);
}

/** Calls a function of the module, and posts what it says: a JSON array. */
function call(name) {
  const length = program[name](performance.now());
  if (length > "[]".length) {
    postMessage(decoder.decode(new Uint8Array(program.memory.buffer, program.output(), length)));
  }
}

async function begin({ code, model, file, wanted }) {
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
  setInterval(() => call("tick"), PERIOD);
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
    give(data.heard ?? encoder.encode(data.request));
    call(data.heard ? "heard" : "request");
  }
};
