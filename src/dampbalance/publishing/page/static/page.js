/* Filters and search of the printed numbers; reasons that open where a link leads. The page reads without this. */
'use strict';
(() => {
  const $ = (id) => document.getElementById(id);
  document.documentElement.classList.add('scripted');

  const table = $('claims');
  if (table) {
    const form = document.querySelector('.filter');
    const [part, verdict, text] = ['filter-part', 'filter-verdict', 'filter-text'].map($);
    const plain = (s) => s.toLowerCase().replaceAll('−', '-').replace(/\s+/g, ' ');
    const rows = [...table.tBodies[0].rows].map((row) => ({ row, words: plain(`${row.id} ${row.textContent}`) }));
    form.hidden = false;

    const apply = () => {
      const wanted = plain(text.value.trim()).split(' ').filter(Boolean);
      let found = 0;
      for (const { row, words } of rows) {
        const fits = (!part.value || row.dataset.part === part.value)
          && (!verdict.value || row.dataset.verdict === verdict.value)
          && wanted.every((word) => words.includes(word));
        row.classList.toggle('filtered', !fits);
        found += fits;
      }
      $('found').textContent = `${found} of ${rows.length} numbers`;
      $('none').hidden = found > 0;
    };
    const clear = () => { part.value = verdict.value = text.value = ''; apply(); };

    form.addEventListener('submit', (event) => event.preventDefault());
    form.addEventListener('input', apply);
    form.addEventListener('reset', (event) => { event.preventDefault(); clear(); });
    $('clear').addEventListener('click', () => { clear(); text.focus(); });

    const reasons = $('reasons');
    const all = [...table.querySelectorAll('details')];
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
      if (!row || !table.contains(row)) return;
      if (row.classList.contains('filtered')) clear();
      row.querySelector('details').open = true;
      row.scrollIntoView({ block: 'center' });
      row.querySelector('summary').focus({ preventScroll: true });
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
