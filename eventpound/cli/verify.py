"""Bound the error of every peak, event and final value of a case.

Compute a case by independent routes (fast, CVODE Adams and BDF, IDA; under records in
relative coordinates, too; CVODE alone where contacts have a law of their own), each at two
tolerances, change the inputs in their last digits, and bound the error of every peak, its
time, every event and every final value.

It writes certificate.json, certificate.txt (the table that is printed) and digits.png, and
says how many digits of every number are certain, what limits them and how changes of the
inputs come through. Exit code 1 where the certificate is refused: the routes part, or a peak
or final value has no bound. `eventpound compare` takes the certificate as its reference.
What is meant by an error and how the bound is made: the page "accuracy" of the documentation.

Examples
--------
  eventpound verify pulse
  eventpound verify pulse --rtol 1e-10 --patience 60
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eventpound.cli.arguments import Commands, Options, add_command, loaded_case, seconds, tolerance
from eventpound.cli.talk import complain, is_quiet

if TYPE_CHECKING:
    from eventpound.accuracy.certificate import Certificate


def add_verify(commands: Commands) -> None:
    """Add the command to the parser."""
    verify = add_command(commands, "verify", _verify, __doc__)
    verify.case()
    rtol = "tolerance of the most accurate routes (1e-13); a larger one costs less"
    verify.option("--rtol X", rtol, tolerance, default=1e-13)
    patience = "give up a run that takes longer (600); its route is listed as failed"
    verify.option("--patience SECONDS", patience, seconds, default=600.0)
    verify.out("where certificate.json, certificate.txt and digits.png go (CASE/results)")
    verify.option("--no-figures", "write the tables only")


def _verify(options: Options) -> int:
    case = loaded_case(options.case)
    out = options.results
    from eventpound import results
    from eventpound.accuracy.certificate import certificate_text, sentence, write_certificate
    from eventpound.accuracy.verify import CertificateInterrupted, verify

    results.check_writable(out)
    try:
        certificate = verify(case, options.rtol, patience=options.patience, report=_say)
    except CertificateInterrupted as interrupt:
        _keep(interrupt.certificate, out)
        raise
    write_certificate(certificate, out)
    print(certificate_text(certificate))
    print(sentence(certificate))
    if not options.no_figures:
        from eventpound.report.digits import digits_figure
        from eventpound.report.style import png

        figure = digits_figure(certificate)
        if figure is not None:
            results.write_together(out, {"digits.png": png(figure)})
    print(f"wrote {out}")
    if not certificate.certified:
        complain("the certificate is refused")
        return 1
    return 0


def _keep(certificate: Certificate, out: Path) -> None:
    """Write what an interrupted command had found, unless an earlier certificate is there."""
    from eventpound.accuracy.certificate import JSON, write_certificate

    if (out / JSON).exists():
        _say(f"the certificate that was in {out} stays")
        return
    write_certificate(certificate, out)
    _say(f"the routes that were done are in {out}, certificate.txt; nothing is certified")


def _say(line: str) -> None:
    if not is_quiet():
        complain(line)
