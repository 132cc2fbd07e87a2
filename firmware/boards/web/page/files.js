// What somebody saves: the report, results.json and the points, as the PC program writes them.

function saveFile(name, type, text) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], {type}));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// A name that every file system takes.
function fileName(device, end) {
  const name = device.labels.device.normalize('NFKD').replace(/[^A-Za-z0-9._-]+/g, '_').replace(/^[._]+/, '').slice(0, 60);
  return `${name || 'device'}-${end}`;
}

const LABELS = [
  ['device', 'Device'],
  ['serial', 'Serial number'],
  ['operator', 'Measured by'],
  ['date', 'Date'],
  ['note', 'Note'],
];

const BOM = '\ufeff';  // By which Excel knows UTF-8.
const SIMULATION = 'SIMULATION: no real sensor was measured.\n\n';
const FIRST_HEADING = /\n\n(?=[A-Z][A-Z0-9 ,-]+[A-Z](?: \(.*\))?\n)/;

// The labels go where the program has them; the instrument's language is ASCII, and labels are not. Points of a simulated
// sweep stay simulated when they are evaluated again, from what the browser keeps.
function reportWithLabels(device) {
  const given = LABELS.filter(([key]) => device.labels[key]);
  const isUnmarked = device.isSimulated && !device.report.startsWith('SIMULATION');
  const report = isUnmarked && device.report ? SIMULATION + device.report : device.report;
  const rows = given.map(([key, name]) => `  ${name.padEnd(VALUE_COLUMN - 2)}${device.labels[key]}\n`).join('');
  const labelled = rows ? report.replace(FIRST_HEADING, () => `\n\nLABELS (as given)\n${rows}\n`) : report;
  return device.understanding ? reportWithSource(labelled, device) : labelled;
}

// Where the program names the table and says how it was read.
function reportWithSource(report, device) {
  return report.replace(/^( {2}Device {2,}measured points)\n(.*)$/m, (all, front, points) =>
    `${front}: ${device.source}\n${points}\n${' '.repeat(VALUE_COLUMN)}${device.understanding}`);
}

function jsonWithLabels(device) {
  if (device.kind === 'results') {
    return device.json;  // Somebody's file, as it was.
  }
  const members = LABELS.map(([key]) => `    "${key}": ${JSON.stringify(device.labels[key] || null)}`).join(',\n');
  const simulated = device.isSimulated ? device.json.replace('\n  "simulated": false', '\n  "simulated": true') : device.json;
  // The points, and the sweep, are for a front end: the program's file has none of them.
  const plain = simulated.replace(/\n {2}"points": [\s\S]*?(?=\n {2}"model": )/, '');
  const json = device.understanding ? jsonWithSource(plain, device) : plain;
  return json.replace(/^(\{\n {2}"version": "[^"]*",\n)/, (all, front) => `${front}  "labels": {\n${members}\n  },\n`);
}

// Under the name that it has here.
function jsonToCompare(device) {
  if (device.kind !== 'results') {
    return jsonWithLabels(device);
  }
  const labels = Object.fromEntries(LABELS.map(([key]) => [key, device.labels[key] || null]));
  return JSON.stringify({...JSON.parse(device.json), labels});
}

function jsonWithSource(json, device) {
  return json.replace(/(\n {2}"model": \{[^}]*\n {4}"name": )null/, (all, front) => `${front}${JSON.stringify(device.source)}`)
    .replace(/(\n {2}"fit": \{[^}]*\n {4}"unknown_phases": \d+)/, (all, front) =>
      `${front},\n    "read_as": ${JSON.stringify(device.understanding)}`);
}

// The native form, with expanded uncertainties; without, where a sweep broke off before it knew them.
function pointsCsv(device) {
  if (device.isPartial) {
    const rows = pointsOf(device.trace).map((point) => point.slice(0, 3).join(','));
    return `f_hz,amplitude,phase_deg\n${rows.join('\n')}\n`;
  }
  return `f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg\n${linesOf(device.trace).join('\n')}\n`;
}
