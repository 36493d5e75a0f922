/* Tables, screens and pictures that are wider than their box say so; site.css has the words. */
'use strict';
const sizes = new ResizeObserver((all) => {
  for (const { target } of all) target.classList.toggle('scrolls', target.scrollWidth > target.clientWidth + 1);
});
for (const box of document.querySelectorAll('.pst-scrollable-table-container, .highlight-screen pre, div.equation, article :has(> img)')) sizes.observe(box);
