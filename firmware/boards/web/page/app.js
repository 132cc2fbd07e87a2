// The page: what somebody does, and what is shown.

const element = (id) => document.getElementById(id);

const STAGES = {sweep: 'sweeping', idle: 'done'};
const MOST_BYTES = 1 << 20;
const MOST_LOG = 20000;
const LONG_MS = 10000;
const DOUBT = '-230';

const MARKS = {fit: 'its chi-square is too large for its uncertainties', damping: 'its points leave the damping open'};
const MOUNTED = [['sim-s', 'S'], ['sim-f0', 'f0'], ['sim-beta', 'β']];
const PARAMETERS = [['model-s', 'S'], ['model-f0', 'f0'], ['model-beta', 'β']];
const UNCERTAINTIES = [['model-us', 'u(S)'], ['model-uf0', 'u(f0)'], ['model-ubeta', 'u(β)']];
const WORKBOOKS = ['504b0304', 'd0cf11e0'];  // .xlsx and .ods, .xls

function isWorkbook(bytes) {
  return WORKBOOKS.includes([...bytes.slice(0, 4)].map((byte) => byte.toString(16).padStart(2, '0')).join(''));
}

async function bytesOf(file, expected) {
  if (file.size > MOST_BYTES) {
    throw new Error(`${file.name}: larger than 1 MiB; expected ${expected}`);
  }
  try {
    return new Uint8Array(await file.arrayBuffer());
  } catch (error) {
    throw new Error(`${file.name}: not to be read, or a folder (${error.message}); choose the files in it`);
  }
}

// What stands in these fields, each a number; a comma could be either, so it is refused. fields: [id, name].
function numbersOf(fields) {
  return fields.map(([id, name]) => {
    const text = element(id).value.trim();
    if (text.includes(',')) {
      throw new Error(`${name}: "${text}" has a comma; write a point before the decimals and nothing between thousands`);
    }
    if (text === '' || !Number.isFinite(Number(text))) {
      throw new Error(`${name}: "${text}" is no number; expected one as 1.037`);
    }
    return text;
  });
}

class App {
  constructor() {
    this.keep = new Keep();
    this.keep.onproblem = (text) => this.complain(text);
    this.desk = new Desk();
    this.device = null;
    this.isBusy = false;
    this.chosen = new Set(this.keep.get('now')?.chosen ?? []);
    this.batch = '';
    this.listen();
    this.showDevices();
    this.numberParts();
  }

