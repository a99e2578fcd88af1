// Formulas are typeset when a page is shown. Tables that scroll take the keyboard; buttons to copy are no landmarks.
for (const formula of document.querySelectorAll('.arithmatex')) {
  const text = formula.textContent.trim();
  const isDisplay = text.startsWith('\\[');
  katex.render(text.slice(2, -2), formula, { displayMode: isDisplay, throwOnError: false });
}
new MutationObserver(() => {
  for (const element of document.querySelectorAll('.md-typeset__scrollwrap, .katex-display, pre > code')) element.tabIndex = 0;
  for (const element of document.querySelectorAll('.md-code__nav')) element.setAttribute('role', 'group');
}).observe(document.body, { childList: true, subtree: true });
