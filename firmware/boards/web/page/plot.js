// Pictures as SVG: panels one below the other over the same x, with values under the pointer or the arrow keys.

const SVG = 'http://www.w3.org/2000/svg';
const LEFT = 64;
const RIGHT = 14;
const TOP = 10;
const BOTTOM = 34;
const GAP = 16;
const PANEL_HEIGHT = 170;

function svgElement(name, attributes, parent) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    element.setAttribute(key, value);
  }
  parent?.append(element);
  return element;
}

function raised(exponent) {
  return [...String(Number(exponent))].map((c) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]).join('');
}

// As people write it: 1.234, 0.00123, 5.1 × 10⁻⁷.
function shown(value, digits = 4) {
  if (!Number.isFinite(value)) {
    return '–';
  }
  const size = Math.abs(value);
  if (value !== 0 && (size < 1e-3 || size >= 1e6)) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${mantissa.replace('-', '−')} × 10${raised(exponent)}`;
  }
  return String(Number(value.toPrecision(digits))).replace('-', '−');
}

class Scale {
  constructor(least, most, isLog, from, to) {
    this.isLog = isLog;
    this.least = isLog ? Math.log10(least) : least;
    this.most = isLog ? Math.log10(most) : most;
    if (!(this.most > this.least)) {
      const room = Math.abs(this.least) * 0.1 || 1;
      this.least -= room;
      this.most += room;
    }
    this.from = from;
    this.to = to;
  }

  at(value) {
    const on = this.isLog ? Math.log10(value) : value;
    return this.from + ((on - this.least) / (this.most - this.least)) * (this.to - this.from);
  }

  ticks(wanted) {
    return this.isLog ? this.decades(wanted) : this.steps(wanted);
  }

  steps(wanted) {
    const raw = (this.most - this.least) / wanted;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= raw * 0.999);
    const ticks = [];
    for (let k = Math.ceil(this.least / step - 1e-9); k * step <= this.most + step * 1e-9; ++k) {
      ticks.push(Number((k * step).toPrecision(12)));
    }
    return ticks;
  }

  decades(wanted) {
    const span = this.most - this.least;
    const factors = span < 1.2 ? [1, 2, 3, 5, 7] : span * 3 <= wanted * 1.5 ? [1, 2, 5] : [1];
    const ticks = [];
    for (let decade = Math.floor(this.least); decade <= this.most; ++decade) {
      for (const factor of factors) {
        const on = Math.log10(factor) + decade;
        if (on >= this.least - 1e-9 && on <= this.most + 1e-9) {
          ticks.push(Number((factor * 10 ** decade).toPrecision(6)));
        }
      }
    }
    return ticks;
  }
}

function rangeOf(values, isLog) {
  const usable = values.filter((value) => Number.isFinite(value) && (!isLog || value > 0));
  if (usable.length === 0) {
    return isLog ? [0.1, 10] : [0, 1];
  }
  const least = Math.min(...usable);
  const most = Math.max(...usable);
  const room = isLog ? 1.08 : 0.05 * (most - least);
  return isLog ? [least / room, most * room] : [least - room, most + room];
}

// One picture in its own figure.
//
// picture: {title, note, x: {label, unit, isLog, digits?, range?, marks?: [{name, at}]},
// panels: [{title?, label, unit, isLog, zero, from?, series: [...]}]}; marks are strokes through all panels.
// series: {name, kind: 'line' | 'points' | 'steps' | 'bars', points: [[x, y, low?, high?], ...]}, points ascending in x; of
// bars also their width, and inside: {name, range} for those that are darker.
class Plot {
  constructor(place, picture) {
    this.picture = picture;
    this.figure = document.createElement('figure');
    const caption = document.createElement('figcaption');
    caption.textContent = picture.title;
    this.box = document.createElement('div');
    this.box.className = 'plot';
    this.box.tabIndex = 0;
    this.box.setAttribute('role', 'img');
    this.box.setAttribute('aria-label', `${picture.title}. ${picture.note ?? ''} Arrow keys read values.`);
    this.values = document.createElement('output');
    this.values.className = 'values';
    this.figure.append(caption, this.box, this.values, this.legend(), this.table());
    place.append(this.figure);
    this.xs = [...new Set(picture.panels.flatMap((panel) =>
      panel.series.filter((s) => s.kind !== 'line' || panel.series.length === 1).flatMap((s) => s.points.map((p) => p[0]))))]
      .sort((a, b) => a - b);
    this.at = -1;
    this.box.addEventListener('pointermove', (event) => this.pointTo(event));
    this.box.addEventListener('pointerleave', () => this.show(-1));
    this.box.addEventListener('keydown', (event) => this.step(event));
    this.box.addEventListener('blur', () => this.show(-1));
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.box);
    this.show(-1);
    this.draw();
  }

  legend() {
    const list = document.createElement('ul');
    list.className = 'legend';
    const seen = new Set();
    for (const panel of this.picture.panels) {
      panel.series.forEach((series, number) => {
        if (!panel.title && !seen.has(series.name)) {
          seen.add(series.name);
          const item = document.createElement('li');
          item.className = `key k${number} ${series.kind}`;
          item.textContent = series.name;
          list.append(item);
        }
      });
    }
    const further = [
      ...this.picture.panels.flatMap((panel) => panel.series.filter((s) => s.inside).map((s) => [s.inside.name, 'inside'])),
      ...(this.picture.x.marks ?? []).map((mark) => [mark.name, 'k1 mark']),
    ];
    for (const [name, className] of further) {
      const item = document.createElement('li');
      item.className = `key ${className}`;
      item.textContent = name;
      list.append(item);
    }
    if (this.picture.note) {
      const item = document.createElement('li');
      item.textContent = this.picture.note;
      list.append(item);
    }
    return list;
  }

  // For those who do not see the picture, and to copy from.
  table() {
    const details = document.createElement('details');
    details.className = 'numbers-of-plot';
    const summary = document.createElement('summary');
    summary.textContent = 'Values as a table';
    details.append(summary);
    details.addEventListener('toggle', () => {
      if (details.open && details.children.length === 1) {
        const {x, panels} = this.picture;
        const head = [withUnit(x)];
        const columns = [];
        for (const panel of panels) {
          for (const series of panel.series.filter((s) => s.kind !== 'line' || panel.series.length === 1)) {
            head.push(`${series.name}: ${withUnit(panel)}`);
            columns.push(new Map(series.points.map((point) => [point[0], point[1]])));
          }
        }
        const cell = (column, value) => (column.has(value) ? shown(column.get(value), 6) : '');
        const rows = this.xs.map((value) => [shown(value, 6), ...columns.map((column) => cell(column, value))]);
        details.append(makeTable(head, rows));
      }
    });
    return details;
  }

  draw() {
    const {x, panels} = this.picture;
    const width = Math.max(280, this.box.clientWidth || 640);
    const height = TOP + panels.length * (PANEL_HEIGHT + GAP) - GAP + BOTTOM;
    const svg = svgElement('svg', {viewBox: `0 0 ${width} ${height}`, width, height, 'aria-hidden': 'true'});
    const xs = panels.flatMap((panel) => panel.series.flatMap((series) => series.points.map((point) => point[0])));
    const [least, most] = x.isLog ? rangeOf(xs, true) : x.range ?? [Math.min(...xs), Math.max(...xs)];
    this.x = new Scale(least, most, x.isLog, LEFT, width - RIGHT);
    panels.forEach((panel, number) => this.drawPanel(svg, panel, number, width));
    const bottom = height - BOTTOM;
    const ticks = this.x.ticks(Math.floor(width / 90));
    const {power, words} = labelsOf(ticks, x.isLog);
    ticks.forEach((tick, i) => {
      const at = this.x.at(tick);
      svgElement('line', {x1: at, x2: at, y1: bottom, y2: bottom + 4, class: 'axis'}, svg);
      svgElement('text', {x: at, y: bottom + 16, 'text-anchor': 'middle'}, svg).textContent = words[i];
    });
    svgElement('text', {x: (LEFT + width - RIGHT) / 2, y: height - 4, 'text-anchor': 'middle', class: 'axis-name'}, svg)
      .textContent = withUnit(x, power);
    for (const mark of x.marks ?? []) {
      svgElement('line', {x1: this.x.at(mark.at), x2: this.x.at(mark.at), y1: TOP, y2: bottom, class: 'line s1 mark'}, svg);
    }
    this.cursor = svgElement('line', {y1: TOP, y2: bottom, class: 'cursor', visibility: 'hidden'}, svg);
    this.box.replaceChildren(svg);
    this.width = width;
    if (this.at >= 0) {
      this.show(this.at);
    }
  }

  drawPanel(svg, panel, number, width) {
    const top = TOP + number * (PANEL_HEIGHT + GAP);
    const bottom = top + PANEL_HEIGHT;
    const ys = panel.series.flatMap((series) => series.points.flatMap((point) => point.slice(1)));
    const [least, most] = rangeOf([...ys, ...(panel.zero ? [0] : []), ...(panel.also ? [panel.also] : [])], panel.isLog);
    const y = new Scale(panel.from ?? least, most, panel.isLog, bottom, top);
    const ticks = y.ticks(5);
    const {power, words} = labelsOf(ticks, panel.isLog);
    ticks.forEach((tick, i) => {
      const at = y.at(tick);
      svgElement('line', {x1: LEFT, x2: width - RIGHT, y1: at, y2: at, class: 'grid'}, svg);
      svgElement('text', {x: LEFT - 6, y: at + 4, 'text-anchor': 'end'}, svg).textContent = words[i];
    });
    svgElement('rect', {x: LEFT, y: top, width: width - RIGHT - LEFT, height: PANEL_HEIGHT, class: 'frame'}, svg);
    svgElement('text', {x: 0, y: 0, 'text-anchor': 'middle', class: 'axis-name',
      transform: `translate(12 ${(top + bottom) / 2}) rotate(-90)`}, svg).textContent = withUnit(panel, power);
    panel.series.forEach((series, k) => this.drawSeries(svg, series, k, y));
    if (panel.title) {
      const title = svgElement('text', {x: width - RIGHT - 6, y: top + 15, 'text-anchor': 'end', class: 'panel-title'}, svg);
      title.textContent = panel.title;
    }
  }

  drawSeries(svg, series, k, y) {
    const places = series.points.filter((p) => Number.isFinite(p[1])).map((p) => [this.x.at(p[0]), y.at(p[1]), p]);
    if (series.kind === 'bars') {
      this.drawBars(svg, series, k, y);
      return;
    }
    if (series.kind === 'points') {
      for (const [px, py, point] of places) {
        if (point.length > 3) {
          svgElement('line', {x1: px, x2: px, y1: y.at(point[2]), y2: y.at(point[3]), class: `bar s${k}`}, svg);
        }
        svgElement('circle', {cx: px, cy: py, r: 2.6, class: `dot s${k}`}, svg);
      }
      return;
    }
    let path = '';
    places.forEach(([px, py], i) => {
      const step = series.kind === 'steps' && i > 0 ? `H${px.toFixed(2)}` : '';
      path += i === 0 ? `M${px.toFixed(2)} ${py.toFixed(2)}` : `${step}L${px.toFixed(2)} ${py.toFixed(2)}`;
    });
    svgElement('path', {d: path, class: `line s${k}`}, svg);
  }

  drawBars(svg, {points, width, inside}, k, y) {
    for (const [x, count] of points) {
      const [left, right] = [this.x.at(x - width / 2), this.x.at(x + width / 2)];
      const isInside = x > inside.range[0] && x < inside.range[1];
      svgElement('rect', {x: left, y: y.at(count), width: Math.max(right - left - 0.5, 0.5), height: y.at(0) - y.at(count),
        class: `column c${k}${isInside ? ' inside' : ''}`}, svg);
    }
  }

  pointTo(event) {
    const box = this.box.getBoundingClientRect();
    const wanted = ((event.clientX - box.left) / box.width) * this.width;
    let best = 0;
    this.xs.forEach((value, i) => {
      if (Math.abs(this.x.at(value) - wanted) < Math.abs(this.x.at(this.xs[best]) - wanted)) {
        best = i;
      }
    });
    this.show(best);
  }

  step(event) {
    const last = this.xs.length - 1;
    const to = {ArrowRight: Math.min(this.at + 1, last), ArrowLeft: Math.max(this.at - 1, 0), Home: 0, End: last}[event.key];
    if (to !== undefined) {
      event.preventDefault();
      this.show(to);
    }
  }

  show(at) {
    this.at = at;
    if (at < 0 || at >= this.xs.length) {
      this.values.textContent = 'Point at the picture, or use the arrow keys, to read values.';
      this.cursor?.setAttribute('visibility', 'hidden');
      return;
    }
    const value = this.xs[at];
    const {label, unit, digits} = this.picture.x;
    const words = [`${label} ${shown(value, digits ?? 5)} ${unit}`];
    for (const panel of this.picture.panels) {
      for (const series of panel.series) {
        const point = nearestPoint(series, value);
        if (point) {
          words.push(`${series.name} ${shown(point[1], 5)} ${panel.unit}`.trimEnd());
        }
      }
    }
    this.values.textContent = words.join(' · ');
    const px = this.x.at(value);
    this.cursor.setAttribute('x1', px);
    this.cursor.setAttribute('x2', px);
    this.cursor.setAttribute('visibility', 'visible');
  }
}

function withUnit(axis, power = 0) {
  const unit = [power === 0 ? '' : `10${raised(power)}`, axis.unit].filter(Boolean).join(' ');
  return unit ? `${axis.label} in ${unit}` : axis.label;
}

// What stands at the ticks: as many digits as tell them apart, and one power of ten that goes into the axis' name.
function labelsOf(ticks, isLog) {
  const most = Math.max(...ticks.map(Math.abs));
  if (isLog || ticks.length < 2 || !(most > 0)) {
    return {power: 0, words: ticks.map((tick) => shown(tick))};
  }
  const power = most < 1e-2 || most >= 1e5 ? 3 * Math.floor(Math.log10(most) / 3) : 0;
  const step = (ticks[1] - ticks[0]) / 10 ** power;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return {power, words: ticks.map((tick) => (tick / 10 ** power).toFixed(decimals).replace('-', '−'))};
}

// Of steps the value from there on; of lines the nearest; of points the one at just that place.
function nearestPoint(series, x) {
  if (series.kind === 'points' || series.kind === 'bars') {
    return series.points.find((point) => point[0] === x);
  }
  if (series.kind === 'steps') {
    return series.points.filter((point) => point[0] <= x).at(-1);
  }
  return series.points.reduce((best, point) => (!best || Math.abs(point[0] - x) < Math.abs(best[0] - x) ? point : best), null);
}

function makeTable(head, rows) {
  const table = document.createElement('table');
  table.className = 'numbers';
  const headRow = table.createTHead().insertRow();
  for (const text of head) {
    const cell = document.createElement('th');
    cell.scope = 'col';
    cell.textContent = text;
    headRow.append(cell);
  }
  const body = table.createTBody();
  for (const row of rows) {
    const line = body.insertRow();
    row.forEach((text, i) => {
      const cell = document.createElement(i === 0 ? 'th' : 'td');
      if (i === 0) {
        cell.scope = 'row';
      }
      if (text instanceof Node) {
        cell.append(text);
      } else {
        cell.textContent = text;
      }
      line.append(cell);
    });
  }
  const wide = document.createElement('div');
  wide.className = 'wide';
  wide.tabIndex = 0;
  wide.setAttribute('role', 'group');
  wide.setAttribute('aria-label', 'table');
  wide.append(table);
  return wide;
}