  listen() {
    const on = (id, event, act) => element(id).addEventListener(event, (e) => {
      e.preventDefault();
      act(e);
    });
    on('connect-simulated', 'click', () => this.work(() => this.connectSimulated([0, 0, 0], this.settingsToKeep())));
    on('connect-serial', 'click', () => this.work(() => this.connectSerial()));
    on('simulated', 'submit', () => this.work(() =>
      this.connectSimulated(numbersOf(MOUNTED).map(Number), this.settingsToKeep())));
    on('defaults', 'click', () => this.work(() => this.restoreDefaults()));
    on('sweep', 'click', () => this.work(() => this.sweep()).then(() => this.toResult()));
    on('model', 'submit', () => this.work(() => this.takeModel()).then(() => this.toResult()));
    on('abort', 'click', () => this.job?.stop());
    on('again', 'click', () => this.work(() => this.again()).then(() => this.toResult()));
    on('print', 'click', () => this.print());
    on('save-report', 'click', () => saveFile(fileName(this.device, 'report.txt'), 'text/plain', reportWithLabels(this.device)));
    on('save-json', 'click', () =>
      saveFile(fileName(this.device, 'results.json'), 'application/json', jsonWithLabels(this.device)));
    on('save-csv', 'click', () => saveFile(fileName(this.device, 'points.csv'), 'text/csv', pointsCsv(this.device)));
    on('compare', 'submit', () => this.work(() => this.compare()));
    on('save-comparison', 'click', () => saveFile('comparison.csv', 'text/csv', BOM + this.comparisonCsv));
    on('print-comparison', 'click', () => this.printComparison());
    on('delete-all', 'click', () => this.deleteAll());
    on('close-problem', 'click', () => {
      this.complain('');
      element('job').focus();
    });
    on('speak', 'submit', () => this.speak());
    on('clear', 'click', () => this.scpi?.clear());
    element('files').addEventListener('change', (event) => {
      const files = [...event.target.files];
      event.target.value = '';
      this.work(() => this.takeFiles(files)).then(() => files.length === 1 && this.toResult());
    });
    for (const [key] of LABELS) {
      element(`label-${key}`).addEventListener('change', () => this.relabel());
    }
    const drop = element('drop');
    for (const event of ['dragenter', 'dragover']) {
      drop.addEventListener(event, (e) => {
        e.preventDefault();
        drop.classList.add('over');
      });
    }
    drop.addEventListener('dragleave', () => drop.classList.remove('over'));
    // A file that misses the place must not take the page's.
    window.addEventListener('dragover', (e) => e.preventDefault());
    window.addEventListener('drop', (e) => {
      e.preventDefault();
      drop.classList.remove('over');
      const files = [...(e.dataTransfer?.files ?? [])];
      if (files.length > 0) {
        this.work(() => this.takeFiles(files)).then(() => files.length === 1 && this.toResult());
      }
    });
    const hasSerial = Boolean(navigator.serial);
    if (!hasSerial) {
      element('connect-serial').hidden = true;
      element('serial-hint').textContent =
        'This browser has no Web Serial, so it cannot speak with a board; Chromium, Chrome and Edge can.';
    }
  }

  // One thing at a time; what goes wrong is said.
  async work(act) {
    if (this.isBusy) {
      this.complain('something else is running; stop it first, or wait');
      return;
    }
    this.setBusy(true);
    this.complain('');
    if (this.job) {
      this.job.isStopped = false;
    }
    try {
      await act();
    } catch (error) {
      if (error.name !== 'NotFoundError') {  // Nobody chose a port.
        this.complain(error.message);
      }
    }
    this.setBusy(false);
  }

  setBusy(isBusy) {
    this.isBusy = isBusy;
    document.body.dataset.busy = isBusy ? 'yes' : 'no';
    document.querySelectorAll('.starts').forEach((control) => {
      control.disabled = isBusy;
    });
    element('work').hidden = !isBusy || !element('stage').textContent;
  }

  // Where somebody wants to be after it, eyes and screen reader alike.
  toResult() {
    if (element('notice').hidden) {
      element('result').focus();
    } else {
      element('notice').focus();
    }
  }

  complain(text) {
    element('problem').textContent = text;
    element('notice').hidden = text === '';
    if (text.includes('--')) {
      element('table-says').open = true;  // The fields of these options.
    }
  }

  progress(percent, words) {
    element('stage').textContent = words;
    element('progress').value = percent;
    const isNew = element('work').hidden && words !== '';
    element('work').hidden = words === '';
    if (isNew) {
      element('work').scrollIntoView({block: 'nearest'});
    }
  }

  // The instrument

  async begin() {
    const now = this.keep.get('now') ?? {};
    await this.connectSimulated(now.mounted ?? [0, 0, 0], now);
  }

  async connectSimulated(mounted, before = null) {
    const kept = this.keep.get('store');
    const port = await SimulatedPort.open(mounted, kept ? Uint8Array.from(atob(kept), (c) => c.charCodeAt(0)) : null,
      Number(element('sim-pace').value));
    port.onstore = (bytes) => this.keep.set('store', btoa(String.fromCharCode(...bytes)));
    this.mounted = mounted;
    await this.use(port, false);
    if (before?.settings) {
      const expected = await this.scpi.ask('SENS:DEV:SENS?');
      await this.scpi.exchange(before.settings);  // Of another version some may be refused; the rest is taken.
      if (before.isOfAnother) {
        await this.scpi.tell(`SENS:DEV:SENS ${expected}`);  // What is mounted now has its own.
      }
      await this.showSettings();
    }
    const device = before?.device ? this.keep.get(`device.${before.device}`) : null;
    if (device) {
      this.showDevice(device);
      await this.hand(device);
    }
    this.remember();
  }

