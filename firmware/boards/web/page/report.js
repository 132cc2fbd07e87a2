// The text of the report, taken apart: its words and digits are the instrument's, the page only sets them.

const VALUE_COLUMN = 28;

// {heading, note, lines} of each section; the lines before the first heading are left out.
function sectionsOf(report) {
  const sections = [];
  for (const line of report.split('\n')) {
    const heading = /^([A-Z][A-Z0-9 ,-]+[A-Z])(?: \((.*)\))?$/.exec(line);
    if (heading) {
      sections.push({heading: heading[1], note: heading[2] ?? '', lines: []});
    } else if (sections.length > 0) {
      sections.at(-1).lines.push(line);
    }
  }
  return sections;
}

function sectionOf(report, heading) {
  return sectionsOf(report).find((section) => section.heading === heading);
}

const REMARK = /^ {2}(WARNING|Note): /;

// Lines are filled up to about here; one that ends a sentence earlier ends a remark.
const FULL_LINE = 84;

// Whether `line` goes on with the remark that the line before is of: it is no row, and there was no room for it before.
function goesOn(line, before) {
  if (line.trim() === '' || !line.startsWith('  ') || isRowWithValue(line) || REMARK.test(line)) {
    return false;
  }
  const isRoom = before.length + line.trim().split(' ')[0].length < FULL_LINE;
  const isLong = before.length > FULL_LINE + 10;
  return !(before.endsWith('.') && /^ {2}[A-Z]/.test(line) && (isRoom || isLong));
}

// Every warning and note of a report, each as one line.
function remarksOf(report, kind) {
  const remarks = [];
  let before = null;
  for (const line of report.split('\n')) {
    if (line.startsWith(`  ${kind}: `)) {
      remarks.push(line.slice(kind.length + 4));
      before = line;
    } else if (before !== null && goesOn(line, before)) {
      remarks[remarks.length - 1] += ` ${line.trim()}`;
      before = line;
    } else {
      before = null;
    }
  }
  return remarks;
}

// The lines that are of no remark.
function withoutRemarks(lines) {
  let before = null;
  return lines.filter((line) => {
    const isRemark = REMARK.test(line) || (before !== null && goesOn(line, before));
    before = isRemark ? line : null;
    return !isRemark;
  });
}

// A mark that stands in a column of its own goes to the name before it.
function cellsOf(line) {
  const cells = line.trim().split(/\s{2,}/);
  const marked = cells.indexOf('*', 1);
  return marked > 0 ? [...cells.slice(0, marked - 1), `${cells[marked - 1]} *`, ...cells.slice(marked + 1)] : cells;
}

// The rows of the figures: what, found, U, bound.
function figuresOf(report) {
  const section = sectionOf(report, 'THE FIGURES');
  if (!section) {
    return null;
  }
  const lines = withoutRemarks(section.lines);
  const cells = lines.map((line) => cellsOf(line));
  const head = cells[0];
  return {note: section.note, head, rows: cells.slice(1).filter((row) => row.length === head.length),
    words: cells.filter((row) => row.length === 1).map(([text]) => text).join(' ')};
}

// A row of figures in one line. Where an interval stands in the place of U it is no ±.
function withUncertainty([, found, expanded]) {
  if (!expanded || expanded === '-') {
    return found;
  }
  return expanded.includes(' to ') ? `${found} (${expanded})` : `${found} ± ${expanded}`;
}

// A value and its expanded uncertainty as texts, both to the uncertainty's second digit.
function roundedPair(value, expanded) {
  if (!Number.isFinite(expanded) || expanded <= 0) {
    return [shown(value), '-'];
  }
  const decimals = Math.min(Math.max(0, 1 - Math.floor(Math.log10(expanded))), 20);
  return [value.toFixed(decimals), Number(expanded.toPrecision(2)).toFixed(decimals)];
}

// As the report has a figure without U: with an exponent only where there are more than nine decimals.
function fourDigits(value) {
  const decimals = Math.max(0, 3 - Math.floor(Math.log10(value)));
  return decimals > 9 ? shown(value) : value.toFixed(decimals);
}

// The interval that stands in the place of U, as in the report: where U is above the figure, or one end is more than twice
// as far away as the other. Its ends are rounded outwards. Null where U says enough.
function intervalInPlaceOfU(value, expanded, shortest) {
  if (!Array.isArray(shortest) || !(expanded > 0)) {
    return null;
  }
  const low = Math.min(shortest[0], value);
  const high = Math.max(shortest[1], value);
  const [near, far] = [value - low, high - value].sort((a, b) => a - b);
  if (expanded <= value && far <= 2 * near) {
    return null;
  }
  const decimals = Math.min(Math.max(0, 1 - Math.floor(Math.log10(high))), 20);
  const power = 10 ** decimals;
  const least = Math.max(0, Math.floor(low * power));
  return `${least === 0 ? 0 : (least / power).toFixed(decimals)} to ${(Math.ceil(high * power) / power).toFixed(decimals)}`;
}

// A bound to four digits: never below itself.
function roundedUp(bound) {
  const decimals = 3 - Math.floor(Math.log10(bound));
  const power = 10 ** decimals;
  return (Math.ceil(bound * power * (1 - 1e-12)) / power).toFixed(Math.min(Math.max(0, decimals), 20));
}

