/* The page reads without this: sections that fold, filters and search of the printed numbers, and reasons that open
   where a link leads; below, the values of the drawings. */
'use strict';
(() => {
  const $ = (id) => document.getElementById(id);
  document.documentElement.classList.add('scripted');

  // However a symbol is typed, it is found: φ or phi, b₁ or b_1.
  const GREEK = { φ: 'phi', ω: 'omega', ζ: 'zeta' };
  const plain = (s) => s.toLowerCase().replace(/[₀-₉ₖₛₘₙ]+/g, '_$&').normalize('NFKD')
    .replace(/[φωζ]/g, (letter) => GREEK[letter]).replace(/[−–]/g, '-').replace(/\s+/g, ' ');
  const wordsOf = (row) => {
    const copy = row.cloneNode(true);
    for (const index of copy.querySelectorAll('sub')) index.prepend('_');
    const symbol = row.id.replace(/\.([^.]+)$/, '_$1'); // table2.b.1 is found as b_1
    return plain([row.id, symbol, row.textContent, copy.textContent].join(' '));
  };

  // Sections are folded on a phone; a link opens what it leads to.
  if (matchMedia('(max-width: 46rem)').matches) {
    for (const one of document.querySelectorAll('.fold')) one.open = one.parentElement.matches('#instruments, #oscillator');
  }
  let show = () => {};
  const lead = () => {
    const target = $(decodeURIComponent(location.hash.slice(1).split('?')[0]));
    if (!target) return;
    document.querySelector(':popover-open')?.hidePopover();
    if (target.classList.contains('filtered')) show();
    const reason = 'kind' in target.dataset && (target.querySelector('details') ?? target.closest('details'));
    for (let one = reason || target.querySelector('.fold') || target; one; one = one.parentElement.closest('details')) one.open = true;
    target.scrollIntoView({ block: reason ? 'center' : 'start' });
    if (reason) reason.querySelector('summary').focus({ preventScroll: true });
  };

  if ($('claims')) {
    const form = document.querySelector('.filter');
    const [part, verdict, text] = ['filter-part', 'filter-verdict', 'filter-text'].map($);
    const rows = [...document.querySelectorAll('[data-kind]')].map((row) => ({ row, words: wordsOf(row) }));
    const KINDS = { computed: 'computed numbers', statement: 'statements', given: 'given values' };
    const given = $('given');
    form.hidden = false;

    const apply = () => {
      const wanted = plain(text.value.trim()).split(' ').filter(Boolean);
      const [found, all] = [{}, {}];
      for (const { row, words } of rows) {
        const fits = (!part.value || row.dataset.part === part.value)
          && (!verdict.value || row.dataset.verdict === verdict.value)
          && wanted.every((word) => words.includes(word));
        row.classList.toggle('filtered', !fits);
        const { kind } = row.dataset;
        [found[kind], all[kind]] = [(found[kind] ?? 0) + fits, (all[kind] ?? 0) + 1];
      }
      $('found').textContent = Object.keys(all).map((kind) => `${found[kind]} of ${all[kind]} ${KINDS[kind]}`).join(', ');
      $('none').hidden = Object.values(found).some(Boolean);
      if (given && wanted.length) given.open = found.given > 0;
    };
    const clear = () => { part.value = verdict.value = text.value = ''; if (given) given.open = false; apply(); };

    form.addEventListener('submit', (event) => event.preventDefault());
    form.addEventListener('input', apply);
    form.addEventListener('reset', (event) => { event.preventDefault(); clear(); });
    $('clear').addEventListener('click', () => { clear(); text.focus(); });

    const reasons = $('reasons');
    const all = [...document.querySelectorAll('.claims details')];
    reasons.addEventListener('click', () => {
      const open = reasons.getAttribute('aria-pressed') !== 'true';
      reasons.setAttribute('aria-pressed', open);
      reasons.textContent = open ? 'Close all reasons' : 'Open all reasons';
      for (const one of all) one.open = open;
    });

    document.querySelector('.counts').addEventListener('click', ({ target: { dataset } }) => {
      if (!dataset.verdict) return;
      clear();
      [part.value, verdict.value] = [dataset.part, dataset.verdict];
      apply();
    });

    show = clear;
    apply(); // a browser that comes back may have kept what stood in the form
  }

  addEventListener('hashchange', lead);
  document.addEventListener('click', (event) => { // again, to where it stands already
    if (event.target.closest('a')?.hash === location.hash && location.hash) lead();
  });
  lead();
})();

