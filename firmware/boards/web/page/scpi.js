// The page as an SCPI client: one message after the other, each followed by a question for its errors.

const MARK = 'SYST:ERR:ALL?;:SYST:VERS?';
const MARKED = /^(-?\d+,".*");1999\.0$/;
const NO_ERROR = '0,"No error"';
const ANSWER_LIMIT_MS = 8000;
const CLEAR_MS = 200;

// What the instrument has refused, in its words.
class Refusal extends Error {}

// `-222,"Data out of range;limit",-113,"..."` as its lines.
function linesOfErrors(text) {
  return text === NO_ERROR ? [] : text.match(/-?\d+,"(?:[^"]|"")*"/g) ?? [text];
}

class Scpi {
  constructor(port) {
    this.port = port;
    this.buffer = new Uint8Array(0);
    this.waiting = null;
    this.messages = [];
    this.turn = Promise.resolve();
    this.ended = null;
    this.isCleared = false;
    this.onwarning = () => {};
    this.onraw = () => {};
    port.onbytes = (bytes) => this.take(bytes);
    const onend = port.onend;
    port.onend = (reason) => {
      this.ended = new Error(reason);
      this.wake();
      onend(reason);
    };
  }

  take(bytes) {
    this.onraw(bytes);
    const all = new Uint8Array(this.buffer.length + bytes.length);
    all.set(this.buffer);
    all.set(bytes, this.buffer.length);
    this.buffer = all;
    for (let size = this.sizeOfMessage(); size > 0; size = this.sizeOfMessage()) {
      this.messages.push(this.buffer.slice(0, size - 1));
      this.buffer = this.buffer.slice(size);
    }
    this.wake();
  }

  // With the line feed; 0 while it is not complete. A block has its length in front: #3123...
  sizeOfMessage() {
    const digits = this.buffer[0] === 35 ? this.buffer[1] - 48 : 0;
    if (digits >= 1 && digits <= 9) {
      const length = new TextDecoder().decode(this.buffer.slice(2, 2 + digits));
      const size = 2 + digits + Number(length) + 1;
      return length.length === digits && this.buffer.length >= size ? size : 0;
    }
    return this.buffer.indexOf(10) + 1;
  }

  wake() {
    if (this.waiting) {
      this.waiting();
      this.waiting = null;
    }
  }

  // The next message as text, a block without its front.
  async next(limit) {
    const end = Date.now() + limit;
    while (this.messages.length === 0 || this.isCleared) {
      if (this.ended) {
        throw this.ended;
      }
      if (this.isCleared) {
        throw new Error('cleared');
      }
      if (Date.now() >= end) {
        throw new Error('the instrument does not answer; check cable and baud rate, and that it runs emax');
      }
      await new Promise((resolve) => {
        const timer = setTimeout(resolve, end - Date.now());
        this.waiting = () => {
          clearTimeout(timer);
          resolve();
        };
      });
    }
    const message = this.messages.shift();
    const front = message[0] === 35 ? 2 + message[1] - 48 : 0;
    return new TextDecoder().decode(message.slice(front));
  }

  inTurn(work) {
    const mine = this.turn.then(work);
    this.turn = mine.catch(() => {});
    return mine;
  }

  write(line) {
    if (this.ended) {
      throw this.ended;
    }
    this.port.write(new TextEncoder().encode(`${line}\n`));
  }

  // All answers of a line, and the errors that came with it.
  exchange(line, limit = ANSWER_LIMIT_MS) {
    return this.inTurn(async () => {
      if (this.isCleared) {
        await new Promise((resolve) => setTimeout(resolve, CLEAR_MS));  // What was under way has arrived by then.
        Object.assign(this, {isCleared: false, buffer: new Uint8Array(0), messages: []});
      }
      this.write(line);
      this.write(MARK);
      const answers = [];
      for (;;) {
        const message = await this.next(limit);
        const marked = MARKED.exec(message);
        if (marked) {
          return {answers, errors: linesOfErrors(marked[1])};
        }
        answers.push(message);
      }
    });
  }

  // Settings and commands.
  async tell(line) {
    const {errors} = await this.exchange(line);
    if (errors.length > 0) {
      throw new Refusal(errors.join('; '));
    }
  }

  // A question with one answer.
  async ask(line, limit) {
    const {answers, errors} = await this.exchange(line, limit);
    if (answers.length !== 1) {
      throw new Refusal(errors.join('; ') || `no answer to ${line}`);
    }
    if (errors.length > 0) {
      this.onwarning(errors);
    }
    return answers[0];
  }

  // Device clear: what answers or is computed for a question ends; settings, and what INITiate has started, stay.
  async clear() {
    this.isCleared = true;
    await this.port.clear();
    this.wake();
  }

  // Past all that waits: the drive goes to zero at once.
  abort() {
    this.write('ABOR');
  }
}
