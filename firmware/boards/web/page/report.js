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

// Every warning and note of a report, each as one line.
function remarksOf(report, kind) {
  const remarks = [];
  let open = false;
  for (const line of report.split('\n')) {
    if (line.startsWith(`  ${kind}: `)) {
      remarks.push(line.slice(kind.length + 4));
      open = true;
    } else if (open && line.startsWith('  ') && line.trim() !== '') {
      remarks[remarks.length - 1] += ` ${line.trim()}`;
    } else {
      open = false;
    }
  }
  return remarks;
}

// The rows of the figures: what, found, U, bound.
function figuresOf(report) {
  const section = sectionOf(report, 'THE FIGURES');
  if (!section) {
    return null;
  }
  const cells = section.lines.map((line) => line.trim().split(/\s{2,}/));
  const head = cells[0];
  return {note: section.note, head, rows: cells.slice(1).filter((row) => row.length === head.length),
    words: section.lines.filter((line) => line.trim().split(/\s{2,}/).length === 1).map((line) => line.trim()).join(' ')};
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
  let inRemark = false;
  for (const line of section.lines) {
    const isRow = isRowWithValue(line);
    if (isRow && !inRemark) {
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
      inRemark = false;
      continue;
    }
    inRemark ||= /^ {2}(WARNING|Note): /.test(line);
    if (inRemark) {
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
