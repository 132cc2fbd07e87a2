// Links that run: #run=<lines, percent-encoded> executes the lines on the instrument in this page, and shows its answers.

const RUN = '#run=';

async function runLines(text) {
  element('job').hidden = true;
  element('run').hidden = false;
  element('lines').textContent = text;
  element('leave-run').addEventListener('click', (event) => {
    event.preventDefault();
    location.hash = '';
    location.reload();
  });
  const state = element('run-state');
  state.textContent = 'running';
  const port = await SimulatedPort.open([0, 0, 0], null);
  const pieces = [];
  const end = new Promise((resolve) => {
    port.onbytes = (bytes) => {
      pieces.push(bytes);
      if (port.isSettled) {
        resolve();
      }
    };
  });
  port.write(new TextEncoder().encode(text.endsWith('\n') ? text : `${text}\n`));
  await end;
  const answers = await new Blob(pieces).text();
  element('answers').textContent = answers;
  // The instrument's own words for what it has refused.
  const scpi = new Scpi(port);
  const errors = linesOfErrors(await scpi.ask('SYST:ERR:ALL?'));
  await port.close();
  state.textContent = errors.length > 0 ? `done, with errors: ${errors.join('; ')}` : 'done';
}

function textOfLink() {
  if (!location.hash.startsWith(RUN)) {
    return null;
  }
  try {
    return decodeURIComponent(location.hash.slice(RUN.length));
  } catch {
    return location.hash.slice(RUN.length);
  }
}