  // Those of this page's bench stay when something else is mounted; those of a board are none of its business.
  settingsToKeep() {
    const settings = this.isSlow ? null : this.learnt;
    return settings ? {settings, isOfAnother: true} : null;
  }

  async connectSerial() {
    await this.use(await SerialPort.open(), true);
    this.remember();
  }

  async use(port, isSlow) {
    const before = this.port;
    this.port = null;
    this.held = null;
    await before?.close();
    port.onend = (reason) => this.ended(port, reason);
    const scpi = new Scpi(port);
    const job = new Job(scpi, isSlow);
    try {
      if (isSlow) {
        await port.clear();  // Whatever somebody before has left half said.
      }
      await scpi.tell('*CLS');
      Object.assign(this, {port, scpi, job, isSlow, ...(await job.identify())});
    } catch (error) {
      await port.close();
      element('connection').textContent = 'not connected';
      throw error;
    }
    scpi.onwarning = (errors) => this.complain(errors.join('; '));
    if (port.commands) {
      this.commands = commandsOf(port.commands);
      this.showCommands();
      this.form = new SettingsForm(element('settings-list'), this.commands, (header, value) => this.change(header, value));
    }
    element('connection').textContent = `Connected: ${port.name}, ${this.identity}`;
    document.body.dataset.simulated = this.isSimulated ? 'yes' : 'no';
    await this.showSettings();
  }

  ended(port, reason) {
    if (port === this.port) {
      this.port = null;
      element('connection').textContent = `Not connected: ${reason}. What was measured is kept; connect again.`;
    }
  }

  // Settings

  async showSettings() {
    this.learnt = await this.scpi.ask('*LRN?');
    this.form.show(this.learnt, (query) => this.scpi.ask(query));
  }

  async change(header, value) {
    if (/[;\n]/.test(value)) {
      return 'one value is expected here; the console below takes whole lines';
    }
    try {
      await this.scpi.tell(`${header} ${value}`);
    } catch (error) {
      return error.message;
    }
    await this.showSettings();
    this.remember();
    return '';
  }

  async restoreDefaults() {
    const device = this.device;
    await this.scpi.tell('*RST');
    this.held = null;
    await this.showSettings();
    if (device) {
      await this.hand(device);
    }
    this.remember();
  }

  remember() {
    this.keep.set('now', {mounted: this.mounted, settings: this.learnt, device: this.device?.id ?? null,
      chosen: [...this.chosen]});
    this.markStale();
  }

  markStale() {
    const isStale = Boolean(this.device?.json) && this.device.settings !== this.learnt;
    element('again').textContent = isStale ? 'Settings have changed: evaluate again' : 'Evaluate again';
  }

  // Devices

  newDevice(kind, name) {
    // What stands in the fields is of the device shown; before there is one, of the one to come. Who measures stays.
    const labels = {};
    LABELS.forEach(([key]) => {
      labels[key] = this.device && key !== 'operator' ? '' : element(`label-${key}`).value.trim();
    });
    if (kind === 'sweep' && !labels.date) {
      labels.date = new Date().toLocaleDateString('sv-SE');
    }
    labels.device = this.freeName(kind === 'table' ? name : labels.device || name);
    const id = `${Date.now().toString(36)}${Math.floor(Math.random() * 1e6).toString(36)}`;
    return {id, kind, labels, source: '', understanding: '', trace: '', reference: '0', model: '', json: '', report: '',
      impulse: [], instrument: this.identity, isSimulated: false, settings: this.learnt};
  }

  // The name, or with a number behind it where a device has it already.
  freeName(name) {
    const taken = new Set(this.keep.devices().map((device) => device.labels.device));
    let free = name;
    for (let number = 2; taken.has(free); ++number) {
      free = `${name} (${number})`;
    }
    return free;
  }

