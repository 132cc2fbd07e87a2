// Where the instrument is: in a worker of this page, or on a board at a serial port. Both carry bytes and nothing else.

const BAUD = 115200;

// What the page holds as text: the worker's script and the two modules.
function heldScript(id) {
  return document.getElementById(id).textContent;
}

function heldModule(id) {
  const text = atob(heldScript(id).trim());
  return Uint8Array.from(text, (character) => character.charCodeAt(0));
}

function makeWorker() {
  const address = URL.createObjectURL(new Blob([heldScript('script-worker')], {type: 'text/javascript'}));
  const worker = new Worker(address);
  URL.revokeObjectURL(address);
  return worker;
}

class SimulatedPort {
  // device: S, f0 and beta of what is mounted on the simulated bench; three zeros for the usual one.
  // pace: seconds of the bench per second; 0 for as fast as it goes.
  static open(device, store, pace = 0) {
    return new Promise((resolve, reject) => {
      const port = new SimulatedPort(makeWorker());
      port.worker.onerror = (event) => reject(new Error(event.message || 'the instrument does not start'));
      port.worker.onmessage = ({data}) => {
        if (data.isRefused) {
          port.worker.terminate();
          reject(new Error('the simulated bench has no such device; S and f0 above 0, beta between 0 and 1'));
          return;
        }
        port.commands = data.commands;
        port.worker.onmessage = (event) => port.take(event.data);
        port.worker.onerror = (event) => port.onend(`the instrument in this page has failed: ${event.message}`);
        resolve(port);
      };
      port.worker.postMessage({kind: 'start', module: heldModule('module-instrument'), device, store, pace});
    });
  }

  constructor(worker) {
    this.worker = worker;
    this.name = 'simulated bench in this page';
    this.isSettled = true;
    this.sent = 0;
    this.onbytes = () => {};
    this.onstore = () => {};
    this.onend = () => {};
  }

  take(message) {
    if (message.kind === 'store') {
      this.onstore(message.bytes);
    } else {
      this.isSettled = message.isSettled && message.taken === this.sent;
      this.onbytes(message.bytes);
    }
  }

  write(bytes) {
    this.isSettled = false;
    this.sent += bytes.length;
    this.worker.postMessage({kind: 'bytes', bytes});
  }

  clear() {
    this.worker.postMessage({kind: 'clear'});
  }

  async close() {
    this.worker.terminate();
  }
}

class SerialPort {
  static async open() {
    const serial = await navigator.serial.requestPort();
    await serial.open({baudRate: BAUD, bufferSize: 65536});
    return new SerialPort(serial);
  }

  constructor(serial) {
    this.serial = serial;
    this.name = 'board at a serial port';
    this.onbytes = () => {};
    this.onend = () => {};
    this.writer = serial.writable.getWriter();
    this.reader = serial.readable.getReader();
    this.isOpen = true;
    this.done = this.readOn();
  }

  async readOn() {
    let reason = 'the serial port was closed';
    try {
      for (;;) {
        const {value, done} = await this.reader.read();
        if (done) {
          break;
        }
        this.onbytes(value);
      }
    } catch (error) {
      reason = `the serial port is gone: ${error.message}`;
    }
    this.end(reason);
  }

  end(reason) {
    if (this.isOpen) {
      this.isOpen = false;
      this.onend(reason);
    }
  }

  write(bytes) {
    this.writer.write(bytes).catch((error) => this.end(`the serial port is gone: ${error.message}`));
  }

  // Device clear.
  async clear() {
    await this.serial.setSignals({break: true});
    await new Promise((resolve) => setTimeout(resolve, 5));
    await this.serial.setSignals({break: false});
  }

  async close() {
    this.isOpen = false;
    try {
      await this.reader.cancel();
      await this.done;
      this.reader.releaseLock();
      this.writer.releaseLock();
      await this.serial.close();
    } catch {
      // It was unplugged, so there is nothing left to close.
    }
  }
}
