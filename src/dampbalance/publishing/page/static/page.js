/* The page reads without this: sections that fold, filters and search of the printed numbers, and reasons that open
   where a link leads. */
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

  // What is wider than its box says so.
  const sizes = new ResizeObserver((all) => {
    for (const box of new Set(all.map(({ target }) => target.closest('.wide, .drawing')))) box.classList.toggle('scrolls', box.scrollWidth > box.clientWidth + 1);
  });
  for (const one of document.querySelectorAll(':is(.wide, .drawing), :is(.wide, .drawing) > *')) sizes.observe(one);

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
