// The pictures of a device, from its results.json and its points; and the one of a comparison.

const RESPONSE_STEPS = 240;
const MOST_ERROR_STEPS = 1000;
const CLOSE = 1e-3;
const MOST_OFF = 0.01;  // Of the energy of an error that is shown; no eye sees less.

// Points as FETCh:TRACe? has them: f, A, phi, U(A), U(phi) with k = 2; an unknown phase has a huge U.
function pointsOf(trace) {
  return linesOf(trace).map((line) => line.split(',').map(Number));
}

// The same in the digits that they came in.
function linesOf(trace) {
  return trace.match(/[^,]+(,[^,]+){4}/g) ?? [];
}

function modelResponse({S, f0, beta}, frequency) {
  const r = frequency / f0;
  const real = 1 - r * r;
  const imaginary = 2 * beta * r;
  return [S / Math.hypot(real, imaginary), (-Math.atan2(imaginary, real) * 180) / Math.PI];
}

function responsePicture(points, model) {
  const known = points.filter((p) => Math.abs(p[4]) < 1e4);
  const amplitude = [{name: 'measured', kind: 'points', points: points.map((p) => [p[0], p[1], p[1] - p[3], p[1] + p[3]])}];
  const phase = [{name: 'measured', kind: 'points', points: known.map((p) => [p[0], p[2], p[2] - p[4], p[2] + p[4]])}];
  const panels = [{label: 'amplitude', unit: 'V/(m/s²)', series: amplitude}];
  if (known.length > 0) {
    panels.push({label: 'phase', unit: '°', series: phase});
  }
  if (model?.f0 > 0 && model?.beta !== null && points.length > 1) {
    const from = points[0][0];
    const factor = (points.at(-1)[0] / from) ** (1 / RESPONSE_STEPS);
    const curve = Array.from({length: RESPONSE_STEPS + 1}, (_, i) => from * factor ** i);
    amplitude.push({name: 'fitted', kind: 'line', points: curve.map((f) => [f, modelResponse(model, f)[0]])});
    phase.push({name: 'fitted', kind: 'line', points: curve.map((f) => [f, modelResponse(model, f)[1]])});
    const deviations = points.map((p) => {
      const fitted = modelResponse(model, p[0])[0];
      const off = 100 * (p[1] / fitted - 1);
      const room = (100 * p[3]) / fitted;
      return [p[0], off, off - room, off + room];
    });
    panels.push({title: 'measured over fitted', label: 'deviation', unit: '%', zero: true,
      series: [{name: 'measured over fitted', kind: 'points', points: deviations}]});
  }
  return {title: 'Frequency response', note: 'Bars are ± U (k = 2).', x: {label: 'frequency', unit: 'Hz', isLog: true}, panels};
}

function stepsOf(times, duration, limit) {
  const points = [[0, limit]];
  const turns = Array.isArray(times) ? times.filter((t) => t < duration) : [];
  turns.forEach((t, i) => points.push([1e3 * t, i % 2 === 0 ? -limit : limit]));
  points.push([1e3 * duration, points.at(-1)[1]]);
  return points;
}

// The integral of k at its times: through each three of them goes a parabola.
function integralOf(impulse) {
  const step = impulse[1][0] - impulse[0][0];
  const sums = [0];
  for (let i = 1; i < impulse.length; ++i) {
    const at = Math.min(i, impulse.length - 2);  // The middle one.
    const [before, middle, after] = [at - 1, at, at + 1].map((j) => impulse[j][1]);
    const area = i === at ? 5 * before + 8 * middle - after : 5 * after + 8 * middle - before;
    sums.push(sums.at(-1) + (step / 12) * area);
  }
  return sums;
}

// y(t) of sensor minus filter for the worst signal, a at the start: [t, y] from its impulse response. Empty where that is
// known too coarsely, which shows in an energy that is not the instrument's.
function errorOf({energy}, impulse) {
  if (energy.criterion !== 'ise' || !(impulse?.length > 2)) {
    return [];
  }
  const step = impulse[1][0] - impulse[0][0];
  const sums = integralOf(impulse);
  const answer = (t) => {
    const at = Math.min(Math.max(t, 0) / step, sums.length - 1);
    const i = Math.min(Math.floor(at), sums.length - 2);
    return sums[i] + (at - i) * (sums[i + 1] - sums[i]);
  };
  const steps = Math.min(Math.max(Math.round(energy.T / step), 1), MOST_ERROR_STEPS);
  const points = Array.from({length: steps + 1}, (_, i) => {
    const t = (i * energy.T) / steps;
    const turns = energy.switch_times.reduce((sum, at, k) => sum + (k % 2 === 0 ? -2 : 2) * answer(t - at), answer(t));
    return [t, energy.a * turns];
  });
  const found = points.reduce((sum, [, y], i) => sum + (i === 0 || i === steps ? 0.5 : 1) * y * y, 0) * (energy.T / steps);
  return Math.abs(found / energy.E - 1) < MOST_OFF ? points : [];
}

