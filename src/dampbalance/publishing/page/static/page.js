/* Filters and search of the printed numbers; reasons that open where a link leads. The page reads without this. */
'use strict';
(() => {
  const $ = (id) => document.getElementById(id);
  document.documentElement.classList.add('scripted');

  // However a symbol is typed, it is found: φ or phi, b₁ or b_1.
  const GREEK = { φ: 'phi', ϕ: 'phi', ω: 'omega', ζ: 'zeta' };
  const LOWERED = Object.fromEntries([...'₀₁₂₃₄₅₆₇₈₉ₖₛₘₙ'].map((sign, i) => [sign, '0123456789ksmn'[i]]));
  const plain = (s) => s.toLowerCase()
    .replace(/[φϕωζ]/g, (letter) => GREEK[letter])
    .replace(/[₀-₉ₖₛₘₙ]+/g, (run) => `_${[...run].map((sign) => LOWERED[sign]).join('')}`)
    .replace(/[−–]/g, '-').replace(/\s+/g, ' ');
  const wordsOf = (row) => {
    const copy = row.cloneNode(true);
    for (const index of copy.querySelectorAll('sub')) index.prepend('_');
    const symbol = row.id.replace(/\.([^.]+)$/, '_$1'); // table2.b.1 is found as b_1
    return plain([row.id, symbol, row.textContent, copy.textContent].join(' '));
  };

  const table = $('claims');
  if (table) {
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

    for (const link of document.querySelectorAll('.counts a')) {
      link.addEventListener('click', () => {
        clear();
        part.value = link.dataset.part;
        verdict.value = link.dataset.verdict;
        apply();
      });
    }

    const lead = () => {
      const row = location.hash && $(decodeURIComponent(location.hash.slice(1)));
      if (!row || !(row.dataset.kind || row === given)) return;
      if (row.classList.contains('filtered')) clear();
      const fold = row.querySelector('details') ?? row.closest('details');
      fold.open = true;
      row.scrollIntoView({ block: 'center' });
      fold.querySelector('summary').focus({ preventScroll: true });
    };
    addEventListener('hashchange', lead);
    lead();
    apply(); // a browser that comes back may have kept what stood in the form
  }

  for (const link of document.querySelectorAll('[data-close]')) {
    link.addEventListener('click', () => link.closest('[popover]').hidePopover());
  }

  // Print shows everything that can be opened, and puts it back afterwards.
  let opened = [];
  addEventListener('beforeprint', () => {
    opened = [...document.querySelectorAll('details:not([open])')];
    for (const one of opened) one.open = true;
  });
  addEventListener('afterprint', () => { for (const one of opened) one.open = false; });
})();