  // The device's points or parameters are the instrument's again, if they are not yet.
  async hand(device) {
    if (this.held === device.id || device.isPartial) {
      return;
    }
    this.held = null;
    if (device.trace) {
      const lines = linesOf(device.trace).map((line) => `TRAC:FRES:DATA ${line}`);
      await this.job.takeTable(lines, device.reference);
    } else if (device.model) {
      await this.scpi.tell(`CALC:MOD ${device.model}`);
    }
    this.held = device.id;
  }

  async takeFiles(files) {
    const taken = [];
    const problems = [];
    for (const [i, file] of files.entries()) {
      this.batch = files.length > 1 ? `${i + 1} of ${files.length}: ${file.name}: ` : '';
      try {
        taken.push(file.name.toLowerCase().endsWith('.json') ? await this.takeResults(file) : await this.takeTable(file));
      } catch (error) {
        problems.push(error.message);
      }
      const left = files.slice(i + 1).map((other) => other.name);
      if (this.job?.isStopped && left.length > 0) {
        problems.push(`stopped; not read: ${left.join(', ')}`);
        break;
      }
    }
    this.batch = '';
    this.progress(0, '');
    if (taken.length > 1) {
      element('devices').scrollIntoView();
    }
    if (problems.length > 0) {
      throw new Error(problems.join(' — '));
    }
  }

  async takeTable(file) {
    const bytes = await bytesOf(file, 'a table of at most 1024 points');
    if (isWorkbook(bytes)) {
      throw new Error(`${file.name}: a workbook, not a table as text; in Excel, save it as CSV (File, Save As, CSV UTF-8)`);
    }
    const options = {
      uncertainty: element('table-uncertainty').value.trim(),
      units: element('table-units').value.trim(),
      delay: element('table-delay').value.trim(),
      isInverted: element('table-invert').checked,
      reference: element('table-reference').value.trim(),
    };
    this.progress(0, `reading ${file.name}`);
    const {understanding, lines} = await this.desk.readTable(file.name, bytes, options);
    const device = this.newDevice('table', file.name.replace(/\.[^.]*$/, ''));
    const trace = lines.map((line) => line.slice(line.indexOf(' ') + 1)).join(',');
    Object.assign(device, {source: file.name, understanding, trace, reference: options.reference || '0'});
    await this.hand(device);
    this.putDevice(device);
    await this.evaluate(device);
    return device;
  }

  // A results.json of the program or of this page, to compare with.
  async takeResults(file) {
    const json = new TextDecoder().decode(await bytesOf(file, 'a results.json of emax'));
    let results = null;
    try {
      results = JSON.parse(json);
    } catch (error) {
      throw new Error(`${file.name}: ${error.message}; expected a results.json of emax`);
    }
    if (!results?.version || !results?.model) {
      throw new Error(`${file.name}: this is no results.json of emax`);
    }
    // Read by the program's own code, which says what is missing.
    await this.desk.compare('energy', 'json', [{name: file.name, json}, {name: `${file.name} again`, json}]);
    const device = this.newDevice('results', '');
    LABELS.forEach(([key]) => {
      const label = results.labels?.[key];
      device.labels[key] = typeof label === 'string' ? label : '';
    });
    device.labels.device = this.freeName(device.labels.device || file.name.replace(/\.[^.]*$/, ''));
    Object.assign(device, {source: file.name, json, instrument: ''});
    try {
      setCertificate(document.createElement('div'), device);
    } catch (error) {
      throw new Error(`${file.name}: not as emax writes it (${error.message})`);
    }
    this.putDevice(device);
    return device;
  }

  async takeModel() {
    const hasUncertainties = UNCERTAINTIES.some(([id]) => element(id).value.trim() !== '');
    const values = numbersOf(hasUncertainties ? [...PARAMETERS, ...UNCERTAINTIES] : PARAMETERS);
    const device = this.newDevice('model', 'Device by its parameters');
    device.model = values.join(',');
    device.source = 'parameters as given';
    await this.hand(device);
    this.putDevice(device);
    await this.evaluate(device);
  }