function signalPicture(results, impulse) {
  const {energy, band} = results;
  const panels = [];
  const room = 0.35 * energy.a;  // For the title of the panel.
  const add = (label, times) => panels.push({title: label, label: 'x', unit: 'm/s²', also: energy.a + room, zero: true,
    series: [{name: label, kind: 'steps', points: stepsOf(times, energy.T, energy.a)}]});
  if (band?.matched) {
    add('worst signal in band, delay taken out', band.matched.switch_times);
  }
  if (band) {
    add('worst signal in band, with the delay', band.switch_times);
  }
  add("worst signal of the paper's figure", energy.switch_times);
  const error = errorOf(results, impulse);
  if (error.length > 0) {
    panels.push({title: 'error that this last signal causes', label: 'y', unit: 'V', zero: true,
      series: [{name: 'error', kind: 'line', points: error.map(([t, y]) => [1e3 * t, y])}]});
  }
  return {title: 'The signals that cause the largest errors',
    note: 'Each panel has one of them; none within ±a is known to be worse.',
    x: {label: 'time', unit: 'ms'}, panels};
}

// Until it has settled, and half as long again.
function impulsePicture(whole, {settling_time_s: settling}) {
  const impulse = whole.filter(([t]) => !(settling > 0) || t <= 1.5 * settling);
  return {title: 'Impulse response of the error', x: {label: 'time', unit: 'ms'},
    panels: [{label: 'k', unit: 'V/(m/s)', zero: true,
      series: [{name: 'sensor minus filter', kind: 'line', points: impulse.map(([t, k]) => [1e3 * t, k])}]}]};
}

// bins: low, high and the counts between them. Of energies that hardly differ, the difference to E is shown.
function histogramPicture([low, high, ...counts], {energy, monte_carlo: trials}) {
  const isClose = high - low < CLOSE * high;
  const shift = (value) => (isClose ? value - energy.E : value);
  const width = (high - low) / counts.length;
  // Over the box of the paper the trials' own interval is none of E.
  const interval = `${shown(100 * trials.probability)} % ${trials.distribution === 'normal' ? 'coverage interval' : 'of the trials'}`;
  return {title: 'Energy within the uncertainties', note: `Of ${trials.trials} devices drawn at random within them (Monte Carlo).`,
    x: {label: isClose ? 'E minus E at the estimates' : 'E', unit: 'V² s', digits: 6,
      range: [shift(Math.min(low, energy.E)), shift(Math.max(high, energy.E))],
      marks: [{name: 'E at the estimates', at: shift(energy.E)}]},
    panels: [{label: 'trials', unit: '', from: 0,
      series: [{name: 'trials', kind: 'bars', width, inside: {name: interval, range: trials.interval.map(shift)},
        points: counts.map((count, i) => [shift(low + (i + 0.5) * width), count])}]}]};
}

function trendPicture({trend, energy}) {
  const points = trend.points.map(([t, e]) => [1e3 * t, e]);
  const known = Number.isFinite(energy?.bound) ? [[1e3 * energy.T, energy.bound]] : [];
  return {title: 'Largest energy against the length of the signal', x: {label: 'length T', unit: 'ms'},
    panels: [{label: 'E', unit: 'V² s', zero: true, series: [
      {name: 'found', kind: 'points', points},
      {name: 'line', kind: 'line', points: points.map(([ms]) => [ms, trend.slope * ms * 1e-3 + trend.intercept])},
      ...(known.length > 0 ? [{name: 'none exceeds', kind: 'points', points: known}] : [])]}]};
}

// Values with their intervals, a row each. rows: {name, value, low, high, bound}, in percent of S a.
function drawRanking(place, rows, unit) {
  const draw = () => place.replaceChildren(rankingOf(rows, unit, Math.max(280, place.clientWidth || 640)));
  new ResizeObserver(draw).observe(place);
  draw();
}

function rankingOf(rows, unit, width) {
  const row = 34;
  const height = rows.length * row + 46;
  const left = Math.min(180, width * 0.34);
  const [, most] = rangeOf(rows.flatMap((r) => [r.value, r.high ?? r.value, r.bound ?? r.value]), false);
  const x = new Scale(0, most, false, left, width - RIGHT);
  const names = rows.map((r) => `${r.name} ${shown(r.value)}`).join('; ');
  const svg = svgElement('svg', {viewBox: `0 0 ${width} ${height}`, width, height, role: 'img',
    'aria-label': `Figures in ${unit}: ${names}`});
  for (const tick of x.ticks(Math.floor(width / 110))) {
    svgElement('line', {x1: x.at(tick), x2: x.at(tick), y1: 4, y2: height - 38, class: 'grid'}, svg);
    svgElement('text', {x: x.at(tick), y: height - 22, 'text-anchor': 'middle'}, svg).textContent = shown(tick);
  }
  rows.forEach((r, i) => {
    const y = 4 + row * (i + 0.5);
    const room = Math.floor(left / 7);
    const name = r.name.length > room ? `${r.name.slice(0, room - 1)}…` : r.name;
    svgElement('text', {x: left - 8, y: y + 4, 'text-anchor': 'end'}, svg).textContent = name;
    if (r.low !== null && r.high !== null) {
      svgElement('line', {x1: x.at(r.low), x2: x.at(r.high), y1: y, y2: y, class: 'range s0'}, svg);
    }
    if (r.bound !== null) {
      svgElement('line', {x1: x.at(r.bound), x2: x.at(r.bound), y1: y - 9, y2: y + 9, class: 'bound'}, svg);
    }
    svgElement('circle', {cx: x.at(r.value), cy: y, r: 4, class: 'dot s0'}, svg);
  });
  svgElement('text', {x: (left + width) / 2, y: height - 4, 'text-anchor': 'middle', class: 'axis-name'}, svg).textContent = unit;
  return svg;
}
