// Order of what a search finds: tutorials first, then what uses a word, the developers' pages last.
const DEVELOPERS =
  "method|accuracy|steppers|promises|paper|league|" +
  "development|walk|dependencies|changelog";
const WEIGHTS = [
  [/^tutorials\//, 4],
  [/^generated\/c|^glossary$/, -4], // cases and commands; the glossary points to pages
  [RegExp(`^(${DEVELOPERS})$|^measured/`), -20],
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
