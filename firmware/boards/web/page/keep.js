// What the browser keeps until somebody deletes it: devices with their results, and where one left.

const PREFIX = 'emax.1.';

// What the browser does not take, because it may not or is full, is held until the page is closed.
class Keep {
  constructor() {
    this.onproblem = () => {};
    this.held = new Map();
  }

  get(name) {
    try {
      return JSON.parse(this.held.get(name) ?? localStorage.getItem(PREFIX + name));
    } catch {
      return null;
    }
  }

  set(name, value) {
    const wasHeld = this.held.has(name);
    const problem = this.store(name, JSON.stringify(value));
    if (problem !== '' && !wasHeld) {
      this.onproblem(`the browser does not keep this: ${problem}; it is gone once the page is closed, so save the files, or ` +
        'delete devices that are not needed');
    }
  }

  // Returns why not.
  store(name, text) {
    try {
      localStorage.setItem(PREFIX + name, text);
      this.held.delete(name);
      return '';
    } catch (error) {
      this.held.set(name, text);
      return error.message;
    }
  }

  remove(name) {
    this.held.delete(name);
    try {
      localStorage.removeItem(PREFIX + name);
    } catch {
      // Nothing is kept where nothing can be.
    }
    [...this.held].forEach(([other, text]) => this.store(other, text));  // There may be room now.
  }

  clear() {
    this.held.clear();
    try {
      Object.keys(localStorage).filter((key) => key.startsWith(PREFIX)).forEach((key) => localStorage.removeItem(key));
    } catch {
      // As above.
    }
  }

  devices() {
    return (this.get('devices') ?? []).map((id) => this.get(`device.${id}`)).filter(Boolean);
  }

  put(device) {
    const ids = this.get('devices') ?? [];
    this.set(`device.${device.id}`, device);
    if (!ids.includes(device.id)) {
      this.set('devices', [...ids, device.id]);
    }
  }

  drop(id) {
    this.set('devices', (this.get('devices') ?? []).filter((other) => other !== id));
    this.remove(`device.${id}`);
  }
}