  async sweep() {
    const device = this.newDevice('sweep', `Sweep of ${new Date().toLocaleString('sv-SE')}`);
    Object.assign(device, {source: 'sweep', isSimulated: this.isSimulated});
    const points = [];
    let plot = null;
    element('growing').replaceChildren();
    this.held = null;
    let problems = [];
    let broken = null;
    try {
      problems = await this.job.sweep(
        (percent, stage) => this.progress(percent, `${STAGES[stage] ?? stage}, ${points.length} points`),
        (point) => {
          points.push(point);
          // Kept as it grows: a closed page or a pulled plug loses nothing.
          device.trace = points.map(([f, a, phi, ua, uphi]) => [f, a, phi, 2 * ua, 2 * uphi].join(',')).join(',');
          device.isPartial = true;
          this.keep.put(device);
          if (points.length > 1) {
            plot?.figure.remove();
            plot = new Plot(element('growing'), responsePicture(points.map((p) => [...p.slice(0, 3), 2 * p[3], 2 * p[4]]), null));
          }
        });
      Object.assign(device, await this.job.points());
      this.held = device.id;
    } catch (error) {
      broken = error;
    }
    element('growing').replaceChildren();
    device.isPartial = Boolean(broken);
    if (points.length > 0 || device.trace) {
      this.putDevice(device);
    }
    this.progress(0, '');
    if (broken) {
      throw broken;
    }
    // A doubt about what was measured is a remark at its end; what ends a sweep is another error.
    const isComplete = problems.every((problem) => problem.startsWith(DOUBT)) && !this.job.isStopped;
    if (isComplete) {
      await this.evaluate(device, problems);
      return;
    }
    const words = this.job.isStopped ? 'stopped; the drive is at zero' : problems.join('; ');
    this.complain(`${words}. ${points.length} points were measured and are kept.`);
  }

  async again() {
    await this.hand(this.device);
    await this.evaluate(this.device);
  }

  async evaluate(device, remarks = []) {
    const problems = [...remarks, ...await this.compute()];
    if (this.job.isStopped) {
      this.progress(0, '');
      this.showDevice(device);
      const words = device.json ? 'stopped; its figures are those of before' :
        'stopped before its figures were known; what is known of it is kept, and "Evaluate again" computes them';
      throw new Error(`${device.labels.device}: ${words}`);
    }
    this.progress(100, 'fetching the results');
    try {
      Object.assign(device, await this.job.results());
    } catch (error) {
      problems.push(error.message);
      Object.assign(device, {json: '', report: '', impulse: [], histogram: []});
      device.fit = await this.job.sensitivity();
    }
    device.settings = this.learnt;
    this.progress(0, '');
    this.putDevice(device);
    this.remember();
    if (problems.length > 0) {
      throw new Error(`${device.labels.device}: ${[...new Set(problems)].join('; ')}`);
    }
  }

  // Returns what went wrong, in the instrument's words.
  async compute() {
    if (this.job.isStopped) {
      return [];  // While its points were read.
    }
    const began = Date.now();
    let most = 0;
    try {
      return await this.job.evaluate((percent, stage) => {
        most = Math.max(most, percent);
        const advice = Date.now() - began > LONG_MS ? '; fewer trials are quicker (Monte Carlo, in 2)' : '';
        this.progress(most, `${this.batch}computing: ${stage}${advice}`);
      });
    } catch (error) {
      if (!(error instanceof Refusal)) {
        throw error;
      }
      return [error.message];
    }
  }

  putDevice(device) {
    this.keep.put(device);
    this.chosen.add(device.id);
    this.hideComparison();
    this.showDevice(device);
    this.showDevices();
    this.remember();
  }

