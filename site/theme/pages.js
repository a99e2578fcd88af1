// Formulas are typeset when a page is shown. Tables that scroll take the keyboard; buttons to copy have names.
for (const formula of document.querySelectorAll('.arithmatex')) {
  const text = formula.textContent.trim();
  const isDisplay = text.startsWith('\\[');
  katex.render(text.slice(2, -2), formula, { displayMode: isDisplay, throwOnError: false });
}
new MutationObserver(() => {
  for (const element of document.querySelectorAll('.md-typeset__scrollwrap, .katex-display, pre > code')) element.tabIndex = 0;
  document.querySelectorAll('.md-code__nav').forEach((element, i) => element.setAttribute('aria-label', `Code ${i + 1}`));
}).observe(document.body, { childList: true, subtree: true });
