// Runs one of the two modules, apart from the page: what computes must not hold up what somebody types.
'use strict';

const BUSY = 1;
const WORKING = 2;
const SETTLED = 4;
const RESTING = 16;
const REST_MS = 4;
const SLICE_MS = 10;
const ERASED = 0xff;

let memory = null;
let instrument = null;
let desk = null;
let input = new Uint8Array(0);
let output = [];
let store = new Uint8Array(0);
let storeChanged = false;
let clears = false;
let scheduled = false;
let taken = 0;

const turn = new MessageChannel();
turn.port1.onmessage = runInstrument;

const bytesAt = (at, size) => new Uint8Array(memory.buffer, at, size);

// What the instrument's module imports (instrument/imports.hpp).
const imports = {
  emax: {
    read(at, size) {
      const count = Math.min(size, input.length);
      bytesAt(at, count).set(input.subarray(0, count));
      input = input.subarray(count);
      taken += count;
      return count;
    },
    write(at, size) {
      output.push(bytesAt(at, size).slice());
    },
    take_break() {
      const asked = clears;
      clears = false;
      return asked ? 1 : 0;
    },
    now_us: () => performance.now() * 1000,
    store_read(offset, at, size) {
      bytesAt(at, size).set(store.subarray(offset, offset + size));
    },
    store_write(offset, at, size) {
      store.set(bytesAt(at, size), offset);
      storeChanged = true;
    },
  },
};

function join(pieces) {
  const all = new Uint8Array(pieces.reduce((size, piece) => size + piece.length, 0));
  let at = 0;
  for (const piece of pieces) {
    all.set(piece, at);
    at += piece.length;
  }
  return all;
}

function schedule() {
  if (!scheduled && instrument) {
    scheduled = true;
    turn.port2.postMessage(null);
  }
}

function runInstrument() {
  scheduled = false;
  const end = performance.now() + SLICE_MS;
  let state = 0;
  do {
    state = instrument.emax_poll();
  } while (state & BUSY && !(state & RESTING) && performance.now() < end);
  const bytes = join(output);
  output = [];
  const isSettled = Boolean(state & SETTLED) && (!(state & BUSY) || Boolean(state & WORKING));
  if (bytes.length > 0 || isSettled) {
    self.postMessage({kind: 'bytes', bytes, isSettled, taken});
  }
  if (storeChanged) {
    storeChanged = false;
    self.postMessage({kind: 'store', bytes: store.slice()});
  }
  if (state & RESTING) {
    scheduled = true;
    setTimeout(runInstrument, REST_MS);
  } else if (state & BUSY) {
    schedule();
  }
}

function start(message) {
  instrument = new WebAssembly.Instance(new WebAssembly.Module(message.module), imports).exports;
  memory = instrument.memory;
  store = new Uint8Array(instrument.emax_store_bytes()).fill(ERASED);
  if (message.store && message.store.length === store.length) {
    store.set(message.store);
  }
  output = [];
  instrument.emax_list_commands();
  const commands = new TextDecoder().decode(join(output));
  output = [];
  instrument.emax_set_pace(message.pace);
  const isRefused = instrument.emax_start(...message.device) !== 0;
  self.postMessage({kind: 'started', isRefused, commands});
  if (isRefused) {
    instrument = null;
  }
}

// Words, each behind its length in four bytes.
function answerDesk(message) {
  if (!desk) {
    desk = new WebAssembly.Instance(new WebAssembly.Module(message.module), {}).exports;
  }
  const encoder = new TextEncoder();
  const pieces = [];
  for (const word of message.words) {
    const bytes = typeof word === 'string' ? encoder.encode(word) : word;
    const length = new Uint8Array(4);
    new DataView(length.buffer).setUint32(0, bytes.length, true);
    pieces.push(length, bytes);
  }
  const request = join(pieces);
  const at = desk.emax_request(request.length);
  new Uint8Array(desk.memory.buffer, at, request.length).set(request);
  const status = desk.emax_answer(request.length);
  const text = new Uint8Array(desk.memory.buffer, desk.emax_answer_text(), desk.emax_answer_size());
  self.postMessage({kind: 'desk', status, text: new TextDecoder().decode(text.slice())});
}

self.onmessage = ({data}) => {
  if (data.kind === 'start') {
    start(data);
  } else if (data.kind === 'desk') {
    answerDesk(data);
  } else if (data.kind === 'bytes') {
    input = join([input, data.bytes]);
    schedule();
  } else if (data.kind === 'clear') {
    input = new Uint8Array(0);
    clears = true;
    schedule();
  }
};
