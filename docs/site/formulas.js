// MathJax of Debian: formulas as arithmatex marks them, drawn here and not fetched from elsewhere.
window.MathJax = {
  tex2jax: { inlineMath: [["\\(", "\\)"]], displayMath: [["\\[", "\\]"]], processEscapes: true },
  messageStyle: "none",
};
