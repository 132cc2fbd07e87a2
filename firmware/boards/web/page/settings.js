// The settings, from the instrument's own list (*LRN?), with the words of its table of commands.

const GROUPS = [
  ['The question: filter, length and limit of the signal', /^CALC:(FILT|ENER)/],
  ['The reference and the channels', /^SENS:(?!SWE)/],
  ['The sweep', /^SENS:SWE/],
  ['The drive, and what it must never exceed', /^SOUR/],
  ['Monte Carlo and trend', /^CALC:(MCAR|TREN)/],
];

// [SENSe:]REFerence:GAIN is answered as SENS:REF:GAIN.
function shortForm(pattern) {
  return pattern.replace(/[[\]]/g, '').replace(/[a-z]/g, '');
}

// The table that `emax scpi --commands` prints.
function commandsOf(table) {
  const rows = table.trim().split('\n').slice(2);
  return rows.map((row) => {
    const [, pattern, forms, parameters, words] = row.split(/(?<!\\)\|/).map((cell) => cell.trim().replace(/\\\|/g, '|'));
    return {pattern: pattern.replaceAll('`', ''), forms, parameters: parameters.replaceAll('`', ''), words};
  });
}

// *LRN? as [{header, value}]. What limits others is freed first, so some come twice: the last value holds.
function settingsOf(learnt) {
  const values = new Map();
  let path = '';
  for (const part of learnt.split(';')) {
    const [written, ...value] = part.split(' ');
    const header = written.startsWith(':') ? written.slice(1) : path + written;
    path = header.slice(0, header.lastIndexOf(':') + 1);
    values.delete(header);
    values.set(header, value.join(' '));
  }
  return [...values].map(([header, value]) => ({header, value}));
}

// 2.0E-3 as 0.002, also in lists.
function readable(value) {
  return value.split(',').map((part) => (/^-?[\d.]+E-?\d+$/.test(part) ? String(Number(part)) : part)).join(',');
}

// Whose a setting is that both sensors have.
function ownerOf(header) {
  return {'SENS:REF': 'Reference: ', 'SENS:DEV': 'Device: '}[header.slice(0, 8)] ?? '';
}

class SettingsForm {
  constructor(place, commands, change) {
    this.place = place;
    this.words = new Map(commands.map((command) => [shortForm(command.pattern), command]));
    this.change = change;
    this.fields = new Map();
  }

  // ask: for MINimum, MAXimum and DEFault of a setting, once somebody is about to change it.
  show(learnt, ask) {
    this.ask = ask;
    const settings = settingsOf(learnt);
    if (settings.map((s) => s.header).join() !== [...this.fields.keys()].join()) {
      this.build(settings);
    }
    for (const {header, value} of settings) {
      const field = this.fields.get(header);
      field.value = readable(value);
      field.put();
    }
  }

  build(settings) {
    this.fields.clear();
    this.place.replaceChildren();
    const rest = new Set(settings);
    for (const [title, pattern] of [...GROUPS, ['Others', /./]]) {
      // *LRN? has what depends on others first; people begin with what all depends on.
      const members = [...rest].filter((setting) => pattern.test(setting.header)).reverse();
      if (members.length > 0) {
        const details = addTo(this.place, 'details');
        addTo(details, 'summary').textContent = title;
        const fields = addTo(details, 'div', 'fields');
        for (const setting of members) {
          rest.delete(setting);
          this.addField(fields, setting);
        }
      }
    }
    // In the order of the list, which the next one is compared with.
    this.fields = new Map(settings.map((setting) => [setting.header, this.fields.get(setting.header)]));
  }

  addField(place, {header, value}) {
    const command = this.words.get(header) ?? {words: header, parameters: ''};
    const label = addTo(place, 'label');
    label.append(`${ownerOf(header)}${command.words} `);
    addTo(label, 'code').textContent = header;
    const choices = /^[A-Za-z0-9|]+$/.test(command.parameters) ? command.parameters.split('|') : [];
    const input = addTo(label, choices.length > 1 ? 'select' : 'input');
    for (const choice of choices) {
      addTo(input, 'option').value = shortForm(choice);
      input.lastChild.textContent = choice;
    }
    const hint = addTo(label, 'span', 'hint');
    hint.textContent = command.parameters;
    const isSwitch = command.parameters === '<on>';
    if (isSwitch) {
      input.type = 'checkbox';
      label.className = 'check';
    }
    const field = {input, hint, value, parameters: command.parameters};
    field.put = () => {
      input.value = field.value;
      input.checked = isSwitch && field.value !== '0';
    };
    field.taken = () => (isSwitch ? String(Number(input.checked)) : input.value);
    input.autocomplete = 'off';
    input.dataset.header = header;
    input.addEventListener('change', () => this.changed(header));
    input.addEventListener('focus', () => this.explain(header), {once: true});
    this.fields.set(header, field);
  }

  // Only plain numbers have a range.
  async explain(header) {
    const field = this.fields.get(header);
    if (!/^<[^,.|]*>(\[|$)/.test(field.parameters) || !this.ask) {
      return;
    }
    try {
      const range = [];
      for (const word of ['MIN', 'MAX', 'DEF']) {
        range.push(await this.ask(`${header}? ${word}`));
      }
      field.hint.textContent = `${field.parameters}, ${range[0]} to ${range[1]}, by default ${range[2]}`;
    } catch {
      // It has none, or the instrument has something else to do.
    }
  }

  async changed(header) {
    const field = this.fields.get(header);
    field.input.removeAttribute('aria-invalid');
    const problem = await this.change(header, field.taken());
    if (problem) {
      field.hint.textContent = problem;
      field.hint.classList.add('refused');
      field.put();
      field.input.setAttribute('aria-invalid', 'true');
    } else {
      field.hint.textContent = field.parameters;
      field.hint.classList.remove('refused');
    }
  }
}
