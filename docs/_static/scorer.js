// Order of what a search finds: what explains a word before the cases and lists that use it.
const WEIGHTS = [
  [/^glossary$/, 20],
  [/^tutorials\//, 4],
  [/^generated\/cases\//, -4],
  [/^(changelog|league|promises)$|^measured\//, -4],
];

var Scorer = {
  score: ([docname, title, anchor, descr, score]) =>
    WEIGHTS.reduce((sum, [pages, weight]) => sum + (pages.test(docname) ? weight : 0), score),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
