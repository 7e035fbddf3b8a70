"""Another program, ten lines of its own: Heun's method for cases/elastic-barrier, to a CSV."""

import math
import sys


def rows(u=0.0, v=0.0, h=2e-4, k=(2 * math.pi / 0.6) ** 2, c=0.1 * 2 * math.pi / 0.6):
    def rate(u, v, t):
        ground = 0.3 * 9.80665 * math.cos(2 * math.pi / 0.8 * t) if t < 0.8 else 0.0
        return v, -k * u - c * v - ground

    for i in range(20001):
        yield i * h, u, v
        (u1, v1) = rate(u, v, i * h)
        (u2, v2) = rate(u + h * u1, v + h * v1, (i + 1) * h)
        u, v = u + h * (u1 + u2) / 2, v + h * (v1 + v2) / 2
        if u >= 0.01 and v > 0.0:
            u, v = 0.01, -0.7 * v


if __name__ == "__main__":
    with open(sys.argv[1], "w") as file:
        file.write("time,x,speed\n" + "".join(f"{t!r},{u!r},{v!r}\n" for t, u, v in rows()))
