/* Change a printed digit: which verdicts notice. All of them were judged when the page was made; here they are looked up. */
kit.instrument('misprint', (it) => {
  'use strict';
  const { raised } = kit;
  const { verdicts, looks, was, reasons, because, sets, numbers, names, parts } = it.data.digits;
  const chip = (place) => `<span class="chip v-${looks[place][0]}"><span class="mark" aria-hidden="true">${looks[place][1]}</span> ${verdicts[place]}</span>`;
  const of = (id) => `${parts[id.split('.')[0]]}, ${names[id]}`;

  // Every change with the verdicts that get worse and better by it.
  const effect = (id, [, own, , , set]) => {
    const all = [[id, own, -1], ...sets[set]].filter(([one, now]) => now !== was[one]);
    return { all, worse: all.filter(([one, now]) => now > was[one]) };
  };
  const every = Object.entries(numbers).flatMap(([id, [, changes]]) => changes.map((change) => effect(id, change)));
  const unnoticed = every.filter(({ worse }) => !worse.length).length;

  const places = it.find('.places');
  let built = '';

  // A column per digit: one up, the digit, one down. Changes stand in pairs, the last digit first.
  function build(id) {
    const [printed, changes] = numbers[id];
    const mantissa = printed.split(/e/i)[0];
    let place = mantissa.replace(/\D/g, '').length;
    built = id;
    const exponent = raised(printed).slice(raised(mantissa).length);
    places.innerHTML = [...raised(mantissa), ...(exponent ? [exponent] : [])].map((sign) => {
      if (!/\d/.test(sign) || sign === exponent) return `<span class="digit"><b>${sign}</b></span>`;
      place -= 1;
      if (2 * place >= changes.length) return `<span class="digit"><b>${sign}</b></span>`;
      const button = (i, arrow, words) => `<button type="button" name="to" value="${changes[i][0]}" aria-label="${words}: ${raised(changes[i][0])}">${arrow}</button>`;
      return `<span class="digit">${button(2 * place, '▲', 'one up')}<b>${sign}</b>${button(2 * place + 1, '▼', 'one down')}</span>`;
    }).join('');
  }
  it.control('to', '', String);

  function draw({ number: id, to }) {
    if (built !== id) build(id);
    const [printed, changes] = numbers[id];
    const change = changes.find(([text]) => text === to);
    for (const button of places.querySelectorAll('button')) button.setAttribute('aria-pressed', button.value === to);
    const rate = `Of all ${every.length} changes of one digit by one in Tables 1 to 3, <b>${unnoticed}</b> make no verdict worse.`;
    if (!change) {
      it.write('.words', `${of(id)} is printed as <b>${raised(printed)}</b>: ${chip(was[id])}. Move one of its digits up or down. ${rate}`);
      it.write('.noticed', '');
      return;
    }
    const { all, worse } = effect(id, change);
    const [text, , reason, values] = change;
    const given = values.split(' ');
    const sentence = reasons[reason].replace(/#/g, () => given.shift());
    it.write('.words', `Had the paper printed <b>${raised(text)}</b> instead of ${raised(printed)}, ${worse.length ? `${worse.length} verdict${worse.length > 1 ? 's' : ''} would be worse` : '<b>nobody would notice</b>: no verdict would be worse'}${all.length > worse.length ? ` and ${all.length - worse.length} better` : ''}. ${rate}`);
    it.write('.noticed', all.map(([one, now, why]) => `<tr><th scope="row">${of(one)}</th><td>${chip(was[one])} → ${chip(now)}</td><td>${why < 0 ? sentence : because[why]}</td></tr>`).join(''));
  }

  it.code(() => ({ id: it.values.number, to: it.values.to || numbers[it.values.number][0] }));
  return draw;
});
