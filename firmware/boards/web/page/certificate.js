// A device's results as they are read and printed.

function isSimulatedDevice(device) {
  return device.isSimulated || device.json.includes('\n  "simulated": true');
}

function setCertificate(place, device) {
  place.replaceChildren();
  const results = device.json ? JSON.parse(device.json) : {};
  place.classList.toggle('marked', isSimulatedDevice(device));
  if (isSimulatedDevice(device)) {
    addTo(place, 'p', 'banner').textContent = 'Simulation: this bench is not real, and the figures say nothing of a real device';
  }
  const title = addTo(place, 'h3', 'device-name');
  title.textContent = device.labels.device || 'Device without a name';
  const list = addTo(place, 'dl', 'rows');
  const row = (name, value) => {
    if (value) {
      addTo(list, 'dt').textContent = name;
      addTo(list, 'dd').textContent = value;
    }
  };
  LABELS.slice(1).forEach(([key, name]) => row(name, device.labels[key]));
  row(device.kind === 'results' ? 'Results' : 'Points', [device.source, device.understanding].filter(Boolean).join(': '));
  row('Instrument', device.instrument);
  for (const [name, value] of device.report ? conditionsOf(device.report) : conditionsOfResults(results)) {
    row(name, value);
  }
  setFigures(place, device);
  for (const [kind, className] of [['WARNING', 'warning'], ['Note', 'note']]) {
    for (const text of remarksOf(device.report, kind)) {
      addTo(place, 'p', className).textContent = `${kind === 'Note' ? 'Note' : 'Warning'}: ${text}`;
    }
  }
  if (!device.report && Array.isArray(results.warnings)) {
    results.warnings.forEach((warning) => {
      addTo(place, 'p', 'warning').textContent = `Warning: ${warning?.text}`;
    });
  }
  const fit = sectionOf(device.report, 'FIT');
  if (fit) {
    place.append(setSection({...fit, heading: 'FIT, AND HOW GOOD IT IS'}));
  }
  setPictures(place, device, results);
  if (!device.report) {
    return;
  }
  const whole = addTo(place, 'details', 'whole');
  addTo(whole, 'summary').textContent = 'The whole report';
  const text = addTo(whole, 'pre', 'report');
  text.tabIndex = 0;
  text.setAttribute('aria-label', 'report');
  text.textContent = reportWithLabels(device);
}

function setFigures(place, device) {
  const figures = figuresOfDevice(device);
  if (device.isPartial) {
    addTo(place, 'p', 'warning').textContent = 'The sweep broke off before the uncertainties of its points were known. ' +
      'Save points.csv, and read it as a table with an uncertainty of your own.';
    return;
  }
  if (!figures || figures.rows.length === 0) {
    const {fit} = device;
    if (fit === undefined) {
      addTo(place, 'p', 'warning').textContent = 'Not evaluated yet: "Evaluate again" computes its figures from the points.';
      return;
    }
    const found = fit ? `S = ${shown(fit.S, 6)} V/(m/s²), U = ${shown(2 * fit.uS, 2)} (k = 2)` : '';
    const known = fit ? ` The points give the sensitivity alone: ${found}.` : '';
    addTo(place, 'p', 'warning').textContent = `There are no figures for this device.${known}`;
    return;
  }
  const lead = addTo(place, 'dl', 'headline');
  addTo(lead, 'dt').textContent = figures.rows[0][0];
  addTo(lead, 'dd').textContent = `${withUncertainty(figures.rows[0])} % of S\u00a0a`;
  addTo(place, 'p', 'hint').textContent = `Largest error: ${figures.note.replace('+-', '±')}.`;
  place.append(makeTable(figures.head, figures.rows));
  addTo(place, 'p', 'hint').textContent = figures.words;
}

function setPictures(place, device, results) {
  const pictures = addTo(place, 'div', 'pictures');
  if (device.trace) {
    new Plot(pictures, responsePicture(pointsOf(device.trace), results.model));
  }
  if (results.energy) {
    new Plot(pictures, signalPicture(results, device.impulse));
  }
  if (device.impulse?.length > 0) {
    new Plot(pictures, impulsePicture(device.impulse, results.impulse_response ?? {}));
  }
  if (results.monte_carlo && device.histogram?.[1] > device.histogram?.[0]) {
    new Plot(pictures, histogramPicture(device.histogram, results));
  }
  if (results.trend?.points?.length > 1) {
    new Plot(pictures, trendPicture(results));
  }
}