  showDevice(device) {
    this.device = device;
    LABELS.forEach(([key]) => {
      element(`label-${key}`).value = device.labels[key] ?? '';
    });
    setCertificate(element('certificate'), device);
    element('result').hidden = false;
    this.numberParts();
    element('save-report').hidden = !device.report;
    element('save-json').hidden = !device.json;
    element('save-csv').hidden = !device.trace;
    element('again').hidden = device.isPartial || (!device.trace && !device.model);
    element('labels-of').textContent = `Labels of ${device.labels.device}, the device whose result is below. What comes next takes over who measured, and nothing else.`;
    document.title = `${isSimulatedDevice(device) ? 'Simulation - ' : ''}${device.labels.device} - emax`;
    this.markStale();
  }

  // Those that are there, in their order.
  numberParts() {
    document.querySelectorAll('main > section:not([hidden], #words) > h2').forEach((heading, i) => {
      heading.textContent = `${i + 1}. ${heading.textContent.replace(/^\d+\. /, '')}`;
    });
  }

  relabel() {
    if (!this.device) {
      return;
    }
    LABELS.forEach(([key]) => {
      this.device.labels[key] = element(`label-${key}`).value.trim();
    });
    this.keep.put(this.device);
    this.showDevice(this.device);
    this.showDevices();
  }

  showDevices() {
    const devices = this.keep.devices();
    element('no-devices').hidden = devices.length > 0;
    element('compare').hidden = devices.length === 0;
    const rows = devices.map((device) => {
      const choose = document.createElement('input');
      choose.type = 'checkbox';
      choose.checked = this.chosen.has(device.id) && Boolean(device.json);
      choose.disabled = !device.json;
      choose.setAttribute('aria-label', `compare ${device.labels.device}`);
      choose.addEventListener('change', () => {
        this.chosen[choose.checked ? 'add' : 'delete'](device.id);
        this.remember();
      });
      const row = figuresOfDevice(device)?.rows[0];
      const figure = row ? withUncertainty(row) : '–';
      return [choose, device.labels.device, device.labels.serial, figure, device.source,
        this.makeButton('Show', device, () => {
          this.showDevice(device);
          this.work(() => this.hand(device));
          this.remember();
          element('result').focus();
        }), this.makeButton('Delete', device, () => this.delete(device))];
    });
    element('device-list').replaceChildren(makeTable(['', 'Device', 'Serial', 'in band, % of S a', 'from', '', ''], rows));
  }

  makeButton(text, device, act) {
    const button = document.createElement('button');
    button.className = text.toLowerCase();
    button.type = 'button';
    button.textContent = text;
    button.setAttribute('aria-label', `${text} ${device.labels.device}`);
    button.addEventListener('click', act);
    return button;
  }

  delete(device) {
    if (this.isBusy) {
      this.complain('something is running; stop it first, or wait');
      return;
    }
    if (!window.confirm(`Delete "${device.labels.device}" from this browser? Its points and results are then gone.`)) {
      return;
    }
    this.keep.drop(device.id);
    this.chosen.delete(device.id);
    if (this.device?.id === device.id) {
      this.showNoDevice();
    }
    this.hideComparison();
    const place = this.keep.devices().length > 0 ? element('device-list') : element('devices');
    this.showDevices();
    this.remember();
    place.focus();
  }

  // All that the page keeps; it begins anew.
  deleteAll() {
    const question = 'Delete all devices, with their points and results, and the settings of this page from this browser?';
    if (this.isBusy) {
      this.complain('something is running; stop it first, or wait');
    } else if (window.confirm(question)) {
      this.keep.clear();
      location.reload();
    }
  }

  showNoDevice() {
    this.device = null;
    element('result').hidden = true;
    this.numberParts();
    LABELS.forEach(([key]) => {
      element(`label-${key}`).value = '';
    });
    element('labels-of').textContent = 'Labels of the next device.';
    document.title = 'emax';
  }

  // It holds for the devices as they were.
  hideComparison() {
    ['comparison', 'save-comparison', 'print-comparison'].forEach((id) => {
      element(id).hidden = true;
    });
  }

