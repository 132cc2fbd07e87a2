// What is done with an instrument: take points, sweep, evaluate, fetch the results. Speaks SCPI and nothing else.

const SWEEPING = 8 + 16;
const COMPUTING = 256;
const SLOW_MS = 120000;
const FEWEST_OF_IMPULSE = 240;
const MOST_OF_IMPULSE = 1200;
const STEPS_PER_PERIOD = 20;  // Enough to integrate over.
const IMPULSE_BATCH = 40;

class Job {
  constructor(scpi, isSlow) {
    this.scpi = scpi;
    this.pause = isSlow ? 250 : 60;
    this.batch = isSlow ? 5 : 40;
    this.isStopped = false;
  }

  async identify() {
    const identity = await this.scpi.ask('*IDN?');
    if (!identity.startsWith('emax,')) {
      throw new Error(`this instrument says it is ${identity.slice(0, 80)}, not emax`);
    }
    return {identity, isSimulated: (await this.scpi.ask('*OPT?')) === 'SIM'};
  }

  // Each line on its way in a piece that a board's console has room for.
  async sendLines(lines) {
    for (let i = 0; i < lines.length; i += this.batch) {
      await this.scpi.tell(lines.slice(i, i + this.batch).join('\n'));
    }
  }

  async takeTable(lines, reference) {
    await this.scpi.tell('TRAC:FRES:CLE');
    await this.scpi.tell(`CALC:REF:UNC ${reference || '0'}`);
    await this.sendLines(lines);
  }

  // What runs, and what would be started next.
  stop() {
    this.isStopped = true;
    if (!this.scpi.ended) {
      this.scpi.abort();
    }
  }

  // Until nothing of `mask` runs any more. onstep: percent, stage, number of points.
  async follow(mask, onstep) {
    const problems = [];
    for (;;) {
      const {answers, errors} = await this.scpi.exchange('SYST:PROG?;:STAT:OPER:COND?;:TRAC:FRES:POIN?');
      problems.push(...errors);
      const [, percent, stage, condition, points] = /^(\d+),"([^"]*)";(\d+);(\d+)$/.exec(answers[0] ?? '') ?? [];
      if (condition === undefined) {
        throw new Refusal(problems.join('; ') || `progress was answered as ${answers[0]}`);
      }
      const runs = (Number(condition) & mask) !== 0;
      await onstep(Number(percent), stage, Number(points), runs);
      if (!runs) {
        return problems;
      }
      if (this.isStopped) {
        this.scpi.abort();  // The one before may have overtaken what began this.
      }
      await new Promise((resolve) => setTimeout(resolve, this.pause));
    }
  }

  // onpoint: each point as it is measured. Returns what went wrong, in the instrument's words.
  async sweep(onprogress, onpoint) {
    await this.scpi.tell('TRAC:FRES:CLE');
    await this.scpi.tell('INIT');
    let known = 0;
    return this.follow(SWEEPING, async (percent, stage, points) => {
      for (; known < points; ++known) {
        onpoint((await this.scpi.ask(`FETC:FRES:POIN? ${known + 1}`)).split(',').map(Number));
        onprogress(percent, stage);
      }
      onprogress(percent, stage);
    });
  }

  // As FETCh:TRACe?, with the common part of the uncertainty; nothing without points.
  async points() {
    if ((await this.scpi.ask('TRAC:FRES:POIN?')) === '0') {
      return {trace: '', reference: '0'};
    }
    return {trace: await this.scpi.ask('FETC:TRAC?', SLOW_MS), reference: await this.scpi.ask('CALC:REF:UNC?')};
  }

  async evaluate(onprogress) {
    await this.scpi.tell('INIT:REP');
    return this.follow(COMPUTING, onprogress);
  }

  async results() {
    const report = await this.scpi.ask('CALC:REP?', SLOW_MS);
    const json = await this.scpi.ask('FETC:JSON?', SLOW_MS);
    const results = JSON.parse(json);
    return {report, json, impulse: await this.impulse(results), histogram: await this.histogram(results)};
  }

  // As CALCulate:MCARlo:HISTogram?; nothing without trials, and from firmware that has no such question yet.
  async histogram({monte_carlo: trials}) {
    if (!trials) {
      return [];
    }
    const {answers} = await this.scpi.exchange('CALC:MCAR:HIST?', SLOW_MS);
    return (answers[0] ?? '').split(',').filter(Boolean).map(Number);
  }

  // What there is of a fit where the points give no more than S; nothing if there is not even that.
  async sensitivity() {
    const {answers} = await this.scpi.exchange('CALC:IDEN?');
    const [S, , , uS] = (answers[0] ?? '').split(',').map(Number);
    return S > 0 ? {S, uS} : null;
  }

  // As long as it lives, and as closely as it rings, if that takes not too many values.
  async impulse({impulse_response: response, energy, model, filter}) {
    if (!response || !energy) {
      return [];
    }
    const life = response.settling_time_s > 0 ? 4 * response.settling_time_s : energy.T;
    const whole = Math.min(energy.T, life);
    const wanted = Math.ceil(STEPS_PER_PERIOD * Math.max(model.f0, filter.cutoff) * whole);
    const length = wanted <= MOST_OF_IMPULSE ? whole : Math.min(energy.T, (1.5 / 4) * life);
    const steps = wanted <= MOST_OF_IMPULSE ? Math.max(wanted, FEWEST_OF_IMPULSE) : FEWEST_OF_IMPULSE;
    const times = Array.from({length: steps + 1}, (_, i) => Number(((i * length) / steps).toPrecision(12)));
    const values = [];
    for (let i = 0; i < times.length; i += IMPULSE_BATCH) {
      const query = `CALC:IMP? ${times.slice(i, i + IMPULSE_BATCH).join(',')}`;
      values.push(...(await this.scpi.ask(query, SLOW_MS)).split(',').map(Number));
    }
    return times.map((t, i) => [t, values[i]]);
  }
}
