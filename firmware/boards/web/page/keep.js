// What the browser keeps until somebody deletes it: devices with their results, and where one left.

const PREFIX = 'emax.1.';

class Keep {
  constructor() {
    this.onproblem = () => {};
  }

  get(name) {
    try {
      return JSON.parse(localStorage.getItem(PREFIX + name));
    } catch {
      return null;
    }
  }

  set(name, value) {
    try {
      localStorage.setItem(PREFIX + name, JSON.stringify(value));
      return true;
    } catch (error) {
      this.onproblem(`the browser does not keep this: ${error.message}; save the files, then delete devices that are not needed`);
      return false;
    }
  }

  remove(name) {
    try {
      localStorage.removeItem(PREFIX + name);
    } catch {
      // Nothing is kept where nothing can be.
    }
  }

  clear() {
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
    if (this.set(`device.${device.id}`, device) && !ids.includes(device.id)) {
      this.set('devices', [...ids, device.id]);
    }
  }

  drop(id) {
    this.set('devices', (this.get('devices') ?? []).filter((other) => other !== id));
    this.remove(`device.${id}`);
  }
}
