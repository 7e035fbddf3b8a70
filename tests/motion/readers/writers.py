"""Files of every text format, written from a synthetic motion.

Each writer takes samples in the unit of its format and a time step, and gives
the text of a file with the layout of that agency's files; nothing in them is
of a real record.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from eventpound.numerics.arrays import Floats


def motion(size: int, time_step: float, seed: int = 0) -> Floats:
    """Enveloped sum of sinusoids, peak 2.5 m/s^2; another one for each seed."""
    t = time_step * np.arange(size)
    random = np.random.default_rng(seed)
    a = sum(
        np.sin(2.0 * np.pi * f * t + random.uniform(0.0, 6.28)) / f
        for f in random.uniform(0.5, 6.0, size=12)
    )
    a = a * np.sin(np.pi * t / t[-1]) ** 2
    return 2.5 * a / np.max(np.abs(a))


@dataclass(frozen=True)
class Written:
    """A file, and what reading it should give."""

    text: str
    resolution: float
    """Half a unit of the last printed decimal (m/s^2)."""
    components: tuple[str | None, ...] = (None,)
    units: str | None = None
    """To be given; None where the file states them."""
    time_step: float | None = None
    """To be given."""
    format: str | None = None


def rows(values: Sequence[float], per_line: int, field: str) -> str:
    """Numbers in a Fortran-like field, so many a line."""
    texts = [format(value, field) for value in values]
    return "".join("".join(texts[i : i + per_line]) + "\n" for i in range(0, len(texts), per_line))


def at2(a: Floats, dt: float) -> Written:
    head = (
        "PEER NGA STRONG MOTION DATABASE RECORD\nNowhere-01, 1/2/1999, Made up, 090\n"
        f"ACCELERATION TIME SERIES IN UNITS OF G\nNPTS= {a.size:6d}, DT= {dt:7.4f} SEC\n"
    )
    return Written(head + rows(a / 9.80665, 5, "15.7E"), 0.5e-7 * 9.80665, ("090",))


def esm(a: Floats, dt: float) -> Written:
    head = {
        "EVENT_NAME": "NOWHERE",
        "EVENT_ID": "XX-1",
        "EVENT_DATE_YYYYMMDD": "19990102",
        "STATION_CODE": "MADE",
        "STATION_NAME": "",
        "SAMPLING_INTERVAL_S": f"{dt:.6f}",
        "NDATA": f"{a.size}",
        "STREAM": "HNE",
        "UNITS": "cm/s^2",
        "PGA_CM/S^2": f"{100.0 * np.max(np.abs(a)):.6f}",
        "DATA_TYPE": "ACCELERATION",
        "USER5": "",
    }
    text = "".join(f"{key}: {value}\n" for key, value in head.items())
    return Written(text + rows(100.0 * a, 1, ".6f"), 0.5e-8, ("HNE",))


def cosmos(
    a: Floats, dt: float, data: str = "pts, approx {0:4.0f} secs, units=cm/sec2(04),Format=(8F10.5)"
) -> Written:
    def part(values: Floats, channel: int, azimuth: int) -> str:
        text = [
            "Corrected acceleration    (Format v01.20 with 13 text lines)",
            "Nowhere Earthquake",
            "Hypocenter: nowhere",
            "Origin: 01/02/1999, 03:04:05 UTC",
            "Statn No: 01-1  Code:XX-MADE  Made up",
            *["-"] * 3,
            f"Sta Chan  {channel}: {azimuth} deg (Rcrdr Chan  1) Location:",
            "Raw record length = 1 sec, Uncor max =     9.000 g  at 1.0 sec",
            f"Processed: today, Max = {100.0 * values[np.argmax(np.abs(values))]:9.3f} cm/sec2",
            "Record filtered",
            "Values used when parameter or data value is unknown/unspecified:   -999, -999.0",
        ]
        integers = np.full(100, -999)
        integers[53] = azimuth
        reals = np.full(100, -999.0)
        reals[61] = 1000.0 * dt
        return (
            "\n".join(text)
            + "\n 100 Integer-header values follow on  10 lines, Format= (10I8)\n"
            + rows(integers.tolist(), 10, "8d")
            + " 100 Real-header values follow on  17 lines, Format= (6F13.6)\n"
            + rows(reals.tolist(), 6, "13.6f")
            + '  1 Comment line(s) follow, each starting with a "|":\n| 12 34\n'
            + f"{a.size:8d} acceleration {data.format(a.size * dt)}\n"
            + rows((100.0 * values).tolist(), 8, "10.5f")
            + "End-of-data for Chan acceleration\n"
        )

    text = part(a, 1, 340) + part(-0.5 * a, 2, 70)
    return Written(text, 0.5e-7, ("340", "70"), format="cosmos")


def cosmos_v1c(a: Floats, dt: float) -> Written:
    """As the California survey writes it, but for the unit: a point after it, a comma less."""
    return cosmos(a, dt, "pts, approx {0:4.0f} secs, units=cm/sec2.  (04)Format=(8f10.5)   ")


def csmip_v2(a: Floats, dt: float) -> Written:
    def part(values: Floats, channel: int, name: str) -> str:
        integral = np.cumsum(values) * dt
        head = [
            f"CORRECTED ACCELEROGRAM   1-S1-1.01       CHAN {channel:2d}: {name}    FROM",
            *["-"] * 4,
            "STATION NO. 1   1.000N, 1.000W     SMA-1  S/N 1",
            "MADE UP                 XXX",
            f"CHAN {channel:2d}: {name}",
            "NOWHERE EARTHQUAKE     JAN 2, 1999 03:04 PDT",
            f"PEAK ACCELERATION = {100 * values[np.argmax(np.abs(values))]:9.3f}    CM/SEC/SEC",
            " 1 2 3",
        ]
        text = "\n".join(head) + "\n"
        for what, series, unit in (("ACCEL", values, "CM/SEC/SEC"), ("VELOC", integral, "CM/SEC")):
            text += f"{series.size:5d} POINTS OF {what} DATA EQUALLY SPACED AT {dt:5.3f} SEC.  "
            text += f"(UNITS: {unit})\n" + rows((100.0 * series).tolist(), 8, "10.3f")
        return text + f"/&  ----------  END OF DATA FOR CHANNEL {channel:2d}  ----------\n"

    text = part(a, 1, " 90 DEG") + part(0.3 * a[:-1], 2, "UP") + "\x1a" * 40
    return Written(text.replace("\n", "\r\n"), 0.5e-5, ("90", "UP"), format="csmip")


def csmip_v1(a: Floats, dt: float) -> Written:
    head = [
        "Uncorrected Accelerogram Data             Processed: 01/02/99",
        *["-"] * 3,
        "Station No. 1   1.000N, 1.000W     s/n 1",
        "Made Up                                   XXX",
        "Chan  1: 360 Deg",
        "Record of some day    Sat Jan 2, 1999",
        f"Units of uncor data are sec and g .   Max  = {np.max(np.abs(a)) / 9.80665:6.3f} g , at",
        f"{a.size:6d} Accelerogram points at {1.0 / dt:3.0f} pts/sec in units of g .      "
        "Format: (8f9.6)  ",
    ]
    text = "\n".join(head) + "\n" + rows(a / 9.80665, 8, "9.6f") + "/&  --- End of Data ---\n"
    return Written(text, 0.5e-6 * 9.80665, ("360",), format="csmip")


def csmip_structure(a: Floats, dt: float) -> Written:
    """Channels of a building, each with a location behind its name."""
    text = csmip_v2(a, dt).text
    for name, place in ((" 90 DEG", "Abutment 1"), ("UP", "Deck: center")):
        line = f": {name}\r\n"
        text = text.replace(line, f": {name}                   Location: {place}\r\n")
    return Written(text, 0.5e-5, ("90", "UP"), format="csmip")


def volume_1(a: Floats, dt: float) -> Written:
    """CDMG and RENADIC: pairs, of which fields touch from 100 s on."""

    def part(values: Floats, channel: int, name: str) -> str:
        g_10 = values / 0.980665
        head = [
            "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 01/02/99",
            "NOWHERE EARTHQUAKE",
            "JAN 2, 1999 03:04 PDT                (ORIGIN: 01/02/99)",
            "-",
            "STATION NO. 1   1.000N, 1.000W     SMA-1  S/N 1",
            "MADE UP",
            f"CHAN  {channel}: {name}        (STA CHN:  {channel})",
            *["-"] * 3,
            f"NO. OF POINTS = {values.size:6d}  RECORD LENGTH ={values.size * dt:7.3f} SEC",
            "UNITS OF UNCOR ACCEL ARE SEC AND G/10.     "
            f"MAX  = {0.1 * g_10[np.argmax(np.abs(g_10))]:6.3f} G, AT  1.000 SEC",
            "RMS ACCEL OF COMPLETE RECORD = 0.021 G",
        ]
        pairs = np.column_stack([np.arange(values.size) * dt, g_10]).ravel().tolist()
        numbers = rows([0] * 100, 16, "5d") + rows([0.0] * 50, 8, "10.3f")
        numbers += rows(pairs, 10, "7.3f")
        return "\n".join(head) + "\n" + numbers + f"/&  --- END OF DATA FOR CHANNEL {channel} ---\n"

    text = part(a, 1, " 90 DEG") + part(0.3 * a, 2, "UP")
    return Written(text, 0.5e-3 * 0.980665, ("90", "UP"), format="cdmg")


def volume_2(a: Floats, dt: float) -> Written:
    """USC and Caltech; the line before the numbers does not say the unit."""
    head = [
        "CORRECTED ACCELEROGRAM  IIBA338  87.420.0 COMP S58W   FILE   0  CORRESPONDING T",
        "FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:                  VOL1",
        *["-"] * 3,
        "STATION USC# 0001   1 00 00N, 1 00 00W                                  39VOL1",
        "1 STREET, MADE UP                                                       42VOL1",
        "COMP S58W                                                               9 VOL1",
        "NOWHERE EARTHQUAKE   JAN 2, 1999 -0304 GMT                              52VOL1",
        *["-"] * 2,
        "NO. OF POINTS =   2275      DURATION =  11.435 SEC                      50VOL1",
        f"PEAK ACCELERATION = {100 * a[np.argmax(np.abs(a))]:11.3f}  CMS/SEC/SEC AT 1.0 SEC.",
        " 0 2 1 338",
    ]
    text = "\n".join(head) + "\n"
    for what, series in (("ACC", a), ("VEL", np.cumsum(a) * dt)):
        text += f"{a.size:6d} POINTS OF {what} DATA EQUALLY SPACED AT {dt:6.3f} SEC.\n"
        text += rows((100.0 * series).tolist(), 8, "10.3f")
    return Written(text, 0.5e-5, ("S58W",), format="csmip")


def bhrc(a: Floats, dt: float) -> Written:
    def part(values: Floats, name: str) -> str:
        head = [
            "* VOL1DS FILE:  0001/01",
            "Inst Type = SSA-2",
            "Origin Time : 1999/01/02   03:04:05",
            *["", name[0], "", f"COMP {name}"],
            "Made up                   Station   1.0 N 1.0 E   Altitude 1m   Azimuth L 352   T 82",
            *["-"] * 2,
            f"NO. OF POINTS = {values.size:6d}      DURATION = {values.size * dt:7.3f}",
            "UNITS ARE SECONDS AND G/10",
            "",
        ]
        reals = np.zeros(42)
        reals[6] = 1.0 / dt
        numbers = rows([0] * 88, 14, "5d") + rows(reals.tolist(), 6, "14.6E")
        numbers += rows(values / 0.980665, 10, "14.6E")
        return "\n".join(head) + "\n" + numbers + "/&\n"

    text = part(a, "L1") + part(0.2 * a, "V2") + part(-0.4 * a, "T3")
    return Written(text, 0.5e-6 * 2.5, ("L", "V", "T"))


def unam(a: Floats, dt: float) -> Written:
    rule = "---------+" * 8
    head = [
        "*" * 86,
        "                       INSTITUTO DE INGENIERIA, UNAM",
        "*" * 86,
        "ARCHIVO ESTANDAR DE ACELERACION:",
        "=" * 80,
        "NOMBRE DE LA ESTACION                  : MADE UP",
        "CLAVE DE LA ESTACION                   : MADE",
        "ORIENTACION C1-C6 (rumbo;orientacion)  : /V/N90E/N00E",
        f"INTERVALO DE MUESTREO, C1-C6 (s)       : /{dt}/{dt}/{dt}",
        "FECHA DEL SISMO [GMT]                  : 1999/01/02",
        f"NUM. TOTAL DE MUESTRAS, C1-C6          : /{a.size}/{a.size}/{a.size}",
        "UNIDADES DE LOS DATOS                  : Gal (cm/s/s)",
        "DATOS DE ACELERACION:",
        rule,
        "   CANAL-1   CANAL-2   CANAL-3",
        "         V      N90E      N00E",
        rule,
    ]
    columns = np.column_stack([100.0 * a, -50.0 * a, 30.0 * a])
    text = "\n".join(head) + "\n" + rows(columns.ravel().tolist(), 3, "10.4f")
    return Written(text, 0.5e-6, ("V", "N90E", "N00E"))


def csmnc(a: Floats, dt: float) -> Written:
    head = [
        "000MADE19990102030401",
        "0199001020304 1999-01-02 3:4:5 BTM",
        "NOWHERE EARTHQUAKE",
        "EPICENTER   1.000N   1.000E DEPTH 1 KM",
        "MAGNITUDE  1.0(Ms)",
        "STATION: MADE  1.000N   1.000E",
        "SITE CONDITION: ROCK",
        "INSTRUMENT TYPE: NONE",
        "OBSERVING POINT: GROUND",
        "COMP. NS",
        "UNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC",
        f"NO. OF POINTS: {a.size:6d}  EQUALLY SPACED INTERVALS OF:  {dt:5.3f}  SEC",
        f"PEAK VALUE:  {100 * a[np.argmax(np.abs(a))]:10.3f}   AT   1.00 SEC    DURATION:  9 SEC",
        "PRE-EVENT TIME:  20  SEC",
        "CSMNC",
        "",
    ]
    return Written("\n".join(head) + "\n" + rows(100.0 * a, 8, "14.6E"), 0.5e-6 * 2.5, ("NS",))


def slist(a: Floats, dt: float) -> Written:
    """Two channels; numbers run along lines."""

    def part(values: Floats, name: str) -> str:
        line = f"TIMESERIES XX_MADE__{name}_R, {values.size} samples, {1.0 / dt:g} sps, "
        line += "1999-01-02T03:04:05.000000, SLIST, FLOAT, M/S**2\n"
        return line + rows(values, 6, "12.6f")

    text = part(a, "HNE") + part(0.5 * a, "HNN")
    return Written(text, 0.5e-6, ("HNE", "HNN"), format="timeseries")


def tspair(a: Floats, dt: float) -> Written:
    """As ObsPy writes it where it does not know the unit."""
    start = np.datetime64("1999-01-02T03:04:05.000000")
    text = f"TIMESERIES XX_MADE__HNE_R, {a.size} samples, {1.0 / dt:g} sps, "
    text += f"{start}, TSPAIR, FLOAT, Counts\n"
    for i, value in enumerate(a):
        text += f"{start + np.timedelta64(round(1e6 * i * dt), 'us')}  {value:+.10e}\n"
    return Written(text, 1e-9, ("HNE",), "m/s2", format="timeseries")


def sac_alphanumeric(a: Floats, dt: float) -> Written:
    reals, integers = np.full(70, -12345.0), np.full(40, -12345)
    reals[0] = dt
    integers[6], integers[9], integers[15], integers[16], integers[35] = 6, a.size, 1, 8, 1
    names = [["-12345  "] * 3 for _ in range(8)]
    names[0][0], names[6][2] = "MADE    ", "HNE     "
    text = rows(reals.tolist(), 5, "15.7g") + rows(integers.tolist(), 5, "10d")
    text += "".join("".join(line) + "\n" for line in names) + rows(a, 5, "15.7g")
    return Written(text, 0.5e-6, ("HNE",), "m/s2", format="sac-alphanumeric")


def deepsoil(a: Floats, dt: float) -> Written:
    """Number and step on the first line, then times and accelerations."""
    pairs = np.column_stack([np.arange(a.size) * dt, a]).ravel().tolist()
    text = f"{a.size} {dt}\n" + rows(pairs, 2, "12.6f")
    return Written(text, 0.5e-6, units="m/s2", format="count-and-step")


def smc(a: Floats, dt: float) -> Written:
    def short(value: float) -> str:
        mantissa, exponent = format(value, ".4E").split("E")
        return f"{mantissa}E{int(exponent):+d}".rjust(10)

    integers = np.full(48, -32768)
    integers[15], integers[16] = 2, a.size
    reals = np.full(50, 1.7e38)
    reals[1] = 1.0 / dt
    head = [
        "2 CORRECTED ACCELEROGRAM",
        "*",
        "MADE",
        "     1999  01  02    0304 Nowhere, XX",
        "Moment Mag=",
        "station = Made up; nowhere    component= 360",
        f"epicentral dist =     10.2       pk acc = {100.0 * np.max(np.abs(a)):9.2E}",
        "inst type=",
        *["*"] * 3,
    ]
    text = "\n".join(head) + "\n" + rows(integers.tolist(), 8, "10d")
    text += rows(reals.tolist(), 5, "15.7E") + "| 1.0 2.0\n|\n"
    texts = [short(100.0 * value) for value in a]
    text += "".join("".join(texts[i : i + 8]) + "\n" for i in range(0, len(texts), 8))
    return Written(text, 0.5e-4 * np.max(np.abs(a)), ("360",))


def knet(a: Floats, dt: float) -> Written:
    """Its counts have a mean, which the reader takes away."""
    counts = np.rint(100.0 * (a - np.mean(a)) * 6170801 / 3920 + 1234.0).astype(int)
    peak = np.max(np.abs(counts - np.mean(counts))) * 3920 / 6170801
    head = {
        "Origin Time": "1999/01/02 03:04:00",
        "Lat.": "1.0",
        "Long.": "1.0",
        "Depth. (km)": "5",
        "Mag.": "2.4",
        "Station Code": "MADE01",
        "Station Lat.": "1.0",
        "Station Long.": "1.0",
        "Station Height(m)": "1",
        "Record Time": "1999/01/02 03:04:05",
        "Sampling Freq(Hz)": f"{1.0 / dt:.0f}Hz",
        "Duration Time(s)": f"{a.size * dt:g}",
        "Dir.": "4",
        "Scale Factor": "3920(gal)/6170801",
        "Max. Acc. (gal)": f"{peak:.3f}",
        "Last Correction": "1999/01/02 03:04:05",
        "Memo.": "",
    }
    text = "".join(f"{key:18}{value}\n" for key, value in head.items())
    return Written(text + rows(counts.tolist(), 8, "9d"), 3920e-2 / 6170801, ("NS2",))


def knet_csv(a: Floats, dt: float) -> Written:
    """KiK-net: six components with the offsets of the sensors, over midnight."""
    offsets = np.array([0.1, 1.7, -16.5, 3.0, 0.25, -2.0])
    titles = ",".join(f"{i}(gal)" for i in range(1, 7))
    head = (
        "#K-NET CSV\n#Event\n#OriginTime,Latitude,Longitude,Depth(km),Magnitude\n"
        "#1999/01/02 23:59:00,1.0,1.0,5,2.4\n#Station\n#Code,Latitude,Longitude,Height1(m),"
        "Height2(m)\n#MADE01,1.0,1.0,1,101\n#Record\n#SamplingFrequency(Hz)\n"
        f"#{1.0 / dt:.0f}\n#DurationTime(s)\n#{a.size * dt:g}\n#Offset\n#{titles}\n"
        f"#{','.join(f'{x:.2f}' for x in offsets)}\n#Time,RelativeTime(s),{titles}\n"
    )
    lines = []
    for i, x in enumerate(a):
        since = 86399.97 + i * dt
        day, t = int(2 + since // 86400), since % 86400
        clock = f"1999/01/{day:02d} {int(t // 3600):02d}:{int(t % 3600 // 60):02d}:{t % 60:05.2f}"
        samples = 100.0 * x * np.array([1.0, -0.5, 0.2, 1.5, 2.0, 0.1]) + offsets
        lines.append(f"{clock},{i * dt:.2f},{','.join(f'{sample:.2f}' for sample in samples)}\n")
    components = ("NS1", "EW1", "UD1", "NS2", "EW2", "UD2")
    return Written(head + "".join(lines), 0.5e-4, components, format="knet-csv")


def geonet(a: Floats, dt: float, *, corrected: bool = True) -> Written:
    sampled = (
        f"Instrument corrected data at {dt:5.3f} sec intervals"
        if corrected
        else f"Raw readings in units of 1.00 mm/s/s  at intervals of {dt:5.3f} s"
    )

    def part(values: Floats, name: str) -> str:
        head = [
            f"{'Corrected' if corrected else 'Uncorrected'} accelerogram 19990102_030405_MADE "
            "GNS Science",
            "Site MADE      1 1 1S  1 1 1E",
            "Made Up",
            *["-"] * 4,
            "1999 January 02         03:04:05 UT",
            "-",
            f"Number of points {values.size:5d}    Duration {values.size * dt:6.2f} sec",
            sampled,
            "Band-pass filter",
            f"Component {name}  Some Axis",
            f"Acceleration:  peak {1000 * values[np.argmax(np.abs(values))]:8.1f} mm/s/s at  1 sec",
            *["-"] * 2,
            *["  1 2 3"] * 10,
        ]
        series = [values, np.cumsum(values) * dt, np.cumsum(np.cumsum(values)) * dt**2]
        series = series if corrected else series[:1]
        return "\n".join(head) + "\n" + "".join(rows(1000.0 * s, 10, "8.1f") for s in series)

    text = part(a, "N28W") + part(-0.4 * a, "S62W") + part(0.2 * a, "Up")
    return Written(text, 0.5e-4, ("N28W", "S62W", "Up"), format="geonet")


def geonet_v1(a: Floats, dt: float) -> Written:
    return geonet(a, dt, corrected=False)


def cwb(a: Floats, dt: float) -> Written:
    columns = np.column_stack([np.arange(a.size) * dt, 20.0 * a, 100.0 * a, -50.0 * a])
    extremes = f"{100.0 * a.max():9.3f}~{100.0 * a.min():9.3f}"
    text = (
        "#Earthquake Information\n#Origin Time(GMT+08): 1999/01/02-03:04:05\n\n"
        "#Station Information\n#StationCode: MADE\n#StationName: Made up\n"
        f"#RecordLength(sec): {a.size * dt:g}\n#SampleRate(Hz): {1.0 / dt:g}\n"
        f"#AmplitudeUnit:  gal. DCoffset(corr)\n#AmplitudeMAX. N:{extremes}\n"
        "#DataSequence: Time U(+); N(+); E(+)\n#Data: 4F10.3 \n"
        + rows(columns.ravel().tolist(), 4, "10.3f")
    )
    return Written(text, 0.5e-5, ("N", "E", "U"))


def usc(a: Floats, dt: float) -> Written:
    """Even times, a multiple of the printed milliseconds; a touching field where t >= 100 s."""
    pairs = np.column_stack([np.arange(a.size) * dt, a / 0.980665]).ravel()
    text = [
        "FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:",
        "NOWHERE EARTHQUAKE                                                   18",
        "JAN 2, 1999 -0304 GMT                                                21",
        "-",
        "STATION USC# 0001",
        "1 STREET, MADE UP                                                17",
        "COMP N00W                                                               9",
        *["-"] * 3,
        f"NO. OF POINTS = {a.size:6d}      DURATION = {a.size * dt:7.3f} SEC           50",
        "UNITS ARE SEC AND G/10                                                  22",
        "-",
    ]
    body = rows([0] * 100, 16, "5d") + rows([0.0] * 50, 8, "10.3f")
    data = "".join(" " + line + "\n" for line in rows(pairs.tolist(), 10, "7.3f").splitlines())
    return Written("\n".join(text) + "\n" + body + data, 0.5e-3 * 0.980665, ("N00W",))


def afad(a: Floats, dt: float) -> Written:
    peak = 100.0 * np.max(np.abs(a))
    text = (
        "STRONG GROUND MOTION RECORDS OF TURKIYE\nSTATION ID              : MADE\n"
        f"RECORD TIME             : 02/01/1999\nNUMBER OF DATA          : {a.size}\n"
        f"SAMPLING INTERVAL (sec) : {dt}\n"
        f"RAW PGA VALUES (gal)    : (N-S) {peak:.6f} (E-W) {0.5 * peak:.6f} (U-D) 0.000001\n"
        "Copyright NOBODY\n       N-S          E-W          U-D\n"
    )
    columns = np.column_stack([100.0 * a, -50.0 * a, 1e-6 * np.ones(a.size)])
    return Written(text + rows(columns.ravel().tolist(), 3, "13.6f"), 0.5e-8, ("N-S", "E-W", "U-D"))


def itaca(a: Floats, dt: float) -> Written:
    text = (
        "Event Date & Time             : 1999-01-02 03:04:05\n"
        "Station Code / Name           : 1 / Made up\nOrientation                   : NS\n"
        f"Time Increment (s)            : {dt}\nNumber of Data                : {a.size}\n"
        f"PGA (m/s/s)                   : {np.max(np.abs(a)):.7E}\n"
        "Accelaration time series in m/s/s\n"
    )
    return Written(text + rows(a.tolist(), 5, "14.7E"), 0.5e-7 * 2.5, ("NS",))


def itsak(a: Floats, dt: float) -> Written:
    rule = "-----------------------********--------------------\n"
    text = (
        "type of record: accelerogram\nstation name: MADE\n"
        f"datetime of first sample: 1999-01-02\nsampling frequency: {1.0 / dt} Hz\n"
        f"npts: {a.size}\nunits: cm/s^2\n{rule}                    components: E N Z\n{rule}\n"
    )
    columns = np.column_stack([100.0 * a, -30.0 * a, 10.0 * a])
    return Written(text + rows(columns.ravel().tolist(), 3, "12.8f"), 0.5e-10, ("E", "N", "Z"))


def itsak_fixed(a: Floats, dt: float) -> Written:
    text = f"M199_T  MADE UP STATION         {a.size} Values\n(8F15.0)             {dt} \n"
    filled = np.concatenate([a / 9.80665, np.zeros(-a.size % 8 + 8)])
    body = rows(filled.tolist(), 8, "15.6f")
    return Written(text + body, 0.5e-6 * 9.80665, ("T",), "g", format="itsak-fixed")


def one_column(a: Floats, dt: float) -> Written:
    return Written(rows(a, 1, "12.6f"), 0.5e-6, units="m/s2", time_step=dt, format="columns")


def two_columns(a: Floats, dt: float) -> Written:
    pairs = np.column_stack([np.arange(a.size) * dt, a]).ravel()
    return Written(rows(pairs.tolist(), 2, "12.6f"), 0.5e-6, units="m/s2", format="columns")


def csv(a: Floats, dt: float) -> Written:
    lines = [f"{i * dt:.4f},{-x:.6f},{x:.6f}" for i, x in enumerate(a)]
    text = "\ufefftime,EW,NS\r\n" + "\r\n".join(lines)
    return Written(text, 0.5e-6, ("EW", "NS"), "m/s2", format="columns")


def opensees(a: Floats, dt: float) -> Written:
    text = rows(a, 8, "10.5f") + "*** End Data ***\n"
    return Written(text, 0.5e-5, units="m/s2", time_step=dt)


WRITERS: dict[str, Callable[[Floats, float], Written]] = {
    "at2": at2,
    "esm": esm,
    "cosmos": cosmos,
    "cosmos_v1c": cosmos_v1c,
    "csmip_v2": csmip_v2,
    "csmip_v1": csmip_v1,
    "csmip_structure": csmip_structure,
    "volume_1": volume_1,
    "volume_2": volume_2,
    "bhrc": bhrc,
    "unam": unam,
    "csmnc": csmnc,
    "slist": slist,
    "tspair": tspair,
    "sac_alphanumeric": sac_alphanumeric,
    "deepsoil": deepsoil,
    "smc": smc,
    "knet": knet,
    "knet_csv": knet_csv,
    "geonet": geonet,
    "geonet_v1": geonet_v1,
    "cwb": cwb,
    "usc": usc,
    "afad": afad,
    "itaca": itaca,
    "itsak": itsak,
    "itsak_fixed": itsak_fixed,
    "one_column": one_column,
    "two_columns": two_columns,
    "csv": csv,
    "opensees": opensees,
}