/* Drawings: the value at the pointer or chosen by the arrow keys, and the tables of all values. */
(() => {
  const TO = { linear: (v) => v, log: Math.log, asinh: (v, linear) => Math.asinh(v / linear) };
  const NEAR = 30; // px: farther from any mark, none is meant
  const cellsOf = (pre) => pre.innerHTML.split('\n').map((row) => row.split('\t'));

  /* The marks of a line: what they say, and where they stand in the units of the drawing. */
  const linesOf = (pre) => {
    const { x, y, up, scale: [kind, low, high, from, to, linear], at } = JSON.parse(pre.dataset.places);
    const [names, ...rows] = cellsOf(pre);
    const [a, b] = [TO[kind](low, linear), TO[kind](high, linear)];
    return names.slice(1).map((name, n) => rows.flatMap((row, i) => {
      if (row[n + 1] === '') return [];
      const value = from + ((TO[kind](Number(row[n + 1].replaceAll('−', '-')), linear) - a) / (b - a)) * (to - from);
      const place = (at[n] ?? at[0])[i];
      return [{ name, says: [[x, row[0]], [y, row[n + 1]]], x: up ? place : value, y: up ? value : place }];
    })).filter((line) => line.length);
  };

  for (const box of document.querySelectorAll('.drawing')) {
    const svg = box.querySelector('svg');
    const fold = box.parentElement.querySelector('.values');
    const [tip, spoken] = [box.querySelector('.tip'), box.nextElementSibling];
    const size = svg.viewBox.baseVal.width;
    let [lines, chosen] = [null, [0, -1]];

    const choose = (line, i) => {
      chosen = [line, i];
      const mark = lines[line]?.[i];
      tip.hidden = !mark;
      svg.querySelector('.ring')?.remove();
      if (!mark) { spoken.textContent = ''; return; }
      svg.insertAdjacentHTML('beforeend', `<circle class="ring" r="4" cx="${mark.x}" cy="${mark.y}"/>`);
      tip.innerHTML = [`<b>${mark.name}</b>`, ...mark.says.map(([what, value]) => `<span>${what}</span> ${value}`)].join('<br>');
      spoken.innerHTML = [mark.name, ...mark.says.map((pair) => pair.join(' '))].join(', ');
      const px = svg.clientWidth / size;
      tip.style.left = `${Math.max(0, mark.x * px + (mark.x > size / 2 ? -14 - tip.offsetWidth : 14))}px`;
      tip.style.top = `${Math.max(0, mark.y * px - tip.offsetHeight - 8)}px`;
    };
    const ready = () => { lines ??= [...fold.querySelectorAll('pre')].flatMap(linesOf); return lines; };
    const under = (event) => {
      const frame = svg.getBoundingClientRect();
      const px = frame.width / size;
      let [best, found] = [NEAR / px, [0, -1]];
      ready().forEach((line, n) => line.forEach((mark, i) => {
        const away = Math.hypot(mark.x - (event.clientX - frame.left) / px, mark.y - (event.clientY - frame.top) / px);
        if (away < best) [best, found] = [away, [n, i]];
      }));
      choose(...found);
    };
    for (const kind of ['pointermove', 'pointerdown']) box.addEventListener(kind, under);
    for (const kind of ['pointerleave', 'blur']) box.addEventListener(kind, () => lines && choose(0, -1));
    box.addEventListener('keydown', (event) => {
      const [line, i] = chosen;
      const last = ready()[line].length - 1;
      const keys = {
        ArrowRight: [line, Math.min(last, i + 1)], ArrowLeft: [line, Math.max(0, i - 1)], Home: [line, 0], End: [line, last],
        ArrowDown: [Math.min(lines.length - 1, line + 1), Math.max(0, i)], ArrowUp: [Math.max(0, line - 1), Math.max(0, i)], Escape: [0, -1],
      };
      if (!(event.key in keys) || event.ctrlKey || event.altKey || event.metaKey) return;
      const [to, n] = keys[event.key];
      choose(to, Math.min(n, lines[to].length - 1));
      svg.querySelector('.ring')?.scrollIntoView({ block: 'nearest', inline: 'nearest', behavior: 'instant' }); // where the drawing is wider than its box
      event.preventDefault();
    });
    fold.addEventListener('toggle', () => {
      for (const pre of ready() && fold.querySelectorAll('pre')) {
        const [head, ...rows] = cellsOf(pre);
        const row = (cells, tag) => `<tr>${cells.map((cell, n) => `<${n && tag === 'td' ? 'td' : `th scope="${tag === 'td' ? 'row' : 'col'}"`} class="num">${cell}`).join('')}`;
        pre.outerHTML = `<div class="wide" tabindex="0"><table><caption><span>${pre.dataset.title}</span></caption><thead>${row(head, 'th')}<tbody>${rows.map((cells) => row(cells, 'td')).join('')}</table></div>`;
      }
    }, { once: true });
  }
})();