  async compare() {
    const devices = this.keep.devices().filter((device) => this.chosen.has(device.id) && device.json)
      .map((device) => ({name: device.labels.device, json: jsonToCompare(device)}));
    if (devices.length < 2) {
      throw new Error('choose two devices or more');
    }
    // The names of files have to differ; those of devices need not.
    devices.forEach((device, i) => {
      if (devices.findIndex((other) => other.name === device.name) !== i) {
        device.name += ` (${i + 1})`;
      }
    });
    const by = element('compare-by').value;
    const text = await this.desk.compare(by, 'text', devices);
    const {devices: ranked, ranked_by: rankedBy} = JSON.parse(await this.desk.compare(by, 'json', devices));
    this.comparisonCsv = await this.desk.compare(by, 'csv', devices);
    const place = element('comparison');
    place.hidden = false;
    place.replaceChildren();
    const unit = rankedBy === 'energy' ? 'V²\u00a0s' : '%\u00a0of\u00a0S\u00a0a';
    const rows = ranked.map((device) => ({
      name: [device.device ?? device.file, device.serial].filter(Boolean).join(' '),
      value: device.value,
      low: device.interval?.[0] ?? null, high: device.interval?.[1] ?? null,
      bound: device.bound ?? null,
      figure: figureInWords(device.value, device.U, unit),
    }));
    const order = addTo(place, 'ol', 'ranking');
    ranked.forEach((device, i) => {
      const rank = device.rank_best === device.rank_worst ? `${device.rank_best}` : `${device.rank_best}–${device.rank_worst}`;
      const marks = [device.fit_warns ? MARKS.fit : '', device.damping_open ? MARKS.damping : ''].filter(Boolean);
      addTo(order, 'li').textContent = [`${rank}: ${rows[i].name}, ${rows[i].figure}`, ...marks].join('; ');
    });
    addTo(place, 'p', 'hint').textContent =
      'Devices that share ranks, as 1–2, are not told apart: their uncertainties do not allow it, or a warning forbids it; ' +
      'the text below says which. ± is U (k = 2). Dot: found; bar: interval; stroke: none exceeds.';
    drawRanking(addTo(place, 'div', 'plot'), rows, unit);
    const pre = addTo(place, 'pre', 'report');
    pre.tabIndex = 0;
    pre.setAttribute('aria-label', 'comparison');
    pre.textContent = text;
    element('save-comparison').hidden = false;
    element('print-comparison').hidden = false;
    place.focus();
  }

  printComparison() {
    document.body.classList.add('comparing');
    const title = document.title;
    document.title = 'Comparison - emax';
    window.print();
    document.title = title;
    document.body.classList.remove('comparing');
  }

  print() {
    const details = document.querySelector('#certificate .whole');
    const was = details?.open;
    if (details) {
      details.open = true;
    }
    window.print();
    if (details) {
      details.open = was;
    }
  }

  // The console

  showCommands() {
    const rows = this.commands.map(({pattern, forms, parameters, words}) => [pattern, forms, parameters, words]);
    element('commands').replaceChildren(makeTable(['command', 'forms', 'parameters', ''], rows));
  }

  async speak() {
    const line = element('line').value.trim();
    if (!line) {
      return;
    }
    element('line').value = '';
    element('speak').setAttribute('aria-busy', 'true');
    this.log(`> ${line}`);
    try {
      this.held = null;  // Whatever the line has changed.
      const {answers, errors} = await this.scpi.exchange(line, SLOW_MS);
      [...answers, ...errors].forEach((text) => this.log(text));
      await this.showSettings();
      this.remember();
    } catch (error) {
      this.log(error.message);
    }
    element('speak').setAttribute('aria-busy', 'false');
  }

  log(text) {
    const place = element('log');
    place.textContent = `${place.textContent}${text}\n`.slice(-MOST_LOG);
    place.scrollTop = place.scrollHeight;
  }
}
