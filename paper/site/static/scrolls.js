/* Tables, screens and pictures that are wider than their box say so; site.css has the words. */
'use strict';
const sizes = new ResizeObserver((all) => {
  for (const { target } of all) {
    const more = target.scrollWidth > target.clientWidth + 1;
    target.classList.toggle('scrolls', more);
    if (more) target.tabIndex = 0; // the keyboard reaches it
  }
});
for (const box of document.querySelectorAll('.pst-scrollable-table-container, .highlight-screen pre, div.equation, article :has(> img)')) sizes.observe(box);
