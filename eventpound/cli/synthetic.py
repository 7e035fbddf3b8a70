"""Write a suite of synthetic motions.

Synthetic motions as PEER files (.AT2) and a table of their parameters. They are not
records: filtered, modulated white noise after Rezaeian and Der Kiureghian, for
earthquakes of magnitude 6 to 7.7 at 10 to 40 km on firm ground. The same seed gives the
same files; motion 7 of a seed is the same however many there are. Their PGA and mean
period spread over a decade: the page "synthetic" of the documentation.

Examples
--------
  eventpound records synthetic motions --count 60 --seed 1
  and in a case:  [excitation]  kind = "record"  suite = "../motions/*.AT2"
"""

from __future__ import annotations

from pathlib import Path

from eventpound.cli.arguments import Commands, Options, add_command, count_argument
from eventpound.cli.progress import Counter


def add_synthetic(commands: Commands) -> None:
    """Add the command to the parser."""
    synthetic = add_command(commands, "records synthetic", _synthetic, __doc__)
    synthetic.add_argument("directory", metavar="DIR", type=Path, help="made where it is missing")
    synthetic.option("--count N", "how many (60)", count_argument, default=60)
    synthetic.option("--seed S", "a whole number (1)", count_argument, default=1)


def _synthetic(options: Options) -> int:
    from eventpound.motion.synthetic import synthetic_motion
    from eventpound.motion.synthetic.files import QUANTITIES, parameter_table, spread
    from eventpound.results import check_writable, write_together
    from eventpound.results.tables import aligned

    check_writable(options.directory)
    motions = []
    with Counter("synthetic motions") as progress:
        for number in range(1, options.count + 1):
            motions.append(synthetic_motion(options.seed, number))
            progress(number, options.count)
    files = {motion.name: motion.content for motion in motions}
    table = parameter_table(motions)
    write_together(options.directory, files | {"parameters.csv": table})
    print(f"{options.count} synthetic motions, seed {options.seed}: {options.directory}")
    spreads = zip(QUANTITIES, spread(motions), strict=True)
    rows = ((name, *(f"{value:.4g}" for value in values)) for name, values in spreads)
    print(aligned(("", "least", "median", "largest"), rows, {0}))
    return 0