// Both of an energy, too, which may be far below 1.
function figureInWords(value, expanded, unit) {
  const power = value > 0 && value < 1e-3 ? Math.floor(Math.log10(value)) : 0;
  const text = withUncertainty(['', ...roundedPair(value / 10 ** power, expanded / 10 ** power)]);
  return power === 0 ? `${text} ${unit}` : `(${text}) × 10${raised(power)} ${unit}`;
}

// The same table from a results.json, where there is no report.
function figuresOfResults({model, energy, band, ideal, uncertainty}) {
  if (!model || !energy) {
    return null;
  }
  const percentOf = (squared) => (100 * Math.sqrt(squared / energy.T)) / (model.S * energy.a);
  const row = (name, value, expanded, bound, shortest) => {
    const interval = intervalInPlaceOfU(value, expanded, shortest);
    const cells = interval ? [fourDigits(value), interval] : roundedPair(value, expanded);
    return [name, ...cells, bound > 0 ? roundedUp(bound) : '-'];
  };
  const percent = percentOf(energy.E);
  const figures = [
    band?.matched && ['In band, constant delay taken out', band.matched.rms_percent, band.matched.U_percent,
      band.matched.bound_percent, band.matched.shortest_percent],
    band && ['In band, with its delay', band.rms_percent, band.U_percent, band.bound_percent, band.shortest_percent],
    ["The paper's figure, sqrt(E/T)", percent, uncertainty?.U_percent, percentOf(energy.bound ?? NaN)],
    ideal && ['The same of an ideal sensor', ideal.rms_percent, NaN, NaN],
  ];
  return {note: 'at the estimates; worst rms error of signals within ±a, in % of S a',
    head: ['error', 'found', 'U (k = 2)', 'none exceeds'],
    rows: figures.filter((figure) => Number.isFinite(figure?.[1])).map((figure) => row(...figure)),
    words: 'From its results.json, which has neither points nor report.'};
}

const CRITERIA = {ise: 'integral-square error', difference: 'difference of the energies', band: 'error in band'};

function conditionsOfResults({filter, energy}) {
  return filter && energy ? [
    ['Reference filter', `Butterworth low-pass, order ${filter.order}, cutoff ${filter.cutoff} Hz`],
    ['Time T', `${shown(1e3 * energy.T)} ms`],
    ['Limit a', `${shown(energy.a, 6)} m/s²`],
    ['Criterion', CRITERIA[energy.criterion] ?? String(energy.criterion)],
  ] : [];
}

function figuresOfDevice(device) {
  if (device.report || !device.json) {
    return figuresOf(device.report);
  }
  return figuresOfResults(JSON.parse(device.json));
}

const CONDITIONS = ['Reference filter', 'Filter gain', 'Time T', 'Limit a', 'Criterion'];

// What the figures hold for, as [name, value].
function conditionsOf(report) {
  const lines = sectionOf(report, 'WHAT WAS PUT IN')?.lines ?? [];
  return lines.map((line) => [line.slice(0, VALUE_COLUMN).trim(), line.slice(VALUE_COLUMN)])
    .filter(([name]) => CONDITIONS.includes(name));
}

// A name, or none in further lines of one value, and the value from its column on; a table has more columns than that.
function isRowWithValue(line) {
  const hasValue = line.length > VALUE_COLUMN && line[VALUE_COLUMN] !== ' ' && line.slice(VALUE_COLUMN - 2, VALUE_COLUMN) === '  ';
  return hasValue && /^ {2}(\S| {26})/.test(line) && !/^ {2}\S.*\S {2,}\S.* {2,}\S.* {2,}\S/.test(line);
}

// A section as rows of name and value, tables and paragraphs; not its warnings and notes, which stand elsewhere.
function setSection(section) {
  const part = document.createElement('section');
  part.className = 'part';
  const heading = document.createElement('h3');
  heading.textContent = section.heading[0] + section.heading.slice(1).toLowerCase().replace('monte carlo', 'Monte Carlo');
  part.append(heading);
  let list = null;
  let text = null;
  for (const line of withoutRemarks(section.lines)) {
    if (isRowWithValue(line)) {
      list ??= addTo(part, 'dl', 'rows');
      text = null;
      const name = line.slice(0, VALUE_COLUMN).trim();
      if (name || !list.lastChild) {
        addTo(list, 'dt').textContent = name;
        addTo(list, 'dd').textContent = line.slice(VALUE_COLUMN);
      } else {
        list.lastChild.textContent += `\n${line.slice(VALUE_COLUMN)}`;
      }
      continue;
    }
    list = null;
    if (line.trim() === '') {
      text = null;
      continue;
    }
    if (!text) {
      text = addTo(part, 'pre', 'text');
      text.tabIndex = 0;
      text.setAttribute('aria-label', heading.textContent);
    }
    text.textContent += `${text.textContent ? '\n' : ''}${line.slice(2)}`;
  }
  return part;
}

function addTo(parent, name, className = '') {
  const element = document.createElement(name);
  if (className) {
    element.className = className;
  }
  parent.append(element);
  return element;
}
