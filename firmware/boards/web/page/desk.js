// What the PC program does beside the instrument: reading tables and comparing devices, by its own code.

class Desk {
  constructor() {
    this.worker = null;
    this.turn = Promise.resolve();
  }

  // The answer's text, or an error with the program's own line.
  ask(...words) {
    const mine = this.turn.then(() => this.askNow(words));
    this.turn = mine.catch(() => {});
    return mine;
  }

  askNow(words) {
    return new Promise((resolve, reject) => {
      const isNew = this.worker === null;
      this.worker ??= makeWorker();
      this.worker.onerror = () => {
        this.worker.terminate();
        this.worker = null;
        const name = words[0] === 'table' ? `${words[1]}: ` : '';
        reject(new Error(`${name}this takes more memory than the page has for it`));
      };
      this.worker.onmessage = ({data}) => {
        if (data.status === 0) {
          resolve(data.text);
        } else {
          reject(new Error(data.text));
        }
      };
      this.worker.postMessage({kind: 'desk', module: isNew ? heldModule('module-desk') : null, words});
    });
  }

  // bytes: the file as it is. options: uncertainty, units, delay, isInverted, reference, each as the program takes it.
  async readTable(name, bytes, options) {
    const text = await this.ask('table', name, bytes, options.uncertainty, options.units, options.delay,
      options.isInverted ? '1' : '', options.reference);
    const [understanding, ...lines] = text.trimEnd().split('\n');
    return {understanding, lines};
  }

  // devices: name and results.json of each. form: text, csv or json.
  compare(by, form, devices) {
    return this.ask('compare', by, form, ...devices.flatMap((device) => [device.name, device.json]));
  }
}
